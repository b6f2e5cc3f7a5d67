#include <algorithm>
#include <cmath>

#include <knurl/reps/capsule.hpp>

#include "surfaces/round_solid.hpp"

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
    RoundSolid solid(to_eigen(params.axis), params.half_length, params.radius + probe.radius);
    if (params.side == Side::inside) {
        const Vector3d away = solid.from_core(q);
        const double length = away.norm();
        const Vector3d out = direction_or(away, length, Vec3{}, to_eigen(params.axis));
        return contact_of(params, -out, room(params.radius, probe) - length);
    }
    const Facing now = facing_of(solid, q, solid.natural(q, state.hold), state.hold, dt);
    return contact_of(params, now.normal, now.height);
}

std::uint32_t curved(const Capsule& params, const Capsule::State& state, const Probe&, const Probe& there,
                     std::span<CurvedContact> out) noexcept {
    if (state.hold.part != 0) return 0;
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, there);
    const RoundSolid solid(to_eigen(params.axis), params.half_length, params.radius + there.radius);
    out[0] = solid.curved(q);
    if (params.side == Side::inside)
        out[0] = hollow(out[0], room(params.radius, there) - solid.from_core(q).norm());
    return 1;
}

void lean(const Capsule& params, Capsule::State& state, const Probe& there, double below) noexcept {
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, there);
    meet(state.hold, RoundSolid(to_eigen(params.axis), params.half_length, params.radius).curved(q).normal,
         below);
}

bool plane_alone(const Capsule& params, const Capsule::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept {
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, probe);
    const RoundSolid solid(to_eigen(params.axis), params.half_length, params.radius + probe.radius);
    return plane_alone(solid, q, state.hold, stiffness, out);
}

std::optional<Bound> bound(const Capsule& params, const Capsule::State& state) noexcept {
    return ball_about(params, state, params.half_length + params.radius);
}

void out_of_reach(const Capsule&, Capsule::State& state) noexcept {
    state.hold = {};
}

}  // namespace knurl
