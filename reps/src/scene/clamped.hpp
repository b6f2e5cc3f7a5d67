#pragma once
// Shared by the representations' sources: the clamps of stiffness and damping, the linear approach, the clamp
// of a vector.

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include <knurl/reps/limits.hpp>

namespace knurl {

/// Converts a length (m) or a stiffness (N/m; also a damping, N s/m) from the hand to the world. So it is the
/// same at the hand in a world of any scale.
inline double world_length(double length, const Limits& limits) noexcept {
    return length * limits.metre;
}
inline double world_stiffness(double stiffness, const Limits& limits) noexcept {
    return stiffness * limits.newton / limits.metre;
}

/// The length at the hand (m) over which the direction at a centre is rounded off, unless it has a shorter
/// one.
inline constexpr double hand_rounding = 1e-3;

/// Replaces an infinite stiffness where no device gives a limit (N/m, at the hand).
inline constexpr double unlimited_stiffness = 1000;

/// The upper bound of this stiffness (N/m); infinity: unbounded.
inline double largest_stiffness(double requested, const Limits& limits) noexcept {
    if (std::isfinite(limits.max_stiffness)) return std::max(0.0, limits.max_stiffness);
    return std::isinf(requested) ? world_stiffness(unlimited_stiffness, limits) : limits.max_stiffness;
}

inline double clamped_stiffness(double stiffness, const Limits& limits) noexcept {
    return std::min(stiffness, largest_stiffness(stiffness, limits));
}

/// The largest stable damping made from the device's measured velocity (N s/m): b <= m / (4 (T + tau +
/// tau_f)), tau_f the time constant of the velocity's filter. Unknown mass: `modest_damping`. No device:
/// unbounded.
inline constexpr double modest_damping = 10;                     // N s/m, at the hand
inline constexpr double velocity_filter = 1 / (2 * M_PI * 100);  // s, first order 100 Hz

inline double largest_damping(const Limits& limits) noexcept {
    if (!std::isfinite(limits.max_stiffness)) return std::numeric_limits<double>::infinity();
    if (!(limits.mass > 0)) return world_stiffness(modest_damping, limits);
    return limits.mass / (4 * (std::max(0.0, limits.period) + std::max(0.0, limits.lag) + velocity_filter));
}

inline double clamped_damping(double damping, const Limits& limits) noexcept {
    return std::min(damping, largest_damping(limits));
}

/// One step of a linear approach that ends in `remaining` seconds: `move` gets the share of the remaining
/// way. The last step takes all of it, and allows for the rounding of a sum of dt.
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
