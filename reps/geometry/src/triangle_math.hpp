#pragma once
// One triangle: its point nearest to the hand, and where a segment pierces it from the front. All in double;
// the only error is rounding. -ffp-contract=off makes a x b = -(b x a) exact to the last bit.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "vec.hpp"

namespace knurl::detail {

struct Corners {
    Vec at[3];
    Vec side(std::uint32_t i) const noexcept { return at[i == 2 ? 0 : i + 1] - at[i]; }
    Vec normal() const noexcept {
        return (at[1] - at[0]).cross(at[2] - at[0]);
    }  // its length: twice the
       // area
};

inline constexpr std::uint32_t after(std::uint32_t i) noexcept {
    return i == 2 ? 0 : i + 1;
}
inline constexpr std::uint32_t before(std::uint32_t i) noexcept {
    return i == 0 ? 2 : i - 1;
}

/// A place on a face: a corner (0 to 2), an edge (3 to 5), or inside.
using Place = std::uint32_t;
inline constexpr Place within = 6;

/// The point of a face nearest to h.
struct Nearest {
    Vec point, normal;  // not of unit length
    double square;      // of the distance
    double height;      // of h over the face's plane, times the normal's length
    Place place;
};

/// Not inlined: it is called at many places, and cold code costs more than a call. Uses the normal, not Gram
/// determinants, so that the edges of needles stay exact to rounding.
[[gnu::noinline]] inline Nearest nearest_on(const Corners& face, const Vec& h) noexcept {
    const Vec ab = face.at[1] - face.at[0], bc = face.at[2] - face.at[1], ca = face.at[0] - face.at[2];
    const Vec a = h - face.at[0], b = h - face.at[1], c = h - face.at[2];
    const Vec normal = ca.cross(ab);
    const double in[3] = {normal.dot(ab.cross(a)), normal.dot(bc.cross(b)), normal.dot(ca.cross(c))};
    Nearest out;
    out.normal = normal;
    out.height = normal.dot(a);
    if (in[0] > 0 && in[1] > 0 && in[2] > 0) {
        const double length = normal.squaredNorm();
        if (length > 0) {
            out.point = h - normal * (out.height / length);
            out.square = out.height * out.height / length;
            out.place = within;
            return out;
        }
    }
    out.square = HUGE_VAL;
    out.place = 0;
    const Vec* const from[3] = {&a, &b, &c};
    const Vec* const side[3] = {&ab, &bc, &ca};
    for (std::uint32_t i = 0; i < 3; ++i) {
        if (in[i] > 0) continue;
        const double length = side[i]->squaredNorm(), along = from[i]->dot(*side[i]);
        Vec point;
        Place place;
        if (!(along > 0)) {
            point = face.at[i], place = i;
        } else if (!(along < length)) {
            point = face.at[after(i)], place = after(i);
        } else {
            point = face.at[i] + *side[i] * (along / length), place = 3 + i;
        }
        const double square = (h - point).squaredNorm();
        if (square < out.square) out.point = point, out.square = square, out.place = place;
    }
    if (out.square == HUGE_VAL) out.point = face.at[0];  // no point is nearest: NaN or overflow
    return out;
}

/// Where p + t d pierces the face from the front: t, or NaN. Edges are inclusive.
inline double pierced(const Corners& face, const Vec& p, const Vec& d) noexcept {
    const Vec a = face.at[0] - p, b = face.at[1] - p, c = face.at[2] - p;
    const double u = d.dot(c.cross(b)), v = d.dot(a.cross(c)), w = d.dot(b.cross(a));
    const double sum = u + v + w;
    const double slack = -1e-12 * (std::abs(u) + std::abs(v) + std::abs(w));
    if (!(sum > 0) || u < slack || v < slack || w < slack) return NAN;
    const Vec normal = (face.at[1] - face.at[0]).cross(face.at[2] - face.at[0]);
    const double against = normal.dot(d);
    if (!(against < 0)) return NAN;
    return normal.dot(a) / against;
}

/// The angle of the face at its corner i.
inline double angle_at(const Corners& face, std::uint32_t i) noexcept {
    const Vec to = face.at[after(i)] - face.at[i], from = face.at[before(i)] - face.at[i];
    return std::atan2(to.cross(from).norm(), to.dot(from));
}

}  // namespace knurl::detail
