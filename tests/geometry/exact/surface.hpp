#pragma once
// A triangulated surface in long double: what its faces, edges and corners are, without a tree and without a
// bound on anything. It takes what it is given: nothing is welded, turned or dropped but faces without area.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <exact/real.hpp>

namespace exact {

inline V to_exact(const std::array<double, 3>& p) {
    return {p[0], p[1], p[2]};
}
inline Real distance(const V& a, const V& b) {
    return length(a - b);
}

/// The nearest point of a face, and on what of it that lies.
struct Nearest3 {
    V point;
    int corner = -1, edge = -1;  // at most one of them; edge i goes from corner i to corner i + 1
};

/// Where a segment goes through a face from its front.
struct Crossing {
    int face = -1;  // none
    Real t = 2;     // of the segment
};

class Surface {
  public:
    Surface(std::span<const std::array<double, 3>> vertices,
            std::span<const std::array<std::uint32_t, 3>> triangles);

    std::size_t faces() const { return face_.size(); }
    Real size() const { return size_; }  // m, its box's diagonal
    const V& low() const { return low_; }
    const V& high() const { return high_; }
    const V& corner(int face, int i) const { return vertex_[face_[face][i]]; }
    const V& normal(int face) const { return normal_[face]; }
    int triangle(int face) const { return given_[face]; }  // its place in what was given
    int face_of(int triangle) const {                      // -1: it has no area, or there is no such
        const auto at = std::lower_bound(given_.begin(), given_.end(), triangle);
        return at != given_.end() && *at == triangle ? static_cast<int>(at - given_.begin()) : -1;
    }
    bool closed() const { return open_edges_ == 0; }
    std::size_t open_edges() const { return open_edges_; }
    /// But for a few holes, so that `winding` still tells what is inside.
    bool nearly_closed() const { return open_edges_ < face_.size() / 10; }

    /// The face beyond an edge on the front side, and the edge of it: 3 face + edge; -1: none. Where more
    /// than two faces meet it is the first that one comes to when one turns about the edge from the front.
    int over(int face, int edge) const { return over_[face][edge]; }
    /// Faces around a corner that hang together over edges, the given one first.
    std::vector<int> fan(int face, int corner) const;

    Nearest3 nearest(int face, const V& p) const;
    /// Of all faces, by looking at all of them; and by looking at those in the grid's cells.
    int nearest_face(const V& p) const;
    int nearest_face_near(const V& p) const;
    /// Where the surface's front is at such a point: face normal, mean of two, or weighted by the angles. At
    /// the edge of a sheet with two sides there is none: the face's.
    V pseudonormal(int face, const Nearest3& at) const;
    /// Nothing goes on beyond it, or only the same sheet's other side.
    bool rim(int face, const Nearest3& at) const;
    /// An edge beyond which nothing goes on is that near.
    bool near_rim(const V& at, Real reach) const;
    /// One of the faces that hold `at` lies on the way from `start` to the hand.
    bool blocked(const V& at, const V& start, const V& hand) const;

    /// The first face that a -> b goes through from its front; it may lie `behind` (m) a already. `but`: not
    /// the faces that hold this point.
    Crossing sweep(const V& a, const V& b, Real behind, const V* but = nullptr) const;
    /// Every triangle asked instead of those in the grid's cells.
    Crossing sweep_all(const V& a, const V& b, Real behind, const V* but = nullptr) const;

    /// How often the surface winds around p: 1 inside of a closed one, 0 outside of it.
    Real winding(const V& p) const;

    /// By how much (m) a face that holds p, within `near` of it, would be nearer to the hand than p. All
    /// faces are asked; with `from`, of those that hold p only such count as hang together with that face
    /// there.
    Real gain(const V& p, const V& hand, Real near, int from = -1) const;
    /// The same over all faces to which the way from p is free: another place that one could be in.
    Real gain_in_sight(const V& p, const V& normal, const V& hand, Real near) const;

  private:
    V weighted(int face, const Nearest3& at) const;
    void connect();
    void fill_grid();
    template <class Do>
    void cells(const V& low, const V& high, Do&& each) const;
    template <class Do>
    void within(const V& low, const V& high, Do&& each) const;
    void meet(int face, const V& a, const V& b, Real behind, const V* but, Crossing& first) const;

    std::vector<V> vertex_, normal_;
    std::vector<std::array<int, 3>> face_, over_;
    std::vector<int> given_;
    V low_, high_;
    Real size_ = 0;
    std::size_t open_edges_ = 0;
    Real cell_ = 1;  // m
    std::array<int, 3> cells_{1, 1, 1};
    std::vector<std::uint32_t> begin_, in_cell_;  // of each cell, and one past the last
};

}  // namespace exact
