#pragma once
// What the representations' sources share: the clamp of stiffness, the linear approach, the clamp of a
// vector.

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include <knurl/reps/limits.hpp>

namespace knurl {

/// What "infinite" means where no device says what it allows (N/m).
inline constexpr double unlimited_stiffness = 1000;

inline double clamped_stiffness(double stiffness, const Limits& limits) noexcept {
    const double largest = std::isfinite(limits.max_stiffness) ? std::max(0.0, limits.max_stiffness)
                           : std::isinf(stiffness)             ? unlimited_stiffness
                                                               : stiffness;
    return std::min(stiffness, largest);
}

/// One step of a linear approach that ends in `remaining` seconds: `move` gets the share of the rest to go.
/// The last step takes all of it, with room for the rounding of a sum of dt.
template <class Move>
void advance(double& remaining, double dt, Move move) noexcept {
    if (dt >= remaining * (1 - 1e-9)) {
        move(1.0);
        remaining = 0;
    } else {
        move(dt / remaining);
        remaining -= dt;
    }
}

inline Eigen::Vector3d clamped(const Eigen::Vector3d& v, double largest) noexcept {
    const double square = v.squaredNorm();
    return square > largest * largest ? Eigen::Vector3d(v * (largest / std::sqrt(square))) : v;
}

}  // namespace knurl
