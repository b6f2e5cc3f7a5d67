#pragma once
// A triangulated surface in long double, without a tree and without limits of work. It takes its input as it
// is: nothing is welded or turned, and only faces without area are dropped.

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

/// The nearest point of a face, and the corner or edge on which it lies.
struct Nearest3 {
    V point;
    int corner = -1, edge = -1;  // at most one of them; edge i goes from corner i to corner i + 1
};

/// Where a segment goes through a face from its front.
struct Crossing {
    int face = -1;  // none
    Real t = 2;     // share of the segment
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
    int triangle(int face) const { return given_[face]; }  // its number in the input
    int face_of(int triangle) const {                      // -1: it has no area, or does not exist
        const auto at = std::lower_bound(given_.begin(), given_.end(), triangle);
        return at != given_.end() && *at == triangle ? static_cast<int>(at - given_.begin()) : -1;
    }
    bool closed() const { return open_edges_ == 0; }
    std::size_t open_edges() const { return open_edges_; }
    /// Closed except for a few holes, so that `winding` still separates inside and outside.
    bool nearly_closed() const { return open_edges_ < face_.size() / 10; }

    /// The face beyond an edge on the front side, and its edge: 3 face + edge; -1: none. Where more than two
    /// faces meet, it is the first in a turn about the edge from the front.
    int over(int face, int edge) const { return over_[face][edge]; }
    /// The faces around a corner that are connected over edges, beginning with the given one.
    std::vector<int> fan(int face, int corner) const;

    Nearest3 nearest(int face, const V& p) const;
    /// The nearest of all faces: by searching all of them, and by searching the grid's cells.
    int nearest_face(const V& p) const;
    int nearest_face_near(const V& p) const;
    /// The direction of the front at such a point: the face's normal, the mean of an edge's two, or a
    /// corner's weighted by angles. At the edge of a two-sided sheet these cancel out, and it is the face's
    /// normal.
    V pseudonormal(int face, const Nearest3& at) const;
    /// Beyond it there is no face, or only the other side of the same sheet.
    bool rim(int face, const Nearest3& at) const;
    /// An edge without a face beyond it is within `reach`.
    bool near_rim(const V& at, Real reach) const;
    /// One of the faces that hold `at` lies on the way from `start` to the hand.
    bool blocked(const V& at, const V& start, const V& hand) const;

    /// The first face through which a -> b goes from its front; a may already be behind it by `behind` (m).
    /// `but`: excludes the faces on which this point lies.
    Crossing sweep(const V& a, const V& b, Real behind, const V* but = nullptr) const;
    /// The same, but tests every triangle instead of those in the grid's cells.
    Crossing sweep_all(const V& a, const V& b, Real behind, const V* but = nullptr) const;

    /// How often the surface winds around p: 1 inside of a closed one, 0 outside of it.
    Real winding(const V& p) const;

    /// By how much (m) a face on which p lies (to within `near`) has a point nearer to the hand than p.
    /// Searches all faces; with `from`, only those at p that are connected with that face there.
    Real gain(const V& p, const V& hand, Real near, int from = -1) const;
    /// The same over all faces to which the way from p is free, at which the proxy could be as well.
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
    std::vector<std::uint32_t> begin_, in_cell_;  // begin_: of each cell, and one past the last
};

}  // namespace exact
