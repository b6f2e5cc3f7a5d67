#pragma once

#include <optional>

#include <knurl/reps/concepts.hpp>

#include "surfaces/solid_hold.hpp"
#include "surfaces/surface.hpp"

namespace knurl {

template <class R>
R prepared_solid(R params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    if constexpr (requires { params.axis; }) params.axis = unit(params.axis);
    params.reserved = 0;
    return params;
}

template <class R>
void adopt_solid(const R& params, const R* previous, SolidState& state) noexcept {
    bool placed =
        !previous || !(params.center == previous->center) || !(params.velocity == previous->velocity);
    if constexpr (requires { params.axis; }) placed = placed || !(params.axis == previous->axis);
    if (placed) place(state.motion);
    if (previous && params.side != previous->side) state.hold = {};
}

/// The size of a hollow for a probe's centre. A probe larger than its hollow is held at the middle.
inline double room(double size, const Probe& probe) noexcept {
    return std::max(0.0, size - probe.radius);
}

/// The same surface, seen from inside.
inline CurvedContact hollow(const CurvedContact& solid, double height) noexcept {
    return {.normal = -solid.normal, .height = height, .bend = -solid.bend};
}

/// Bound of a solid that does not hold the probe (one that holds it may do so at any depth).
template <class R>
std::optional<Bound> ball_about(const R& params, const SolidState& state, double radius) noexcept {
    if (params.side == Side::inside || state.hold.part != 0) return std::nullopt;
    return Bound{.center = to_eigen(params.center) + state.motion.time * to_eigen(params.velocity),
                 .radius = radius};
}

}  // namespace knurl
