#pragma once
// What the representations' sources share: the clamps of stiffness and damping, the linear approach, the
// clamp of a vector.

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include <knurl/reps/limits.hpp>

namespace knurl {

/// A length (m) or stiffness (N/m; a damping, N s/m, likewise) of the hand, as the world has it: for the hand
/// the same in a world of any size.
inline double world_length(double length, const Limits& limits) noexcept {
    return length * limits.metre;
}
inline double world_stiffness(double stiffness, const Limits& limits) noexcept {
    return stiffness * limits.newton / limits.metre;
}

/// Over what length of the hand (m) the direction at a centre is rounded off, where that is the shorter one.
inline constexpr double hand_rounding = 1e-3;

/// What "infinite" means where no device says what it allows (N/m, of the hand).
inline constexpr double unlimited_stiffness = 1000;

/// What bounds this stiffness (N/m); infinity where nothing does.
inline double largest_stiffness(double requested, const Limits& limits) noexcept {
    if (std::isfinite(limits.max_stiffness)) return std::max(0.0, limits.max_stiffness);
    return std::isinf(requested) ? world_stiffness(unlimited_stiffness, limits) : limits.max_stiffness;
}

inline double clamped_stiffness(double stiffness, const Limits& limits) noexcept {
    return std::min(stiffness, largest_stiffness(stiffness, limits));
}

/// The most that a device stands of damping made from its measured velocity (N s/m): b <= m / (4 (T + tau +
/// tau_f)), tau_f the time constant of the velocity's filter. Where its mass is not known, `modest_damping`.
/// Without a device, any.
inline constexpr double modest_damping = 10;                     // N s/m, of the hand
inline constexpr double velocity_filter = 1 / (2 * M_PI * 100);  // s, first order 100 Hz

inline double largest_damping(const Limits& limits) noexcept {
    if (!std::isfinite(limits.max_stiffness)) return std::numeric_limits<double>::infinity();
    if (!(limits.mass > 0)) return world_stiffness(modest_damping, limits);
    return limits.mass / (4 * (std::max(0.0, limits.period) + std::max(0.0, limits.lag) + velocity_filter));
}

inline double clamped_damping(double damping, const Limits& limits) noexcept {
    return std::min(damping, largest_damping(limits));
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
