#pragma once

/// @file
/// The axes and units of other systems, and the ways there from Knurl's device frame and back. Knurl's: x away from
/// the base, towards the user; y right; z up; metres, newtons, radians; quaternions turn vectors of the tool's frame
/// into the device's (drivers/README.md).
///
///     const Vec3 shown = frames::haply.position(report.position);     // (y, -x, z)
///     const Vec3 force = frames::haply.back().direction(theirs);      // and back
///
/// Each map is a signed permutation of the axes, so it is exact: there and back gives every bit back.

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string_view>

#include <knurl/reps/vec.hpp>

namespace knurl::gateway {

/// Other axes, and another unit of length.
class Axes {
  public:
    /// Which axis of the vector the three new ones are, counted from 1, with its sign: {2, -1, 3} is (y, -x, z).
    /// `metre`: what a metre is in the other system.
    constexpr explicit Axes(std::array<std::int8_t, 3> axes = {1, 2, 3}, double metre = 1) noexcept
        : axes_(axes), metre_(metre) {}

    /// From "XYZ", "XZY", "X-YZ": which axis of the vector the three new ones are, as clients of the Inverse Service
    /// write it. None: it does not name each axis once.
    static constexpr std::optional<Axes> parse(std::string_view permutation) noexcept {
        std::array<std::int8_t, 3> axes{};
        std::size_t count = 0;
        std::int8_t sign = 1;
        bool signed_already = false;
        for (const char c : permutation) {
            if (c == '+' || c == '-') {
                if (signed_already) return std::nullopt;
                signed_already = true;
                sign = c == '-' ? -1 : 1;
                continue;
            }
            if (c < 'X' || c > 'Z' || count == axes.size()) return std::nullopt;
            const auto axis = static_cast<std::int8_t>(c - 'X' + 1);
            for (std::size_t i = 0; i < count; ++i)
                if (axes[i] == axis || axes[i] == -axis) return std::nullopt;
            axes[count++] = static_cast<std::int8_t>(sign * axis);
            sign = 1;
            signed_already = false;
        }
        if (count != axes.size() || signed_already) return std::nullopt;
        return Axes(axes);
    }

    /// A position or a length along the axes: a velocity, too.
    constexpr Vec3 position(const Vec3& v) const noexcept {
        const Vec3 turned = direction(v);
        return {metre_ * turned.x, metre_ * turned.y, metre_ * turned.z};
    }
    /// A direction or a force: the axes alone.
    constexpr Vec3 direction(const Vec3& v) const noexcept {
        return {along(v, axes_[0]), along(v, axes_[1]), along(v, axes_[2])};
    }
    /// A torque, an angular velocity, an axis of rotation. In a mirrored system these turn the other way round.
    constexpr Vec3 axial(const Vec3& v) const noexcept {
        const Vec3 turned = direction(v);
        return mirrored() ? Vec3{-turned.x, -turned.y, -turned.z} : turned;
    }
    /// An orientation, the tool's own axes being renamed as those of the base are: what is turned by nothing stays so.
    constexpr Quat orientation(const Quat& q) const noexcept {
        const Vec3 axis = axial({q.x, q.y, q.z});
        return {q.w, axis.x, axis.y, axis.z};
    }

    /// The way back.
    constexpr Axes back() const noexcept {
        std::array<std::int8_t, 3> axes{};
        for (std::size_t i = 0; i < axes.size(); ++i) {
            const std::int8_t from = axes_[i];
            axes[static_cast<std::size_t>((from < 0 ? -from : from) - 1)] =
                static_cast<std::int8_t>((from < 0 ? -1 : 1) * static_cast<int>(i + 1));
        }
        return Axes(axes, 1 / metre_);
    }
    /// First this map, then that one.
    constexpr Axes then(const Axes& next) const noexcept {
        std::array<std::int8_t, 3> axes{};
        for (std::size_t i = 0; i < axes.size(); ++i) {
            const std::int8_t from = next.axes_[i];
            const std::int8_t first = axes_[static_cast<std::size_t>((from < 0 ? -from : from) - 1)];
            axes[i] = static_cast<std::int8_t>(from < 0 ? -first : first);
        }
        return Axes(axes, metre_ * next.metre_);
    }
    /// It turns a right hand into a left one.
    constexpr bool mirrored() const noexcept {
        const auto index = [this](std::size_t i) { return axes_[i] < 0 ? -axes_[i] : axes_[i]; };
        int sign = 1;
        for (std::size_t i = 0; i < 3; ++i) {
            if (axes_[i] < 0) sign = -sign;
            for (std::size_t k = i + 1; k < 3; ++k)
                if (index(i) > index(k)) sign = -sign;
        }
        return sign < 0;
    }
    friend constexpr bool operator==(const Axes&, const Axes&) = default;

  private:
    static constexpr double along(const Vec3& v, std::int8_t axis) noexcept {
        const int number = axis < 0 ? -axis : axis;
        const double part = number == 1 ? v.x : number == 2 ? v.y : v.z;
        return axis < 0 ? -part : part;
    }

    std::array<std::int8_t, 3> axes_;
    double metre_;
};

/// From Knurl's device frame to the frames of others.
namespace frames {

/// Haply's Inverse Service: x right, y forward (away from the user), z up; metres.
inline constexpr Axes haply{{2, -1, 3}};
/// OpenHaptics: x right, y up, z towards the user; millimetres.
inline constexpr Axes openhaptics{{2, 3, 1}, 1000};
/// Force Dimension's SDK: as Knurl's.
inline constexpr Axes force_dimension{};
/// ROS, in the frame <device>_base: as Knurl's. A static transform says how the base stands.
inline constexpr Axes ros_base{};
/// ROS as REP 103 has it for one who sits before the device: x forward (away from the user), y left, z up.
inline constexpr Axes ros_user{{-1, -2, 3}};

/// Angles as Haply states them.
constexpr double degrees(double radians) noexcept {
    return radians * (180 / std::numbers::pi);
}
/// And back.
constexpr double radians(double degrees) noexcept {
    return degrees * (std::numbers::pi / 180);
}

}  // namespace frames

}  // namespace knurl::gateway
