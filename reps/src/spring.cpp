#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/spring.hpp>

#include "clamped.hpp"

namespace knurl {

Spring prepared(Spring params, const Limits& limits) noexcept {
    params.stiffness = clamped_stiffness(params.stiffness, limits);
    params.share = std::isfinite(limits.max_stiffness) && limits.max_stiffness > 0
                       ? params.stiffness / limits.max_stiffness
                       : 0;
    params.damping = clamped_damping(params.damping, limits);
    params.torsion = std::max(0.0, limits.max_torsion);
    return params;
}

void adopt(const Spring& params, const Spring* previous, Spring::State& state, const Probe&) noexcept {
    if (!previous) {
        settle(params, state);
    } else if (!(params.anchor == previous->anchor) || params.rest_length != previous->rest_length) {
        state.remaining = params.duration;
        if (!(params.duration > 0)) settle(params, state);
    }
}

Wrench evaluate(const Spring& params, Spring::State& state, const Probe& probe, double dt) noexcept {
    if (state.remaining > 0 && dt > 0) {
        advance(state.remaining, dt, [&](double share) {
            if (share >= 1) return settle(params, state);
            state.anchor.x += share * (params.anchor.x - state.anchor.x);
            state.anchor.y += share * (params.anchor.y - state.anchor.y);
            state.anchor.z += share * (params.anchor.z - state.anchor.z);
            state.rest_length += share * (params.rest_length - state.rest_length);
        });
    }
    const bool at_probe = params.attach == Vec3{};
    const Eigen::Vector3d arm = at_probe ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                         : Eigen::Vector3d(probe.orientation * to_eigen(params.attach));
    const Eigen::Vector3d d = (to_eigen(state.anchor) - probe.position) - arm;
    Wrench out;
    const double rest = state.rest_length;
    const double e = std::max(std::min(1e-3, rest / 20), rest * params.share);
    const double ee = e * e;  // 0 also where a rest length of next to nothing squares to nothing
    if (ee > 0) {
        out.force = params.stiffness * (1 - rest / std::sqrt(d.squaredNorm() + ee)) * d;
    } else {
        out.force = params.stiffness * d;
    }
    if (params.damping > 0) {
        const double ll = d.squaredNorm();
        if (ll > 1e-24) {  // below a picometre the direction is rounding
            Eigen::Vector3d v = probe.velocity;
            if (!at_probe) v += probe.angular_velocity.cross(arm);
            out.force -= (params.damping * v.dot(d) / ll) * d;
        }
    }
    if (!at_probe) {
        out.torque = arm.cross(out.force);
        if (params.torsion < std::numeric_limits<double>::infinity()) {
            const double torsion = params.stiffness * std::sqrt(arm.squaredNorm() * (d + arm).squaredNorm());
            if (torsion > params.torsion) out.torque *= params.torsion / torsion;
        }
    }
    return out;
}

Spring carried(const Spring& old, const Spring& next) noexcept {
    Spring out = old;
    out.anchor = next.anchor;
    out.rest_length = next.rest_length;
    out.duration = next.duration;
    return out;
}

void settle(const Spring& params, Spring::State& state) noexcept {
    state.anchor = params.anchor;
    state.rest_length = params.rest_length;
    state.remaining = 0;
}

bool powerless(const Spring& params) noexcept {
    return params.stiffness == 0 && params.damping == 0;
}

bool arrived(const Spring&, const Spring::State& state) noexcept {
    return !(state.remaining > 0);
}

}  // namespace knurl
