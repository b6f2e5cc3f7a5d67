#pragma once
// Planes that the probe cannot have come to since their distances were last evaluated. A distance to a plane
// changes by no more than the probe moves: while it has moved less than the nearest plane was away, none is
// touched, and none needs to be evaluated.

#include "contact/contact_sets.hpp"

namespace knurl::detail {

/// None of them is touched at p. Rounding, that of what was scanned and of this, moves none of it across.
[[gnu::always_inline]] inline bool still_clear(const ClearOfPlanes& clear,
                                               const Eigen::Vector3d& p) noexcept {
    const double left = clear.distance * (1 - 1e-12) - 1e-14 * (p.lpNorm<1>() + clear.at.lpNorm<1>());
    return left > 0 && (p - clear.at).squaredNorm() < left * left * (1 - 1e-12);
}

/// The worst violation of those that stand; where it is at most 0 it may be that of a place near by, and so may what
/// the arena says of each.
[[gnu::always_inline]] inline double evaluate_standing(ContactSet& set, const Arena& a,
                                                       const Eigen::Vector3d& p) noexcept {
    const std::uint32_t begin = set.begin;
    const bool alone = set.moving_count == 0;
    if (alone && still_clear(set.clear, p)) return -set.clear.distance;
    const double worst =
        shift_to_probe(&a.nx[begin], &a.ny[begin], &a.nz[begin], &a.c[begin], set.count, p, &a.s[begin]);
    if (alone) set.clear = {.at = p, .distance = -worst};
    return worst;
}

}  // namespace knurl::detail
