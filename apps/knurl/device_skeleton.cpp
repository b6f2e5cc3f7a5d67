// An arm in a posture as lines to draw.

#include <knurl/drivers/delta.hpp>

#include "device_check.hpp"

namespace knurl::cli {

namespace {

using drivers::JointArray;
using Eigen::Vector3d;

/// From row to row, with a point where d ends and a begins.
Lines chain(const drivers::SerialChainTable& table, const JointArray& q) {
    std::vector<Vector3d> points;
    Eigen::Isometry3d t = table.base;
    points.push_back(t.translation());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const drivers::DhRow& row = table.rows[i];
        const double variable = table.variable(i, q);
        t.rotate(Eigen::AngleAxisd(row.theta + (row.prismatic ? 0 : variable), Vector3d::UnitZ()));
        t.translate(Vector3d(0, 0, row.d + (row.prismatic ? variable : 0)));
        points.push_back(t.translation());
        t.translate(Vector3d(row.a, 0, 0));
        points.push_back(t.translation());
        t.rotate(Eigen::AngleAxisd(row.alpha, Vector3d::UnitX()));
    }
    points.push_back(t * table.tool.translation());
    return {points};
}

/// Base, crank and platform of each leg; the parallelogram is the line between crank and platform.
Lines delta(const drivers::DeltaTable& table, const Vector3d& platform, const JointArray& q) {
    Lines lines;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::AngleAxisd leg(table.leg[i], Vector3d::UnitZ());
        const Vector3d crank(table.r + table.a * std::cos(q[i]), table.s, table.a * std::sin(q[i]));
        lines.push_back({table.base * (leg * Vector3d(table.r, table.s, 0)), table.base * (leg * crank),
                         platform + table.base.linear() * (leg * Vector3d(table.c, table.f, 0)), platform});
    }
    return lines;
}

}  // namespace

Lines skeleton(const CheckedArm& arm, const JointArray& q) {
    if (arm.chain) return chain(*arm.chain, q);
    drivers::TipPose pose;
    drivers::Jacobian jacobian;
    arm.profile.mechanism->forward({q.data(), 3}, pose, jacobian);
    return delta(*arm.delta, pose.position, q);
}

}  // namespace knurl::cli
