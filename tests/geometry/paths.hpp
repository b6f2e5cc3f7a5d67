#pragma once
// Paths of a hand on a mesh, with one position per millisecond. Lengths are stated for a mesh of 0.2 m; they
// scale with the mesh, and so does the hand's speed.

#include <vector>

#include "generators.hpp"

namespace knurl::test {

using Hand = std::vector<std::array<double, 3>>;

class Hands {
  public:
    /// On an open mesh, the paths keep 4 mm away from its rim.
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
    double unit_;                         // length on this mesh per length on a mesh of 0.2 m
    std::vector<std::size_t> triangles_;  // that may be touched
    std::vector<exact::V> vertex_normal_;
    std::vector<exact::Real> rise_;  // of each vertex's neighbours above it: > 0 in a concave corner
    exact::V low_, high_;
};

}  // namespace knurl::test
