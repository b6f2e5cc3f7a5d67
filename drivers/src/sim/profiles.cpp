#include "sim/profiles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/drivers/cartesian.hpp>
#include <knurl/drivers/delta.hpp>
#include <knurl/drivers/reach.hpp>

namespace knurl::drivers {

namespace {

constexpr double degrees = std::numbers::pi / 180;
constexpr double least_lever = 1e-3;  // m/rad: a smaller one belongs to an axis that only turns the tip

SimProfile cartesian3() {
    SimProfile p;
    p.name = "cartesian3";
    p.description = "simulated: three sliding axes; invented figures of a good desktop device";
    p.mechanism = std::make_shared<Cartesian>();
    p.joints = 3;
    return p;
}

/// The PHANToM Premium 1.5 without its wrist: rows and coupling of arms/premium15.toml. All profiles here
/// share one set of dynamics, not the real arm's (arm=premium15 has those).
SimProfile premium15() {
    SerialChainTable table = find_arm("premium15").table;
    const double upper = table.rows[1].a, fore = table.rows[2].a;  // m
    // Upper arm 20 degrees above the horizontal, forearm straight down: 0.22 m from the shoulder, half-way
    // between stretched (0.385) and folded (0.045). The tip in this posture is the origin of the device
    // frame; x points away from the base, z up.
    constexpr double arm = 20 * degrees, forearm = 0;
    const double reach = upper * std::cos(arm) + fore * std::sin(forearm);
    const double height = upper * std::sin(arm) - fore * std::cos(forearm);
    table.base.translation() = Eigen::Vector3d(-reach, 0, -height);

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

/// The Novint Falcon's mechanism and encoders, with the dynamics of all profiles here.
SimProfile falcon() {
    const auto delta = std::make_shared<Delta>(falcon_in_device_frame());

    SimProfile p;
    p.name = "falcon";
    p.description = "simulated: the Novint Falcon's mechanism and encoders, dynamics invented";
    p.mechanism = delta;
    p.joints = 3;
    delta->inverse(Eigen::Vector3d::Zero(), std::span(p.centre).first<3>());
    p.radians_per_count = every_joint(falcon_radians_per_count);
    p.workspace_radius = 0.05;
    p.stop_radius = 0.052;  // from 0.058 on, some legs are stretched
    p.stop_stiffness = 10'000;
    p.peak_force = 8;
    set_levers(p);
    p.quantum = falcon_radians_per_count * p.lever[0];
    return p;
}

struct Named {
    std::string_view name;
    SimProfile (*make)();
};

// Profiles of arm files follow these.
constexpr Named profiles[] = {{"cartesian3", cartesian3}, {"premium15", premium15}, {"falcon", falcon}};

}  // namespace

void set_levers(SimProfile& profile) {
    const Mechanism& mechanism = *profile.mechanism;
    const auto joints = static_cast<std::size_t>(profile.joints);
    TipPose pose;
    Jacobian jacobian;
    const auto lever = [&](std::size_t joint) {
        return jacobian.col(static_cast<Eigen::Index>(joint)).head<3>().norm();
    };
    mechanism.forward({profile.centre.data(), joints}, pose, jacobian);
    for (std::size_t i = 0; i < joints; ++i) {
        profile.lever[i] = profile.largest_lever[i] = std::max(lever(i), least_lever);
    }
    // The middle and the edge of the workspace, along the 26 directions of a cube's faces, edges and corners.
    for (int k = 0; k < 27; ++k) {
        const Eigen::Vector3d way(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        for (const double distance : {0.5, 1.0}) {
            const Eigen::Vector3d position = distance * profile.workspace_radius * way.normalized();
            const auto there = reach(mechanism, profile.centre, position);
            if (!there || !mechanism.forward({there->data(), joints}, pose, jacobian)) continue;
            for (std::size_t i = 0; i < joints; ++i) {
                profile.largest_lever[i] = std::max(profile.largest_lever[i], lever(i));
            }
        }
    }
}

std::vector<std::string> sim_profile_names() {
    std::vector<std::string> names;
    for (const Named& profile : profiles) {
        names.emplace_back(profile.name);
    }
    for (const std::string& arm : shipped_arms()) {
        if (std::find(names.begin(), names.end(), arm) == names.end()) {
            names.push_back(arm);
        }
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
    const std::vector<std::string> arms = shipped_arms();
    if (std::find(arms.begin(), arms.end(), name) == arms.end()) {
        return false;
    }
    profile = sim_profile_of(find_arm(std::string(name)));
    return true;
}

}  // namespace knurl::drivers
