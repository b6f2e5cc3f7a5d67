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

/// Half way to its core a solid's nearest surface turns round. From there on the contact keeps the normal
/// that it had.
struct Core {
    Vec3 normal = {};        // the contact's while it touches, else 0 0 0
    std::uint32_t deep = 0;  // the part of the solid (1, 2, ...) whose normal is kept; 0: none is
    std::uint32_t reserved = 0;
};

struct SolidState {
    Motion motion;
    Core core;
};

namespace detail {
inline constexpr std::string_view sides[] = {"outside", "inside"};
}

template <class R>
constexpr Field center_row() {
    return {.name = "center",
            .type = Field::Type::vector,
            .offset = offsetof(R, center),
            .unit = "m",
            .meaning = "its middle",
            .minimum = -1e9,
            .maximum = 1e9};
}
template <class R>
constexpr Field axis_row() {
    return {.name = "axis",
            .type = Field::Type::vector,
            .offset = offsetof(R, axis),
            .unit = "1",
            .meaning = "its direction",
            .minimum = -1e9,
            .maximum = 1e9,
            .nonzero = true};
}
constexpr Field length_row(std::string_view name, std::size_t offset, std::string_view meaning) {
    return {.name = name, .offset = offset, .unit = "m", .meaning = meaning, .minimum = 0, .maximum = 1e9};
}
template <class R>
constexpr Field side_row() {
    return {.name = "side",
            .type = Field::Type::choice,
            .offset = offsetof(R, side),
            .meaning = "where free space is",
            .choices = detail::sides};
}

}  // namespace knurl
