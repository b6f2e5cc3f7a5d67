#pragma once
// Flat finite pieces and boxes, which remember from where the probe came: evaluates one step of a path at a
// time.

#include <optional>
#include <vector>

#include "cap.hpp"

namespace exact {

/// A convex polygon, or a half-plane (one edge). It lies in normal . (x - point) = 0.
struct Piece {
    V point, normal;         // of a half-plane the point lies on its edge
    std::vector<V> corners;  // in order, counter-clockwise about the normal; none: a half-plane
    V edge;                  // of a half-plane: unit, in the plane, out of the face ...
    Real edge_offset = 0;    // ... whose points have edge . x <= edge_offset
    bool both_sides = false;
    Real ball = INFINITY;  // m, about `point`: a step that ends farther away has led past the piece

    bool over(const V& x) const;    // whether x lies above or below the face
    V nearest(const V& x) const;    // the face's nearest point
    Real margin(const V& x) const;  // m, from x's foot to the nearest edge
};
Piece polygon(const std::vector<V>& corners, bool both_sides);
Piece half_plane(const V& normal, Real offset, const V& edge, Real edge_offset, bool both_sides);

/// One probe's path beside a piece.
class PieceTouch {
  public:
    /// Empty: the piece is not felt, whatever the distance.
    std::optional<Foot> step(const Piece& piece, const V& probe, Real radius);
    Real doubt = INFINITY;  // m, the smallest margin of the last step's decisions

    int touched() const { return touched_; }  // 1: held in front, -1: behind, 0: not

  private:
    enum class LetGo { no, slipped, from_behind };  // until the probe is clear of it
    bool met_ = false;
    V last_;
    int touched_ = 0;
    LetGo let_go_ = LetGo::no;
};

struct Box {
    V center, half;
    Turn orientation;
};
class BoxTouch {
  public:
    std::optional<Foot> step(const Box& box, const V& probe, Real radius);
    Real doubt = INFINITY;

  private:
    bool met_ = false, slipped_ = false;
    V last_;
    int axis_ = -1, sign_ = 1;
};
/// A hollow box: the vector from the probe to the nearest point at which the probe fits in.
V hollow_box(const Box& box, const V& probe, Real radius);

}  // namespace exact
