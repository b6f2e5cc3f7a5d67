#include <algorithm>
#include <cmath>

#include <knurl/reps/plane.hpp>

#include "surfaces/surface.hpp"

namespace knurl {
namespace {

double raw_height(const Plane& plane, const Plane::State& state, const Probe& probe) noexcept {
    const Eigen::Vector3d n = to_eigen(plane.normal);
    return n.dot(probe.position) - plane.offset - n.dot(to_eigen(plane.velocity)) * state.motion.time -
           probe.radius;
}

}  // namespace

void prepare_geometry(Plane& params) noexcept {
    const double square = to_eigen(params.normal).squaredNorm();
    if (square != 1) {
        const double length = std::sqrt(square);
        params.normal = {params.normal.x / length, params.normal.y / length, params.normal.z / length};
        params.offset /= length;
    }
}

Plane prepared(Plane params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    prepare_geometry(params);
    return params;
}

void adopt(const Plane& params, const Plane* previous, Plane::State& state, const Probe& probe) noexcept {
    const bool recovers = recovers_itself(params);
    const double felt =
        recovers && previous ? std::max(0.0, -(raw_height(*previous, state, probe) + state.lowered)) : 0;
    if (!previous || !(params.normal == previous->normal) || params.offset != previous->offset ||
        !(params.velocity == previous->velocity)) {
        place(state.motion);
    }
    state.lowered = 0;
    state.remaining = 0;
    if (!recovers) return;
    const double depth = -raw_height(params, state, probe);
    if (!(depth > 0)) return;  // the surface now leaves the probe outside: no recovery is needed
    state.lowered = params.update == PlaneUpdate::paper ? depth : depth - felt;
    state.remaining = params.recovery == automatic ? paper_recovery : params.recovery;
    if (!(state.remaining > 0)) state.lowered = 0;
}

Contact contact(const Plane& params, Plane::State& state, const Probe& probe, double dt) noexcept {
    if (state.remaining > 0 && dt > 0)
        advance(state.remaining, dt, [&](double share) { state.lowered -= share * state.lowered; });
    move_on(state.motion, dt);
    return contact_of(params, to_eigen(params.normal), raw_height(params, state, probe) + state.lowered);
}

void settle(const Plane&, Plane::State& state) noexcept {
    state.lowered = 0;
    state.remaining = 0;
}

}  // namespace knurl
