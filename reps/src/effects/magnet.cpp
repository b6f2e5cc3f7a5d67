#include <cmath>

#include <knurl/reps/magnet.hpp>
#include <knurl/reps/material.hpp>

#include "scene/clamped.hpp"

namespace knurl {
namespace {

// The share of the pull: 1 up to the strongest pull, then falling to 0 at the end of its reach.
double share_left(const Magnet& magnet, double x, double strongest) noexcept {
    if (x <= strongest) return 1;
    if (x >= magnet.max_distance) return 0;
    return (magnet.max_distance - x) / (magnet.max_distance - strongest);
}

}  // namespace

Verdict Describe<Magnet>::check(const Magnet& magnet) noexcept {
    if (!(magnet.stiffness > 0)) return {};  // it does not pull
    const double strongest = magnet.max_force / magnet.stiffness;
    if (magnet.max_distance > strongest) return {};
    return {Verdict::Code::contradiction, row_of<Magnet>("max_distance"), magnet.max_distance, 0, strongest};
}

Magnet prepared(Magnet params, const Limits& limits) noexcept {
    const double largest = largest_stiffness(params.stiffness, limits);
    const double k = std::min(params.stiffness, largest);
    params.stiffness = k;
    params.damping = clamped_damping(params.damping, limits);
    params.rounding = 0;
    if (!(k > 0)) return params;
    if (std::isfinite(largest))
        params.max_force = std::min(params.max_force, params.max_distance * (k * (largest / (k + largest))));
    if (params.radius > 0) {
        const double share = share_left(params, params.radius, params.max_force / k);
        const double at_centre = std::min(k * params.radius, params.max_force * share);
        params.rounding =
            std::max(std::min(world_length(hand_rounding, limits), params.radius / 20), at_centre / largest);
    }
    return params;
}

void adopt(const Magnet&, const Magnet*, Magnet::State&, const Probe&) noexcept {}

Wrench evaluate(const Magnet& params, Magnet::State&, const Probe& probe, double) noexcept {
    if (!(params.stiffness > 0)) return {};
    const Eigen::Vector3d q = probe.position - to_eigen(params.position);
    const double r = q.norm();
    const double x = r - params.radius;  // m, inside below 0
    const double strongest = params.max_force / params.stiffness;
    const double share = share_left(params, std::abs(x), strongest);
    if (!(share > 0)) return {};
    double scale = -params.stiffness;  // of q: near a point, it pulls to that point
    if (params.radius > 0 || r > strongest) {
        const double pull = std::min(params.stiffness * std::abs(x), params.max_force * share);
        const double length = std::sqrt(r * r + params.rounding * params.rounding);
        scale = length > 0 ? std::copysign(pull, -x) / length : 0;
    }
    return {.force = scale * q - (share * params.damping) * probe.velocity};
}

namespace {

// The work of the pull from `x` to the end of its reach. Rounding is cut off.
double energy_of(const Magnet& magnet, double x, double strongest) noexcept {
    const double near = std::min(x, strongest), far = std::max(0.0, x - strongest);
    return 0.5 * magnet.stiffness * near * near +
           magnet.max_force * far * (1 - 0.5 * far / (magnet.max_distance - strongest));
}

HandLoad stiffness_of(const Magnet& params, const Probe& probe) noexcept {
    if (!(params.stiffness > 0)) return {};
    const Eigen::Vector3d q = probe.position - to_eigen(params.position);
    const double r = q.norm();
    const double x = r - params.radius;
    const double strongest = params.max_force / params.stiffness;
    const double share = share_left(params, std::abs(x), strongest);
    if (!(share > 0)) return {};
    // Beyond the strongest pull the hand may return at any time. A load that ended there would make the scale
    // of all effects jump, and their forces with it, so the load falls with the pull.
    if (std::abs(x) > strongest) return isotropic_load(share * params.stiffness, share * params.damping);
    if (!(r > 0) || (params.radius == 0 && r <= strongest))
        return isotropic_load(params.stiffness, share * params.damping);
    // Along the radius it is a spring; outside, the direction of the pull turns with the radius.
    const double pull = params.stiffness * std::abs(x), length = std::hypot(r, params.rounding);
    const double turning = x > 0 ? pull / length : 0;
    const double radial =
        params.stiffness * (r / length + x * params.rounding * params.rounding / (length * length * length));
    HandLoad load = isotropic_load(turning, share * params.damping);
    load.stiffness.topLeftCorner<3, 3>() += (radial - turning) * q * q.transpose() / (r * r);
    return load;
}

}  // namespace

HandLoad load(const Magnet& params, const Magnet::State&, const Probe& probe) noexcept {
    HandLoad load = stiffness_of(params, probe);
    const double x = std::abs((probe.position - to_eigen(params.position)).norm() - params.radius);
    if (params.stiffness > 0 && x < params.max_distance)
        load.energy.held = energy_of(params, x, params.max_force / params.stiffness);
    return load;
}

bool powerless(const Magnet& params) noexcept {
    return !(params.stiffness > 0);
}

std::optional<Bound> bound(const Magnet& params) noexcept {
    return Bound{.center = to_eigen(params.position), .radius = params.radius + params.max_distance};
}

}  // namespace knurl
