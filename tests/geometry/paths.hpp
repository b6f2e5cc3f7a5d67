#pragma once
// Where a hand goes on a mesh, a place per millisecond. Lengths are those of a mesh of 0.2 m: on one ten
// times as large the hand is ten times as fast and presses ten times as deep.

#include <vector>

#include "generators.hpp"

namespace knurl::test {

using Hand = std::vector<std::array<double, 3>>;

class Hands {
  public:
    /// Of an open mesh, they keep 4 mm away from its rim.
    Hands(const MadeMesh& shape, std::uint64_t seed);

    Hand stroke() { return follow_surface(-0.003, -0.001); }  // 0.1 to 0.3 m/s, 1 to 3 mm deep
    Hand graze() { return follow_surface(-0.00005, 0.00005); }
    Hand hover() { return follow_surface(0.0002, 0.003); }
    Hand poke();            // in and out along a line, not quite the normal
    Hand around_an_edge();  // circles about the sharpest of some edges
    Hand into_a_corner();   // the most concave of some vertices
    Hand teleports(int places, int cycles_each);

  private:
    Hand follow_surface(double lowest, double highest);
    std::size_t any_triangle();
    exact::V middle(std::size_t triangle) const;
    exact::V normal(std::size_t triangle) const;

    const MadeMesh* shape_;
    Rng rng_;
    double unit_;                         // m, what a metre is on this mesh
    std::vector<std::size_t> triangles_;  // that may be touched
    std::vector<exact::V> vertex_normal_;
    std::vector<exact::Real> rise_;  // of the neighbours above each vertex: > 0 in a concave corner
    exact::V low_, high_;
};

}  // namespace knurl::test
