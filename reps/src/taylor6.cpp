#include <knurl/reps/taylor6.hpp>

#include "clamped.hpp"
#include "jacobian.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

// (s w, s v) for s = +-1 are the same orientation: the one with w >= 0 is reached the shorter way.
Vector3d rotation_vector(const Eigen::Quaterniond& q) noexcept {
    const double sine = q.vec().norm();
    if (!(sine > 0)) return Vector3d::Zero();
    const double angle = 2 * std::atan2(sine, std::abs(q.w()));
    return (std::copysign(angle, q.w()) / sine) * q.vec();
}

}  // namespace

Taylor6 prepared(Taylor6 params, const Limits& limits) noexcept {
    const double largest = largest_stiffness(0, limits);
    const double metres = std::sqrt(limits.max_torsion / largest);  // that a radian counts as
    Square<6> j = to_eigen(params.jacobian);
    if (std::isfinite(largest) && metres > world_length(1e-6, limits) && metres < world_length(1e6, limits)) {
        Eigen::Matrix<double, 6, 1> unit;
        unit << 1, 1, 1, 1 / metres, 1 / metres, 1 / metres;
        const Square<6> before = unit.asDiagonal() * j * unit.asDiagonal();
        Square<6> after = before;
        params.stiffness = clamp_eigenvalues<6>(after, -largest, world_stiffness(hand_stiffness, limits));
        if (after != before) j = unit.cwiseInverse().asDiagonal() * after * unit.cwiseInverse().asDiagonal();
    } else {
        Square<3> forces = j.topLeftCorner<3, 3>();
        params.stiffness = clamp_eigenvalues<3>(
            forces, -largest, std::isfinite(largest) ? world_stiffness(hand_stiffness, limits) : largest);
        j.topLeftCorner<3, 3>() = forces;
    }
    params.jacobian = to_mat6(j);
    params.orientation = to_plain(to_eigen(params.orientation).normalized());
    params.reserved = 0;
    return params;
}

void adopt(const Taylor6&, const Taylor6*, Taylor6::State&, const Probe&) noexcept {}

Wrench evaluate(const Taylor6& params, Taylor6::State&, const Probe& probe, double) noexcept {
    Vector3d d = probe.position - to_eigen(params.origin);
    Vector3d turn = rotation_vector(probe.orientation * to_eigen(params.orientation).conjugate());
    double share = 1;
    if (params.edge == TaylorEdge::fade) {
        share = smooth_edge(d.norm(), params.radius) * smooth_edge(turn.norm(), params.angle);
        if (share == 0) return {};
    } else {
        d = clamped(d, params.radius);
        turn = clamped(turn, params.angle);
    }
    Eigen::Matrix<double, 6, 1> step;
    step << d, turn;
    const Eigen::Matrix<double, 6, 1> change = to_eigen(params.jacobian) * step;
    return {.force = share * (to_eigen(params.force) + change.head<3>()),
            .torque = share * (to_eigen(params.torque) + change.tail<3>())};
}

HandLoad load(const Taylor6& params, const Taylor6::State&, const Probe& probe) noexcept {
    const Vector3d turn = rotation_vector(probe.orientation * to_eigen(params.orientation).conjugate());
    const bool beyond =
        (probe.position - to_eigen(params.origin)).norm() >= params.radius || turn.norm() >= params.angle;
    if (params.edge == TaylorEdge::fade && beyond) return {};
    const Matrix6 j = to_eigen(params.jacobian);
    return {.stiffness = -0.5 * (j + j.transpose()), .damping = Matrix6::Zero()};
}

}  // namespace knurl
