#pragma once
// What a simulated device and the simulated hand on it are made of: plain numbers, from a named profile and
// the options of the address.

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
    double grip = 1;                    // 0 (no hand) to 1; scales everything, the finger's mass as well
    double stiffness = 200;             // N/m
    double normal_stiffness = 200;      // N/m along z; 60 is usual with a push
    double damping = 3;                 // N s/m, against the wanted velocity
    double push = 0;                    // N along -z, while a motion plays
    double finger_mass = 0.05;          // kg
    double tremor = 0;                  // N rms per axis, 8 to 12 Hz
    double rotational_stiffness = 0.5;  // N m/rad, on devices that take torque
    double rotational_damping = 5e-3;   // N m s/rad
    double push_ramp = 0.1;             // s that the push takes to come and go
    double return_time = 0.4;           // s that the hand takes back to the start of its motion
};

struct SimProfile {
    std::string name;
    std::string description;
    std::shared_ptr<const Mechanism> mechanism;
    int joints = 0;
    int passive_joints = 0;  // of those, the last ones: encoders without motors
    bool senses_orientation = false;
    bool renders_torque = false;
    double rate = 1000;  // Hz, that its loop needs at most

    // Posture and gearing, per joint.
    JointArray centre = {};             // rad (m), the tip in the middle of the workspace
    JointArray lever = every_joint(1);  // m/rad that the tip moves there: encoder step = quantum / lever
    JointArray largest_lever = every_joint(1);  // m/rad anywhere: effort limit = peak_force * largest_lever
    JointArray radians_per_count = {};          // (m) as stated; 0: quantum / lever
    JointArray effort_limit = {};               // N m (N) as stated; 0: peak_force * largest_lever
    JointArray least = no_least, greatest = no_greatest;  // rad, joint stops
    // Stops of what the joints drive together: row i of `coupling` times q stays between these. Empty: none.
    Eigen::MatrixXd coupling = {};
    JointArray row_least = no_least, row_greatest = no_greatest;  // rad

    // Mechanics, at the tip.
    double mass = 0.10;                // kg, the device's own; with the finger 0.15
    double rotational_inertia = 0;     // kg m^2, only where torque is rendered
    double joint_inertia = 0;          // kg m^2 per joint; keeps singular postures solvable
    double damping = 0.2;              // N s/m
    double rotational_damping = 0;     // N m s/rad
    double coulomb = 0.05;             // N
    double gravity = 0;                // m/s^2 along -z, on the device's mass
    double workspace_radius = 0.1;     // m about the origin of the device frame
    double stop_radius = 0.15;         // m: a ball of springs beyond it
    double stop_stiffness = 3000;      // N/m
    double stop_damping = 10;          // N s/m, while pressing outwards
    double joint_stop_stiffness = 5;   // N m/rad
    double joint_stop_damping = 0.02;  // N m s/rad

    // Sensing and actuation.
    double quantum = 30e-6;       // m at the tip, one encoder count; 0: continuous
    double lag = 300;             // Hz, corner of the actuators' first-order lag; 0: none
    double dac_bits = 12;         // 0: continuous
    double peak_force = 8.5;      // N
    double continuous_force = 0;  // N; 0: half of peak_force
    double peak_torque = 0;       // N m
    double watchdog = 0;          // s without a write until the motors go off; 0: has none

    SimHand hand;
    // input devices that move the hand, with colons between; empty: a motion does, or nobody
    std::string live;
    std::uint64_t seed = 1;  // of the tremor
};

/// "premium15" or "premium15,grip=0.5,tremor=0.2"; "arm=NAME" or "arm=FILE.toml" for an arm from a file.
/// Throws std::runtime_error that names the known profiles, or the known options and their ranges.
SimProfile sim_profile(std::string_view address);

std::vector<std::string> sim_profile_names();

/// One line per option: name, unit, range, meaning.
std::string sim_option_help();

}  // namespace knurl::drivers
