#include <knurl/reps/sphere.hpp>

#include "solid.hpp"

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
    const double length = q.norm();
    const Vector3d out = direction_or(q, length, state.core.normal, Vector3d::UnitZ());
    if (params.side == Side::inside) return contact_of(params, -out, room(params.radius, probe) - length);
    const double reach = params.radius + probe.radius;
    const Facing now = guarded({out, length - reach}, reach / 2, state.core, dt,
                               [&](const Vector3d& n) { return n.dot(q) - reach; });
    return contact_of(params, now.normal, now.height);
}

std::optional<Bound> bound(const Sphere& params, const Sphere::State& state) noexcept {
    return ball_about(params, state, params.radius);
}

void out_of_reach(const Sphere&, Sphere::State& state) noexcept {
    state.core = {};
}

}  // namespace knurl
