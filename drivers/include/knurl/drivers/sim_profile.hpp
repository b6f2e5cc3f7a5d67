#pragma once

/// @file
/// What a simulated device and the simulated hand on it are made of: plain numbers, from a named profile and
/// the options of the address.

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/drivers/link_config.hpp>
#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// A hand that pulls the tip towards where it wants to be, by springs and a damper:
///   F = grip * (K (x_wanted - x) + b (v_wanted - v) + push * (0, 0, -1) + tremor).
/// K is `stiffness` along x and y and `normal_stiffness` along z.
struct SimHand {
    /// Grip, 0 (no hand) to 1; it scales everything, the finger's mass as well.
    double grip = 1;
    /// Stiffness K along x and y (N/m).
    double stiffness = 200;
    /// Stiffness K along z (N/m); 60 is usual with a push.
    double normal_stiffness = 200;
    /// Damping b against the wanted velocity (N s/m).
    double damping = 3;
    /// Push along -z (N), while a motion plays.
    double push = 0;
    /// Mass of the finger (kg).
    double finger_mass = 0.05;
    /// Tremor per axis (N rms), 8 to 12 Hz.
    double tremor = 0;
    /// Rotational stiffness (N m/rad), on devices that take torque.
    double rotational_stiffness = 0.5;
    /// Rotational damping (N m s/rad).
    double rotational_damping = 5e-3;
    /// Time that the push takes to come and go (s).
    double push_ramp = 0.1;
    /// Time that the hand takes back to the start of its motion (s).
    double return_time = 0.4;
};

/// A simulated device and its hand, as plain numbers.
struct SimProfile {
    /// Name of the profile.
    std::string name;
    /// One line for people, with the source of its figures.
    std::string description;
    /// Kinematics.
    std::shared_ptr<const Mechanism> mechanism;
    /// Number of joints.
    int joints = 0;
    /// Number of those, the last ones, that are encoders without motors.
    int passive_joints = 0;
    /// True: the joints give the tip's orientation.
    bool senses_orientation = false;
    /// True: the motors give torque at the tip.
    bool renders_torque = false;
    /// Rate that its loop needs at most (Hz).
    double rate = 1000;

    /// Posture with the tip in the middle of the workspace (rad, m).
    JointArray centre = {};
    /// How far the tip moves there by each joint (m/rad): encoder step = quantum / lever.
    JointArray lever = every_joint(1);
    /// How far the tip moves by each joint anywhere (m/rad): effort limit = peak_force * largest_lever.
    JointArray largest_lever = every_joint(1);
    /// Radians (metres) per count of each joint, if stated; 0: quantum / lever.
    JointArray radians_per_count = {};
    /// Largest effort of each joint (N m, N), if stated; 0: peak_force * largest_lever.
    JointArray effort_limit = {};
    /// Lower stop of each joint (rad).
    JointArray least = no_least;
    /// Upper stop of each joint (rad).
    JointArray greatest = no_greatest;
    /// Stops of what the joints drive together: row i of `coupling` times q stays between row_least and
    /// row_greatest. Empty: none.
    Eigen::MatrixXd coupling = {};
    /// Lower stop of each row (rad).
    JointArray row_least = no_least;
    /// Upper stop of each row (rad).
    JointArray row_greatest = no_greatest;

    /// The device's own mass at the tip (kg); with the finger 0.15.
    double mass = 0.10;
    /// Rotational inertia at the tip (kg m^2), only where torque is rendered.
    double rotational_inertia = 0;
    /// Inertia of each joint (kg m^2); it keeps singular postures solvable.
    double joint_inertia = 0;
    /// Damping at the tip (N s/m).
    double damping = 0.2;
    /// Rotational damping at the tip (N m s/rad).
    double rotational_damping = 0;
    /// Dry friction at the tip (N).
    double coulomb = 0.05;
    /// Acceleration along -z on the device's mass (m/s^2).
    double gravity = 0;
    /// Radius of the workspace about the origin of the device frame (m).
    double workspace_radius = 0.1;
    /// Radius of a ball outside of which springs push back (m).
    double stop_radius = 0.15;
    /// Stiffness of these springs (N/m).
    double stop_stiffness = 3000;
    /// Their damping (N s/m), while pressing outwards.
    double stop_damping = 10;
    /// Stiffness of the joints' stops (N m/rad).
    double joint_stop_stiffness = 5;
    /// Damping of the joints' stops (N m s/rad).
    double joint_stop_damping = 0.02;

    /// One encoder count at the tip (m); 0: continuous.
    double quantum = 30e-6;
    /// Corner of the actuators' first-order lag (Hz); 0: none.
    double lag = 300;
    /// Bits of the actuators' converter; 0: continuous.
    double dac_bits = 12;
    /// Peak force at the tip (N).
    double peak_force = 8.5;
    /// Continuous force at the tip (N); 0: half of peak_force.
    double continuous_force = 0;
    /// Peak torque at the tip (N m).
    double peak_torque = 0;
    /// Time without a write until the motors go off (s); 0: it has no watchdog.
    double watchdog = 0;

    /// The simulated hand.
    SimHand hand;
    /// Input devices that move the hand, with colons between; empty: a motion does, or nobody.
    std::string live;
    /// Seed of the tremor.
    std::uint64_t seed = 1;
};

/// "premium15" or "premium15,grip=0.5,tremor=0.2"; "arm=NAME" or "arm=FILE.toml" for an arm from a file.
/// Throws std::runtime_error that names the known profiles, or the known options and their ranges.
SimProfile sim_profile(std::string_view address);

/// Names of the known profiles.
std::vector<std::string> sim_profile_names();

/// Help for the options, one line each: name, unit, range, meaning.
std::string sim_option_help();

}  // namespace knurl::drivers
