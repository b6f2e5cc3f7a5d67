#pragma once

/// @file
/// What sphere, capsule, cylinder and torus share: the side that is free, rows of fields, the servo's memory.

#include <cstddef>

#include <knurl/reps/field.hpp>
#include <knurl/reps/motion.hpp>

namespace knurl {

/// Where free space is.
enum class Side : std::uint32_t {
    /// Around the solid.
    outside = 0,
    /// In the hollow: the probe is held within.
    inside = 1,
};

/// How a solid holds a probe that has come in deep: by the plane that supports it in a direction that is
/// kept.
struct SolidHold {
    /// Normal of the contact while it touches, else 0 0 0; of a ring in its section.
    Vec3 normal = {};
    /// Of a ring that holds: direction from its axis.
    Vec3 radial = {};
    /// Normal in the last cycle in which it met other surfaces, or 0 0 0.
    Vec3 joint = {};
    /// Normal that is kept where it holds alone, in layers above `met_below`, or 0 0 0.
    Vec3 alone = {};
    /// The probe in the last cycle, from the middle (m).
    Vec3 last = {};
    /// Hardest layer in which it met other surfaces (N/m), of `joint`.
    double met_below = 0;
    /// Part of the solid (1, 2, ...) by which it holds; 0: it does not.
    std::uint32_t part = 0;
    /// 1: the normal that is kept is not that of the surface there.
    std::uint16_t turning = 0;
    /// 1: there was a last cycle.
    std::uint16_t met = 0;
};

/// The servo's memory of a solid.
struct SolidState {
    /// How far the surface has moved on since it was placed.
    Motion motion;
    /// How it holds the probe.
    SolidHold hold;
};

namespace detail {
inline constexpr std::string_view sides[] = {"outside", "inside"};
}

/// Row of `center`.
template <class R>
constexpr Field center_row() {
    return vector_row("center", offsetof(R, center), "m", "its middle");
}
/// Row of `axis`.
template <class R>
constexpr Field axis_row() {
    return direction_row("axis", offsetof(R, axis), "its direction");
}
/// Row of `side`.
template <class R>
constexpr Field side_row() {
    return choice_row("side", offsetof(R, side), "where free space is", detail::sides);
}

}  // namespace knurl
