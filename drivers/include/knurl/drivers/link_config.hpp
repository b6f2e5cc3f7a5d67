#pragma once

/// @file
/// What a device says about itself: one struct of plain numbers, filled by its driver, read by everybody
/// else.

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace knurl::drivers {

/// Most joints of a device.
inline constexpr int max_joints = 8;

/// A number for each joint.
using JointArray = std::array<double, max_joints>;

/// The same number for every joint.
constexpr JointArray every_joint(double value) {
    JointArray all{};
    all.fill(value);
    return all;
}
/// No least position of any joint.
inline constexpr JointArray no_least = every_joint(-std::numeric_limits<double>::infinity());
/// No greatest position of any joint.
inline constexpr JointArray no_greatest = every_joint(std::numeric_limits<double>::infinity());

/// What a device says about itself.
struct LinkConfig {
    /// Name of the profile or product: "premium15".
    std::string name;
    /// Serial number; empty: it has none.
    std::string serial;
    /// One line for people, with the source of its figures.
    std::string description;

    /// Number of joint positions in a sample.
    int sensed_joints = 0;
    /// Number of joint efforts that it takes.
    int actuated_joints = 0;
    /// True: the joints give the tip's orientation.
    bool senses_orientation = false;
    /// True: the motors give torque at the tip.
    bool renders_torque = false;

    /// Radians (metres, if prismatic) per count of each joint; 0: continuous.
    std::vector<double> radians_per_count;
    /// Largest effort of each actuated joint (N m; N if prismatic).
    std::vector<double> effort_limit;
    /// Lower stop of each joint (rad, m); -infinity: not known.
    JointArray joint_least = no_least;
    /// Upper stop of each joint (rad, m); infinity: not known.
    JointArray joint_greatest = no_greatest;

    /// Middle of the workspace (m), device frame.
    std::array<double, 3> workspace_centre = {};
    /// Radius of a ball of which the tip reaches all (m).
    double workspace_radius = 0.1;
    /// Rate for which it was made (Hz).
    double nominal_rate = 1000;

    /// Peak force at the tip (N).
    double peak_force = 0;
    /// Force at the tip that it gives without end (N).
    double continuous_force = 0;
    /// Peak torque at the tip (N m); 0: it renders none.
    double peak_torque = 0;
    /// The device's own damping b at the tip (N s/m).
    double damping = 0;
    /// The device's own rotational damping about the tip (N m s/rad); 0: not known.
    double rotational_damping = 0;
    /// Sum of all delays tau (s): actuator, transport.
    double lag = 0;
    /// Largest stiffness as measured (N/m); 0: not measured, the servo estimates it.
    double measured_max_stiffness = 0;
    /// Damping of the hand while its grip is known (N s/m); 0: not known.
    double grip_damping = 0;
    /// Apparent mass at the tip (kg); 0: not known.
    double apparent_mass = 0;

    /// True: it switches its motors off by itself when the host falls silent.
    bool has_watchdog = false;
    /// After this time (s).
    double watchdog_time = 0;
    /// True: it has a brake.
    bool has_brake = false;
};

}  // namespace knurl::drivers
