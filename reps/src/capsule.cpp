#include <algorithm>
#include <cmath>

#include <knurl/reps/capsule.hpp>

#include "solid.hpp"

namespace knurl {

using Eigen::Vector3d;

Capsule prepared(Capsule params, const Limits& limits) noexcept {
    return prepared_solid(params, limits);
}

void adopt(const Capsule& params, const Capsule* previous, Capsule::State& state, const Probe&) noexcept {
    adopt_solid(params, previous, state);
}

Contact contact(const Capsule& params, Capsule::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, probe);
    const Vector3d axis = to_eigen(params.axis);
    const Vector3d away = q - std::clamp(axis.dot(q), -params.half_length, params.half_length) * axis;
    const double length = away.norm();
    const Vector3d out = direction_or(away, length, state.core.normal, axis);
    if (params.side == Side::inside) return contact_of(params, -out, room(params.radius, probe) - length);
    const double reach = params.radius + probe.radius;
    const Facing now = guarded({out, length - reach}, reach / 2, state.core, dt, [&](const Vector3d& n) {
        return n.dot(q) - params.half_length * std::abs(n.dot(axis)) - reach;
    });
    return contact_of(params, now.normal, now.height);
}

std::optional<Bound> bound(const Capsule& params, const Capsule::State& state) noexcept {
    return ball_about(params, state, params.half_length + params.radius);
}

void out_of_reach(const Capsule&, Capsule::State& state) noexcept {
    state.core = {};
}

}  // namespace knurl
