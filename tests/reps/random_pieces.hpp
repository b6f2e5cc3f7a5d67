#pragma once
// Random polygons and half-planes, and the same in long double: plane, inside, nearest point, crossing.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <knurl/reps/half_plane.hpp>
#include <knurl/reps/polygon.hpp>

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

/// A piece, exactly. Distances in the plane are positive inside.
struct Exact {
    Vec normal, origin;
    std::vector<Vec> corners;  // polygon
    Vec edge;                  // half-plane: unit, outwards; origin lies on it
    Vec middle;                // of a half-plane: on its edge
    Real ball = INFINITY;      // m, about `middle`, around it
    Real largest = 0;          // m, largest coordinate involved

    explicit Exact(const Polygon& polygon) {
        for (std::uint32_t i = 0; i < polygon.vertices.count; ++i) {
            corners.push_back(exact(polygon.vertices.at[i]));
            largest = std::max(largest, corners.back().norm());
        }
        Real best = 0;  // the largest triangle gives the plane
        for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
            for (std::size_t j = i + 1; j < corners.size(); ++j) {
                const Vec area = (corners[i] - corners[0]).cross(corners[j] - corners[0]);
                if (area.norm() > best) {
                    best = area.norm();
                    normal = area / best;
                }
            }
        }
        origin = corners[0];
        middle = Vec::Zero();
        for (const Vec& corner : corners) middle += corner / static_cast<Real>(corners.size());
        ball = 0;
        for (const Vec& corner : corners) ball = std::max(ball, (corner - middle).norm());
    }
    explicit Exact(const HalfPlane& raw) {
        const Vec n = exact(raw.normal), e = exact(raw.edge);
        normal = n / n.norm();
        // The point of both planes that is nearest to the world's origin.
        const Vec across = n.cross(e);
        origin = (raw.offset * e.cross(across) + raw.edge_offset * across.cross(n)) / across.squaredNorm();
        edge = e - normal * normal.dot(e);
        edge /= edge.norm();
        middle = origin;
        largest = origin.norm();
    }

    Real height(const Vec& p) const { return normal.dot(p - origin); }
    /// How far the foot of p lies inside (the least of all edges); negative: outside.
    Real inside(const Vec& p) const {
        if (corners.empty()) return -edge.dot(p - origin);
        Real least = INFINITY;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec along = (corners[(i + 1) % corners.size()] - corners[i]).normalized();
            least = std::min(least, normal.cross(along).dot(p - corners[i]));
        }
        return least;
    }
    Vec nearest(const Vec& p) const {
        const Vec foot = p - height(p) * normal;
        if (inside(p) >= 0) return foot;
        if (corners.empty()) return foot + inside(p) * edge;
        Vec best = corners[0];
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec a = corners[i], along = corners[(i + 1) % corners.size()] - a;
            const Vec x = a + std::clamp<Real>(along.dot(p - a) / along.squaredNorm(), 0, 1) * along;
            if ((p - x).norm() < (p - best).norm()) best = x;
        }
        return best;
    }
    /// A point `height` over the middle of the piece, sideways by up to `spread`.
    Vector over(Rng& rng, double spread, double height_) const {
        const Vec side = exact(direction(rng));
        return (middle + spread * (side - normal * normal.dot(side)) + height_ * normal).cast<double>();
    }
};

/// The expected contact by the written rules (piece.hpp), in long double. `clear` is the margin of the last
/// cycle's decisions (m): a margin within rounding decides by chance.
struct Expected {
    Exact piece;
    bool both;
    bool met = false;
    Vec last = Vec::Zero();
    int touched = 0;
    enum { no, slipped, from_behind } let_go = no;
    Real clear = INFINITY;

    struct ExpectedContact {
        bool none = false;
        Vec normal;
        Real height = 0;
    };
    // A step that ends farther away has led past it.
    bool reached(const Vec& p, Real radius) {
        const Real over = piece.ball + radius - (p - piece.middle).norm();
        clear = std::min(clear, std::abs(over));
        return over > 0;
    }
    ExpectedContact at(const Vec& p, Real radius) {
        const Real h = piece.height(p), in = piece.inside(p);
        clear = std::min({std::abs(h), std::abs(in), std::abs((p - piece.nearest(p)).norm() - radius)});
        const int side = h > 0 ? 1 : -1;
        if (touched != 0) {
            if (side != touched && in < 0) let_go = slipped;
            if (side == touched || in < 0) touched = 0;
        } else if (met && piece.height(last) * h < 0 && let_go != from_behind && reached(p, radius)) {
            const int from = -side;
            const Real before = std::abs(piece.height(last)), share = before / (before + std::abs(h));
            const Real crossing = piece.inside(last + share * (p - last));
            clear = std::min(clear, std::abs(crossing));
            if (crossing > 0) {
                let_go = from < 0 && !both ? from_behind : in < 0 ? slipped : no;
                if (let_go == no) touched = from;
            }
        }
        met = true;
        last = p;
        if (touched != 0) return {false, touched * piece.normal, touched * h - radius};
        const bool under = side < 0 && in > 0 && !both;
        const Vec away = p - piece.nearest(p);
        if (under) {
            let_go = from_behind;
        } else if (away.norm() > radius) {
            let_go = no;
        }
        if (let_go != no) return {true, {}, 0};
        return {false, away / away.norm(), away.norm() - radius};
    }
};

}  // namespace knurl::test
