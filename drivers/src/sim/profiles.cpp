#include "sim/profiles.hpp"

#include <cmath>
#include <numbers>

#include <knurl/drivers/cartesian.hpp>
#include <knurl/drivers/serial_chain.hpp>

namespace knurl::drivers {

namespace {

constexpr double degrees = std::numbers::pi / 180;

SimProfile cartesian3() {
    SimProfile p;
    p.name = "cartesian3";
    p.description = "simulated: three sliding axes; invented figures of a good desktop device";
    p.mechanism = std::make_shared<Cartesian>();
    p.joints = 3;
    return p;
}

/// The PHANToM Premium 1.5 without its wrist. Link lengths: Cavusoglu, Feygin & Tendick, "A Critical Study of
/// the Mechanical and Electrical Properties of the PHANToM Haptic Interface", Presence 11(6), 2002. Its
/// parallelogram measures both arm angles from the base. Dynamics are those of every profile here, not the
/// real arm's.
SimProfile premium15() {
    constexpr double upper = 0.215, fore = 0.170;  // m
    // Upper arm 20 degrees above the horizontal, forearm straight down: 0.22 m from the shoulder, half-way
    // between stretched (0.385) and folded (0.045). The device frame's origin is the tip in this posture; x
    // points away from the base, z up.
    constexpr double arm = 20 * degrees, forearm = 0;
    const double reach = upper * std::cos(arm) + fore * std::sin(forearm);
    const double height = upper * std::sin(arm) - fore * std::cos(forearm);

    SerialChainTable table;
    table.rows = {{.alpha = 90 * degrees}, {.a = upper}, {.theta = -90 * degrees, .a = fore}};
    table.coupling = Eigen::Matrix3d{{1, 0, 0}, {0, 1, 0}, {0, -1, 1}};
    table.base.translation() = Eigen::Vector3d(-reach, 0, -height);
    table.position_only = true;

    SimProfile p;
    p.name = "premium15";
    p.description =
        "simulated: arm with the PHANToM Premium 1.5's link lengths (Cavusoglu et al. 2002), "
        "dynamics invented";
    p.mechanism = std::make_shared<SerialChain>(table);
    p.joints = 3;
    p.centre = {0, arm, forearm};
    p.lever = {reach, upper, fore};
    p.stop_radius = 0.13;
    p.largest_lever = {reach + p.stop_radius, upper, fore};
    return p;
}

/// Six axes with invented figures, to exercise orientation and torque: no such device exists.
SimProfile generic6() {
    constexpr double upper = 0.25, fore = 0.20, tool = 0.03;      // m
    constexpr double arm = 30 * degrees, forearm = 15 * degrees;  // of the forearm from straight down
    SerialChainTable table;
    table.rows = {{.alpha = 90 * degrees}, {.a = upper},
                  {.alpha = 90 * degrees}, {.d = fore, .alpha = -90 * degrees},
                  {.alpha = 90 * degrees}, {.d = tool}};
    table.coupling = Eigen::MatrixXd::Identity(6, 6);
    table.coupling(2, 1) = -1;

    SimProfile p;
    p.name = "generic6";
    p.description = "simulated: six axes with torque; all figures are invented";
    p.joints = 6;
    p.renders_torque = true;
    p.centre = {0, arm, forearm, 0, 75 * degrees, 0};
    // Where the tip is in that posture becomes the device frame's origin; the axes stay the base's.
    TipPose pose;
    Jacobian jacobian;
    SerialChain(table).forward(p.centre, pose, jacobian);
    table.base.translation() = -pose.position;
    p.mechanism = std::make_shared<SerialChain>(table);
    p.lever = {0.25, upper, fore, 0.06, 0.06, 0.06, 1, 1};
    p.largest_lever = {0.45, 0.30, 0.25, 0.06, 0.06, 0.06, 1, 1};
    p.least[4] = 15 * degrees;  // the wrist is singular when stretched
    p.greatest[4] = 165 * degrees;
    p.mass = 0.25;
    p.rotational_inertia = 2e-4;
    p.joint_inertia = 1e-4;
    p.rotational_damping = 2e-3;
    p.peak_torque = 0.3;
    p.stop_radius = 0.13;
    return p;
}

struct Named {
    std::string_view name;
    SimProfile (*make)();
};

constexpr Named profiles[] = {{"cartesian3", cartesian3}, {"premium15", premium15}, {"generic6", generic6}};

}  // namespace

std::vector<std::string> sim_profile_names() {
    std::vector<std::string> names;
    for (const Named& profile : profiles) {
        names.emplace_back(profile.name);
    }
    return names;
}

bool make_named_profile(std::string_view name, SimProfile& profile) {
    for (const Named& known : profiles) {
        if (known.name == name) {
            profile = known.make();
            return true;
        }
    }
    return false;
}

}  // namespace knurl::drivers
