#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/spring.hpp>

#include "scene/clamped.hpp"

namespace knurl {
namespace {

/// m: smooths the direction of a spring of no length, so that it does not jump.
double rounding(const Spring& params, double rest) noexcept {
    return std::max(std::min(params.rounding, rest / 20), rest * params.share);
}

}  // namespace

Spring prepared(Spring params, const Limits& limits) noexcept {
    params.stiffness = clamped_stiffness(params.stiffness, limits);
    params.share = std::isfinite(limits.max_stiffness) && limits.max_stiffness > 0
                       ? params.stiffness / limits.max_stiffness
                       : 0;
    params.damping = clamped_damping(params.damping, limits);
    params.rounding = world_length(hand_rounding, limits);
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
    const double e = rounding(params, rest);
    const double ee = e * e;  // also 0 where a tiny rest length squares to 0
    if (ee > 0) {
        out.force = params.stiffness * (1 - rest / std::sqrt(d.squaredNorm() + ee)) * d;
    } else {
        out.force = params.stiffness * d;
    }
    if (params.damping > 0) {
        const double ll = d.squaredNorm();
        const double nothing = 1e-9 * params.rounding;
        if (ll > nothing * nothing) {  // below a picometre the direction would be rounding
            Eigen::Vector3d v = probe.velocity;
            if (!at_probe) v += probe.angular_velocity.cross(arm);
            out.force -= (params.damping * v.dot(d) / ll) * d;
        }
    }
    if (!at_probe) out.torque = arm.cross(out.force);
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

// F = k (1 - L0 / sqrt(l^2 + e^2)) d: stiffness at most k along the spring, and across it the part of k that
// the rest length leaves.
HandLoad load(const Spring& params, const Spring::State& state, const Probe& probe) noexcept {
    const Eigen::Vector3d arm = probe.orientation * to_eigen(params.attach);
    const Eigen::Vector3d d = (to_eigen(state.anchor) - probe.position) - arm;
    const double rest = state.rest_length, square = d.squaredNorm();
    const double e = rounding(params, rest), length = std::sqrt(square + e * e);
    const double pull = params.stiffness * (length > 0 ? 1 - rest / length : 1);
    const Eigen::Matrix3d along =
        square > 1e-24 ? Eigen::Matrix3d(d * d.transpose() / square) : Eigen::Matrix3d::Zero();
    HandLoad load = isotropic_load(std::max(0.0, pull), 0);
    load.stiffness.topLeftCorner<3, 3>() += (params.stiffness - std::max(0.0, pull)) * along;
    load.damping.topLeftCorner<3, 3>() += params.damping * along;
    load.energy.held = 0.5 * params.stiffness * (length - rest) * (length - rest);
    if (params.attach == Vec3{}) return load;
    load = moved_by(load, arm);
    load.stiffness.bottomRightCorner<3, 3>() += turned_force(arm, pull * d);
    return load;
}

bool powerless(const Spring& params) noexcept {
    return params.stiffness == 0 && params.damping == 0;
}

bool arrived(const Spring&, const Spring::State& state) noexcept {
    return !(state.remaining > 0);
}

}  // namespace knurl
