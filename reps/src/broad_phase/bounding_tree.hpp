#pragma once
// Finds the bounded surfaces near a point. The answer is exact: whatever is left out is out of reach.
//
//   put, drop ──> loose: scanned, 32 bytes each
//   index()   ──> tree over all surfaces (built outside the cycle); a surface that moves later is loose again
//   put_moving ──> moving: scanned at their present places

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <knurl/reps/scene_time.hpp>

namespace knurl::detail {

/// A ball that approaches becomes a candidate up to two of these times before it may be within reach. So a
/// cycle may last this long.
inline constexpr double soon = 16e-3;  // s
/// How long a ball at this distance with this speed is no candidate (s; 0: it is one now).
inline double away_for(double gap, double speed) noexcept {
    if (!(gap > 2 * soon * speed)) return 0;
    return speed > 0 ? gap / speed - soon : std::numeric_limits<double>::infinity();
}

class BoundingTree {
  public:
    enum class Moves { some, never };
    explicit BoundingTree(std::uint32_t capacity, Moves moves = Moves::some);

    /// The surface of `slot` lies within `radius` (m) of `center` (m) from now on. Allocates nothing.
    void put(std::uint32_t slot, const Eigen::Vector3d& center, double radius) noexcept;
    /// Likewise, for a surface that has moved with `velocity` (m/s) since that time.
    void put_moving(std::uint32_t slot, const Eigen::Vector3d& center, double radius,
                    const Eigen::Vector3d& velocity, double since, bool holds) noexcept;
    void drop(std::uint32_t slot) noexcept;
    void clear() noexcept;

    /// Builds the tree over all surfaces: O(n log n), allocates; never called in a cycle.
    void index();

    /// All slots whose ball comes nearer to p than `within` (m), each once; returns how many.
    std::uint32_t collect(const Eigen::Vector3d& p, double within,
                          std::span<std::uint32_t> out) const noexcept;

    struct Coming {
        std::uint32_t count = 0;
        double lasts = 0;  // s, until another ball may come as near
    };
    /// The same for moving balls: all that may soon come as near.
    Coming collect_moving(const Eigen::Vector3d& p, double within, const SceneTime& now,
                          std::span<std::uint32_t> out) const noexcept;

    std::uint32_t size() const noexcept { return size_; }
    double mean_radius() const noexcept { return size_ > 0 ? radii_ / size_ : 0; }  // m

  private:
    struct Ball {
        double x = 0, y = 0, z = 0, r = 0;  // m
    };
    struct Moving {
        Ball ball;
        double vx = 0, vy = 0, vz = 0, speed = 0;  // m/s
        double since = 0;                          // s
        std::uint32_t slot = 0;
        bool holds = false;
    };
    static constexpr std::uint32_t fan = 8;
    struct Box {
        Eigen::Vector3d low, high;  // m, from origin_
    };
    /// Boxes around eight children or, at the bottom, around eight items. They are floats, enlarged by what
    /// rounding may hide.
    struct alignas(64) Node {
        float low[3][fan], high[3][fan];  // m, from origin_
        std::uint32_t child[fan];         // nodes; at the bottom: items
        std::uint32_t bottom = 0;
    };
    std::pair<std::uint32_t, Box> build(std::uint32_t begin, std::uint32_t end);
    Box box_of(std::uint32_t item) const noexcept;
    static std::uint32_t near_children(const Node& node, const float (&p)[3], float square) noexcept;
    void sort(std::uint32_t begin, std::uint32_t end, std::uint32_t part);
    static constexpr std::uint32_t nowhere = 0xffffffff;

    std::vector<Ball> ball_;             // by slot
    std::vector<std::uint32_t> loose_;   // slots
    std::vector<std::uint32_t> place_;   // by slot: in loose_; nowhere: in the tree or absent
    std::vector<std::uint8_t> in_tree_;  // by slot: the tree holds the present ball
    std::uint32_t loose_size_ = 0;
    std::vector<Moving> moving_;               // scanned
    std::vector<std::uint32_t> moving_place_;  // by slot: in moving_
    std::uint32_t moving_size_ = 0;
    std::uint32_t size_ = 0;
    double radii_ = 0;  // m, sum of all radii
    // m, the middle of all balls: relative to it, floats are exact enough
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    std::vector<Node> nodes_;           // the root is the first
    std::vector<std::uint32_t> items_;  // slots, in the tree's order
    std::vector<Ball> item_balls_;      // the items' balls at the time of the build
};

}  // namespace knurl::detail
