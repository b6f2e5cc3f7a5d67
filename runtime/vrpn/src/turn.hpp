#pragma once
// From a client's axes to the device's. Private to this module.

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <knurl/gateway/frames.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl::vrpn {

/// A coordinate that is more is a mistake (m).
inline constexpr double farthest = 1000;

inline Vec3 vec_of(const float* values) noexcept {
    return {values[0], values[1], values[2]};
}

/// The rotation (or reflection) that takes a client's vectors to the device's frame.
inline Eigen::Matrix3d turn_of(const gateway::Axes& to_device) noexcept {
    Eigen::Matrix3d turn;
    turn.col(0) = to_eigen(to_device.direction({1, 0, 0}));
    turn.col(1) = to_eigen(to_device.direction({0, 1, 0}));
    turn.col(2) = to_eigen(to_device.direction({0, 0, 1}));
    return turn;
}

/// Empty, or which value is no number between these: `what` is its name.
inline std::string refuse(std::string_view what, double value, double low, double high) {
    if (value >= low && value <= high) return {};
    return fmt::format("{} is {:g}; it must be {:g} to {:g}", what, value, low, high);
}
/// Empty, or which of the values is too large or no number.
inline std::string refuse_all(std::string_view what, std::span<const float> values, double most) {
    for (const float value : values)
        if (!(std::abs(value) <= most))
            return fmt::format("{} has the value {:g}; it must be {:g} to {:g}", what, value, -most, most);
    return {};
}

}  // namespace knurl::vrpn
