#pragma once
// Which of many bounded surfaces are near a point: an exact answer, so that whatever is left out is out of
// reach.
//
//   put, drop ──> loose: scanned, 32 bytes each
//   index()   ──> tree over all that are there (built outside the cycle); what moves later becomes loose
//   again

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace knurl::detail {

class Reach {
  public:
    explicit Reach(std::uint32_t capacity);

    /// The surface of `slot` lies within `radius` (m) of `center` (m) from now on. Allocates nothing.
    void put(std::uint32_t slot, const Eigen::Vector3d& center, double radius) noexcept;
    void drop(std::uint32_t slot) noexcept;
    void clear() noexcept;

    /// Builds the tree over all surfaces that are there: O(n log n), allocates; never called in a cycle.
    void index();

    /// All slots whose ball comes nearer to p than `within` (m), each once; returns how many.
    std::uint32_t collect(const Eigen::Vector3d& p, double within,
                          std::span<std::uint32_t> out) const noexcept;

    std::uint32_t size() const noexcept { return size_; }
    double mean_radius() const noexcept { return size_ > 0 ? radii_ / size_ : 0; }  // m

  private:
    struct Ball {
        double x = 0, y = 0, z = 0, r = 0;  // m
    };
    struct Node {
        double low[3], high[3];            // m, encloses the balls, and what rounding may hide
        std::uint32_t begin = 0, end = 0;  // of a leaf: its items
        std::uint32_t second = 0;          // of a branch: its second child; the first follows it
    };
    std::uint32_t build(std::uint32_t begin, std::uint32_t end);
    static constexpr std::uint32_t nowhere = 0xffffffff;
    static constexpr std::uint32_t leaf_size = 4;

    std::vector<Ball> ball_;             // by slot
    std::vector<std::uint32_t> loose_;   // slots
    std::vector<std::uint32_t> place_;   // by slot: in loose_; nowhere: in the tree or absent
    std::vector<std::uint8_t> in_tree_;  // by slot: the tree's ball is the present one
    std::uint32_t loose_size_ = 0;
    std::uint32_t size_ = 0;
    double radii_ = 0;  // m, sum
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> items_;  // slots, in the tree's order
    std::vector<Ball> item_balls_;      // theirs, as the tree was built
};

}  // namespace knurl::detail
