#include <knurl/reps/sphere.hpp>

#include "surfaces/round_solid.hpp"

namespace knurl {

using Eigen::Vector3d;

Sphere prepared(Sphere params, const Limits& limits) noexcept {
    return prepared_solid(params, limits);
}

void adopt(const Sphere& params, const Sphere* previous, Sphere::State& state, const Probe&) noexcept {
    adopt_solid(params, previous, state);
}

Contact contact(const Sphere& params, Sphere::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, probe);
    if (params.side == Side::inside) {
        const double length = q.norm();
        const Vector3d out = direction_or(q, length, Vec3{}, Vector3d::UnitZ());
        return contact_of(params, -out, room(params.radius, probe) - length);
    }
    RoundSolid solid(Vector3d::UnitZ(), 0, params.radius + probe.radius);
    const Facing now = facing_of(solid, q, solid.natural(q, state.hold), state.hold, dt);
    return contact_of(params, now.normal, now.height);
}

std::uint32_t curved(const Sphere& params, const Sphere::State& state, const Probe&, const Probe& there,
                     std::span<CurvedContact> out) noexcept {
    if (state.hold.part != 0) return 0;
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, there);
    out[0] = RoundSolid(Vector3d::UnitZ(), 0, params.radius + there.radius).curved(q);
    if (params.side == Side::inside) out[0] = hollow(out[0], room(params.radius, there) - q.norm());
    return 1;
}

void lean(const Sphere& params, Sphere::State& state, const Probe& there, double below) noexcept {
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, there);
    meet(state.hold, RoundSolid(Vector3d::UnitZ(), 0, params.radius).curved(q).normal, below);
}

bool plane_alone(const Sphere& params, const Sphere::State& state, const Probe& probe, double stiffness,
                 CurvedContact& out) noexcept {
    const Vector3d q = from_surface(params.center, params.velocity, state.motion, probe);
    const RoundSolid solid(Vector3d::UnitZ(), 0, params.radius + probe.radius);
    return plane_alone(solid, q, state.hold, stiffness, out);
}

std::optional<Bound> bound(const Sphere& params, const Sphere::State& state) noexcept {
    return ball_about(params, state, params.radius);
}

void out_of_reach(const Sphere&, Sphere::State& state) noexcept {
    state.hold = {};
}

}  // namespace knurl
