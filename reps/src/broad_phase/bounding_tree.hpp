#pragma once
// Which of many bounded surfaces are near a point: an exact answer, so that whatever is left out is out of
// reach.
//
//   put, drop ──> loose: scanned, 32 bytes each
//   index()   ──> tree over all that are there (built outside the cycle); what moves later is loose again
//   put_moving ──> moving: scanned where they are by now

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <knurl/reps/scene_time.hpp>

namespace knurl::detail {

/// A ball that comes closer is a candidate two of these before it may be within reach, so a cycle may take as
/// long.
inline constexpr double soon = 16e-3;  // s
/// So far away, at such a speed: it is no candidate for so long (s; 0: it is one now).
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
    /// Likewise, moving on with `velocity` (m/s) since it was there.
    void put_moving(std::uint32_t slot, const Eigen::Vector3d& center, double radius,
                    const Eigen::Vector3d& velocity, double since, bool holds) noexcept;
    void drop(std::uint32_t slot) noexcept;
    void clear() noexcept;

    /// Builds the tree over all surfaces that are there: O(n log n), allocates; never called in a cycle.
    void index();

    /// All slots whose ball comes nearer to p than `within` (m), each once; returns how many.
    std::uint32_t collect(const Eigen::Vector3d& p, double within,
                          std::span<std::uint32_t> out) const noexcept;

    struct Coming {
        std::uint32_t count = 0;
        double lasts = 0;  // s, for which no other one comes as near
    };
    /// The same of those that move: all that may come as near soon.
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
    /// Boxes around eight children, or at the bottom around eight items: in float, larger than what rounding
    /// may hide.
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
    std::vector<std::uint8_t> in_tree_;  // by slot: the tree's ball is the present one
    std::uint32_t loose_size_ = 0;
    std::vector<Moving> moving_;               // scanned
    std::vector<std::uint32_t> moving_place_;  // by slot: in moving_
    std::uint32_t moving_size_ = 0;
    std::uint32_t size_ = 0;
    double radii_ = 0;  // m, sum
    // m, in the middle: floats are exact enough from there
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    std::vector<Node> nodes_;           // the root is the first
    std::vector<std::uint32_t> items_;  // slots, in the tree's order
    std::vector<Ball> item_balls_;      // theirs, as the tree was built
};

}  // namespace knurl::detail
