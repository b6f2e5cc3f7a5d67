// Derives LinkConfig and the simulated device from a file.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <knurl/drivers/arm_file.hpp>

#include "arm_file/reader.hpp"
#include "sim/profiles.hpp"

namespace knurl::drivers {

namespace {

constexpr double usual_resolution = 30e-6;  // m at the tip
constexpr double usual_joint_inertia = 1e-5;
constexpr double wrist_counts = 4096;  // a turn
constexpr double stops_beyond = 1.3;   // of the workspace's radius

/// Takes values from the file, else the profile's default, which is then listed as assumed.
class Assumed {
  public:
    explicit Assumed(std::vector<std::string>* list) : list_(list) {}
    double operator()(const std::optional<double>& known, const char* what, double usual, const char* unit) {
        if (!known) say(std::string(what) + " " + in_text(usual) + " " + unit);
        return known.value_or(usual);
    }
    void say(const std::string& what) {
        if (list_ != nullptr) list_->push_back(what);
    }

  private:
    std::vector<std::string>* list_;
};

bool moves_the_tip(const SimProfile& profile, std::size_t axis) {
    TipPose pose;
    Jacobian jacobian;
    const auto joints = static_cast<std::size_t>(profile.joints);
    return profile.mechanism->forward({profile.centre.data(), joints}, pose, jacobian) &&
           jacobian.col(static_cast<Eigen::Index>(axis)).head<3>().norm() > 1e-6;
}

/// Each joint's range, counts and effort; says what is assumed of them.
void set_axes(const ArmFile& arm, SimProfile& p, Assumed& known) {
    bool counted = true;
    for (std::size_t i = 0; i < arm.joints(); ++i) {
        const ArmAxis& axis = arm.axes[i];
        p.least[i] = axis.limits.least;
        p.greatest[i] = axis.limits.greatest;
        if (!axis.limits.known()) known.say(axis.name + ": no limits; the tip's workspace alone stops it");
        if (axis.radians_per_count) {
            p.radians_per_count[i] = *axis.radians_per_count;
        } else if (moves_the_tip(p, i)) {
            counted = false;
        } else {
            p.radians_per_count[i] = 2 * std::numbers::pi / wrist_counts;
            known.say(axis.name + ": " + in_text(wrist_counts) + " counts a turn");
        }
        if (axis.effort_limit) p.effort_limit[i] = *axis.effort_limit;
    }
    if (!counted && !arm.resolution) known.say("resolution " + in_text(usual_resolution) + " m at the tip");
}

/// The stops of the table's rows, where a coupling moves several rows with one axis.
void set_row_stops(const ArmFile& arm, SimProfile& p) {
    if (std::none_of(arm.row_limits.begin(), arm.row_limits.end(),
                     [](const Between& b) { return b.known(); }))
        return;
    const auto n = static_cast<Eigen::Index>(arm.joints());
    p.coupling = arm.table.coupling.size() > 0 ? arm.table.coupling : Eigen::MatrixXd::Identity(n, n);
    for (std::size_t i = 0; i < arm.row_limits.size(); ++i) {
        p.row_least[i] = arm.row_limits[i].least;
        p.row_greatest[i] = arm.row_limits[i].greatest;
    }
}

/// Peak and continuous force, and the levers by which motors exert them.
void set_forces(const ArmFile& arm, SimProfile& p, Assumed& known) {
    p.continuous_force = arm.continuous_force.value_or(0);
    if (arm.peak_force) {
        p.peak_force = *arm.peak_force;
        if (!arm.continuous_force) known.say("continuous force: half of the peak force");
        set_levers(p);
        return;
    }
    // The force that the motors can hold at the centre: the first axis at its limit decides.
    set_levers(p);
    p.peak_force = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < arm.actuated(); ++i) {
        if (moves_the_tip(p, i)) p.peak_force = std::min(p.peak_force, p.effort_limit[i] / p.lever[i]);
    }
    known.say("peak force " + in_text(p.peak_force) + " N, from the axes' limits at the centre");
}

}  // namespace

SimProfile sim_profile_of(const ArmFile& arm, std::vector<std::string>* assumed) {
    Assumed known(assumed);
    SimProfile p;
    const bool turns = !arm.table.position_only && arm.joints() > 3;
    p.name = arm.name;
    p.description = "simulated: " + arm.description;
    p.mechanism = std::make_shared<SerialChain>(arm.table);
    p.joints = static_cast<int>(arm.joints());
    p.passive_joints = static_cast<int>(arm.joints() - arm.actuated());
    p.senses_orientation = turns;
    p.renders_torque = turns && arm.actuated() > 3 && arm.peak_torque.has_value();
    p.centre = arm.centre;
    p.workspace_radius = arm.workspace_radius;
    p.stop_radius = stops_beyond * arm.workspace_radius;

    p.rate = arm.rate;
    p.quantum = arm.resolution.value_or(usual_resolution);
    set_axes(arm, p, known);
    set_row_stops(arm, p);

    p.mass = known(arm.mass, "mass", p.mass, "kg at the tip");
    p.damping = known(arm.damping, "damping", p.damping, "N s/m at the tip");
    p.coulomb = known(arm.friction, "dry friction", p.coulomb, "N at the tip");
    p.lag = known(arm.bandwidth, "actuators' bandwidth", p.lag, "Hz");
    p.joint_inertia = known(arm.joint_inertia, "inertia of each axis", usual_joint_inertia, "kg m^2");
    if (turns) {
        p.rotational_inertia = known(arm.rotational_inertia, "rotational inertia", 2e-4, "kg m^2");
        p.rotational_damping = known(arm.rotational_damping, "rotational damping", 2e-3, "N m s/rad");
    }
    p.peak_torque = p.renders_torque ? *arm.peak_torque : 0;
    p.watchdog = arm.watchdog.value_or(0);
    set_forces(arm, p, known);
    return p;
}

LinkConfig link_of(const ArmFile& arm) {
    const SimProfile p = sim_profile_of(arm);
    LinkConfig link;
    link.name = arm.name;
    link.description = arm.description;
    link.sensed_joints = static_cast<int>(arm.joints());
    link.actuated_joints = static_cast<int>(arm.actuated());
    link.senses_orientation = p.senses_orientation;
    link.renders_torque = p.renders_torque;
    for (std::size_t i = 0; i < arm.joints(); ++i) {
        const auto& count = arm.axes[i].radians_per_count;
        link.radians_per_count.push_back(count ? *count : arm.resolution ? *arm.resolution / p.lever[i] : 0);
    }
    for (std::size_t i = 0; i < arm.actuated(); ++i) {
        const auto& limit = arm.axes[i].effort_limit;
        link.effort_limit.push_back(limit ? *limit : p.peak_force * p.largest_lever[i]);
    }
    link.joint_least = p.least;
    link.joint_greatest = p.greatest;
    link.workspace_radius = arm.workspace_radius;
    link.nominal_rate = arm.rate;
    link.peak_force = p.peak_force;
    link.continuous_force = arm.continuous_force.value_or(p.peak_force / 2);
    link.peak_torque = p.peak_torque;
    link.damping = arm.damping.value_or(0);
    link.rotational_damping = arm.rotational_damping.value_or(0);
    link.lag = arm.bandwidth ? 1 / (2 * std::numbers::pi * *arm.bandwidth) : 0;
    link.measured_max_stiffness = arm.max_stiffness.value_or(0);
    link.apparent_mass = arm.mass.value_or(0);
    link.has_watchdog = arm.watchdog.has_value();
    link.watchdog_time = arm.watchdog.value_or(0);
    return link;
}

}  // namespace knurl::drivers
