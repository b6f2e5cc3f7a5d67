#pragma once
// Planes that the probe cannot have reached since their distances were last evaluated. A distance to a plane
// changes by no more than the probe moves. So while the probe has moved less than the distance of the nearest
// plane, it touches none, and none needs to be evaluated.

#include "contact/contact_sets.hpp"

namespace knurl::detail {

/// True: none of them is touched at p. Allows for the rounding of the scan and of this test.
[[gnu::always_inline]] inline bool still_clear(const ClearOfPlanes& clear,
                                               const Eigen::Vector3d& p) noexcept {
    const double left = clear.distance * (1 - 1e-12) - 1e-14 * (p.lpNorm<1>() + clear.at.lpNorm<1>());
    return left > 0 && (p - clear.at).squaredNorm() < left * left * (1 - 1e-12);
}

/// The worst violation of the standing planes. If it is at most 0, it and the arena's values may belong to a
/// place near by.
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
