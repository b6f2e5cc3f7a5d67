#pragma once
// What a device says about itself: one struct of plain numbers, filled by its driver, read by everybody else.

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace knurl::drivers {

inline constexpr int max_joints = 8;

using JointArray = std::array<double, max_joints>;

constexpr JointArray every_joint(double value) {
    JointArray all{};
    all.fill(value);
    return all;
}
inline constexpr JointArray no_least = every_joint(-std::numeric_limits<double>::infinity());
inline constexpr JointArray no_greatest = every_joint(std::numeric_limits<double>::infinity());

struct LinkConfig {
    std::string name;         // the profile's or product's: "premium15"
    std::string serial;       // empty: has none
    std::string description;  // one line for people, with the source of its figures

    int sensed_joints = 0;    // joint positions that a sample holds
    int actuated_joints = 0;  // joint efforts that it takes
    bool senses_orientation = false;
    bool renders_torque = false;

    std::vector<double> radians_per_count;  // per joint; metres per count for a prismatic one; 0: continuous
    std::vector<double> effort_limit;       // N m (N if prismatic) per actuated joint
    // rad (m): where each joint's stops are; infinite: not known.
    JointArray joint_least = no_least, joint_greatest = no_greatest;

    std::array<double, 3> workspace_centre = {};  // m, device frame
    double workspace_radius = 0.1;                // m, of a ball that the tip reaches all of
    double nominal_rate = 1000;                   // Hz

    double peak_force = 0;              // N at the tip
    double continuous_force = 0;        // N, for ever
    double peak_torque = 0;             // N m, 0: renders none
    double damping = 0;                 // N s/m, the device's own b at the tip
    double rotational_damping = 0;      // N m s/rad, likewise about the tip; 0: unknown
    double lag = 0;                     // s, tau: everything late (actuator, transport)
    double measured_max_stiffness = 0;  // N/m as measured; 0: not measured, the servo estimates it
    double grip_damping = 0;            // N s/m of the hand while its grip is known; 0: unknown
    double apparent_mass = 0;           // kg at the tip; 0: unknown

    bool has_watchdog = false;  // switches its motors off by itself when the host falls silent
    double watchdog_time = 0;   // s
    bool has_brake = false;
};

}  // namespace knurl::drivers
