#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/view/arm.hpp>

namespace knurl::view {

using drivers::JointArray;
using Eigen::Vector3d;

Lines skeleton(const drivers::SerialChainTable& table, const JointArray& q) {
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

Lines skeleton(const drivers::DeltaTable& table, const Vector3d& platform, const JointArray& q) {
    Lines lines;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::AngleAxisd leg(table.leg[i], Vector3d::UnitZ());
        const Vector3d crank(table.r + table.a * std::cos(q[i]), table.s, table.a * std::sin(q[i]));
        lines.push_back({table.base * (leg * Vector3d(table.r, table.s, 0)), table.base * (leg * crank),
                         platform + table.base.linear() * (leg * Vector3d(table.c, table.f, 0)), platform});
    }
    return lines;
}

Arm Arm::of_address(const std::string& address) {
    Arm arm;
    const std::size_t colon = address.find(':');
    if (colon == std::string::npos) return arm;
    const std::string scheme = address.substr(0, colon);
    std::string name = address.substr(colon + 1, address.find(',') - colon - 1);
    if (scheme == "wooden") name = "woodenhaptics";
    if (scheme == "falcon") name = "falcon";
    constexpr std::string_view stated = "arm=";
    if (name.starts_with(stated)) name.erase(0, stated.size());
    if (scheme != "wooden" && scheme != "falcon" && scheme != "sim") return arm;
    try {
        if (name == "falcon")
            arm.delta = drivers::falcon_in_device_frame();
        else
            arm.chain = drivers::find_arm(name).table;
    } catch (const std::runtime_error&) {  // no such arm: it is not drawn
    }
    return arm;
}

Lines Arm::lines(const JointArray& joints, const Vector3d& tip) const {
    if (delta) return skeleton(*delta, tip, joints);
    if (!chain) return {};
    Lines lines = skeleton(*chain, joints);
    constexpr double same = 1e-3;  // m
    if (!((lines.front().back() - tip).norm() < same)) return {};
    return lines;
}

}  // namespace knurl::view
