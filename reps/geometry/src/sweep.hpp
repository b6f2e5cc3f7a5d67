#pragma once
// Where a segment first meets the front of a face. The segment is cut into short pieces, each of which
// queries the tree with its box. For pieces this short a box is as tight as a slab test, needs no division,
// and is conservative without an epsilon.

#include <algorithm>
#include <cmath>

#include <knurl/geometry/proxy.hpp>

#include "triangle_math.hpp"
#include "walk.hpp"

namespace knurl::detail {

inline constexpr double piece_of_size = 1.0 / 400;  // a hand step of 0.5 mm on a surface of 20 cm

struct Hit {
    std::uint32_t face = no_face;
    double t = HUGE_VAL;  // share of the segment
    Vec point;            // where the face is met; else how far the segment was searched
    bool whole = true;    // false: a limit was reached before the end
};

/// From p to q; a face up to `behind` (m) behind p still counts. take(face, corners, t) says whether a face
/// counts.
template <class S, class Take>
Hit sweep(const S& s, const Vec& p, const Vec& q, double behind, Work& work, Take&& take) noexcept {
    ++work.sweeps;
    Hit hit;
    const Vec d = q - p;
    const double length = d.norm();
    const double first = length > 0 ? -behind / length : 0;
    const auto pieces = static_cast<std::uint32_t>(
        std::clamp(std::ceil(length / (s.size() * piece_of_size)), 1.0, double{max_pieces}));
    for (std::uint32_t i = 0; i < pieces; ++i) {
        ++work.pieces;
        const double end = i + 1 == pieces ? 1 : static_cast<double>(i + 1) / pieces;
        const Vec a = p + d * (static_cast<double>(i) / pieces), b = p + d * end;
        const Vec low = low_of(a, b, behind), high = high_of(a, b, behind);
        const bool all = s.overlapping(low, high, work, [&](std::uint32_t face) {
            const Corners corners = s.corners(face);
            const double t = pierced(corners, p, d);
            if (t >= first && t <= 1 && t < hit.t && take(face, corners, t)) hit.t = t, hit.face = face;
        });
        if (hit.t <= end) break;
        if (!all) {
            hit.point = a;
            hit.face = no_face;
            hit.whole = false;
            return hit;
        }
    }
    hit.point = hit.face == no_face ? q : p + d * std::max(hit.t, 0.0);
    return hit;
}

}  // namespace knurl::detail
