#include <knurl/reps/taylor.hpp>

#include "clamped.hpp"
#include "jacobian.hpp"

namespace knurl {

Taylor prepared(Taylor params, const Limits& limits) noexcept {
    const double largest = largest_stiffness(0, limits);
    Square<3> j = to_eigen(params.jacobian);
    params.stiffness = clamp_eigenvalues<3>(
        j, -largest, std::isfinite(largest) ? world_stiffness(hand_stiffness, limits) : largest);
    params.jacobian = to_mat3(j);
    params.reserved = 0;
    return params;
}

void adopt(const Taylor&, const Taylor*, Taylor::State&, const Probe&) noexcept {}

Wrench evaluate(const Taylor& params, Taylor::State&, const Probe& probe, double) noexcept {
    const Eigen::Vector3d d = probe.position - to_eigen(params.origin);
    double share = 1;
    const bool fades = params.edge == TaylorEdge::fade;
    if (fades) share = smooth_edge(d.norm(), params.radius);
    if (share == 0) return {};
    return {.force = share * (to_eigen(params.force) +
                              to_eigen(params.jacobian) * (fades ? d : clamped(d, params.radius)))};
}

// At the edge no direction restores with more than inside.
HandLoad load(const Taylor& params, const Taylor::State&, const Probe& probe) noexcept {
    const double far = (probe.position - to_eigen(params.origin)).norm();
    if (params.edge == TaylorEdge::fade && far >= params.radius) return {};
    if (far >= 0.8 * params.radius) return isotropic_load(params.stiffness, 0);
    HandLoad load;
    const Eigen::Matrix3d j = to_eigen(params.jacobian);
    load.stiffness.topLeftCorner<3, 3>() = -0.5 * (j + j.transpose());
    return load;
}

}  // namespace knurl
