#pragma once
// Random polygons and half-planes.

#include <gtest/gtest.h>

#include <knurl/reps/half_plane.hpp>
#include <knurl/reps/polygon.hpp>

#include "../reference/parameters.hpp"
#include "piece_tools.hpp"
#include "random_polygon.hpp"

namespace knurl::test {

inline HalfPlane random_half_plane(Rng& rng, double far) {
    HalfPlane half;
    half.stiffness = 1000;
    half.normal = to_plain(scale(rng, 1e-3, 1e3) * direction(rng));
    half.edge = to_plain(scale(rng, 1e-3, 1e3) * direction(rng));
    half.offset = uniform(rng, -1, 1) * far * to_eigen(half.normal).norm();
    half.edge_offset = uniform(rng, -1, 1) * far * to_eigen(half.edge).norm();
    return half;
}

using PieceKinds = testing::Types<Polygon, HalfPlane>;

template <class R>
R random_piece(Rng& rng, double size, double far) {
    if constexpr (std::is_same_v<R, Polygon>) {
        return random_polygon(rng, size, far);
    } else {
        return random_half_plane(rng, far);
    }
}

/// A 40 mm square in z = 0 about the origin, facing up.
inline Polygon square(Sides sides = Sides::front) {
    Polygon polygon;
    polygon.vertices = {.at = {{-.02, -.02, 0}, {.02, -.02, 0}, {.02, .02, 0}, {-.02, .02, 0}}, .count = 4};
    polygon.stiffness = 1000;
    polygon.sides = sides;
    return polygon;
}

/// A point `height` over the middle of the piece (of a half-plane: over its edge), sideways by up to `spread`.
inline Vector over(const exact::Piece& piece, Rng& rng, double spread, double height) {
    const exact::V side = exact::flattened(exact::real(direction(rng)), piece.normal);
    return exact::rounded(piece.point + spread * side + height * piece.normal);
}

}  // namespace knurl::test
