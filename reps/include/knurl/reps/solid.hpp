#pragma once
// What sphere, capsule, cylinder and torus share: the side that is free, rows of fields, the servo's memory.

#include <cstddef>

#include <knurl/reps/field.hpp>
#include <knurl/reps/motion.hpp>

namespace knurl {

/// Where free space is.
enum class Side : std::uint32_t {
    outside = 0,  // around the solid
    inside = 1,   // in the hollow: the probe is held within
};

/// How a solid holds a probe that has come in deep: by the plane that supports it in a direction that is kept.
struct SolidHold {
    Vec3 normal = {};  // the contact's while it touches, else 0 0 0; of a ring in its section
    Vec3 radial = {};  // of a ring that holds: where around its axis
    Vec3 joint = {};   // 0 0 0, or its normal in the last cycle where it met other surfaces
    Vec3 alone = {};   // 0 0 0, or the normal that is kept where it holds alone, in layers above `met_below`
    Vec3 last = {};    // m, from the middle: the probe in the last cycle
    double met_below = 0;       // N/m, of `joint`: the hardest layer in which it met other surfaces
    std::uint32_t part = 0;     // of the solid (1, 2, ...) by which it holds; 0: it does not
    std::uint16_t turning = 0;  // 1: the normal that is kept is not that of the surface there
    std::uint16_t met = 0;      // 1: there was a last cycle
};

struct SolidState {
    Motion motion;
    SolidHold hold;
};

namespace detail {
inline constexpr std::string_view sides[] = {"outside", "inside"};
}

template <class R>
constexpr Field center_row() {
    return vector_row("center", offsetof(R, center), "m", "its middle");
}
template <class R>
constexpr Field axis_row() {
    return direction_row("axis", offsetof(R, axis), "its direction");
}
template <class R>
constexpr Field side_row() {
    return choice_row("side", offsetof(R, side), "where free space is", detail::sides);
}

}  // namespace knurl
