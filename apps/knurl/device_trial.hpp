#pragma once
// What a device does when only this program acts on it: rest, small pushes, a wall. SI units, device frame.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <knurl/drivers/device.hpp>

namespace knurl::cli {

/// The bounds of findings() for a good device; the table shows them beside each figure.
namespace bounds {
inline constexpr double push_cosine = 0.97;  // 14 degrees
// A handle with three times the inertia about one axis deviates by 30 degrees.
inline constexpr double turn_cosine = 0.85;
inline constexpr double least_size = 0.7, greatest_size = 1.4;  // of a force, relative to the model's
inline constexpr double fresh = 0.99;                           // of the cycles with a new sample
inline constexpr double wall = 0.9;                             // of the promised stiffness
}  // namespace bounds

inline constexpr double twist_lever = 0.05;  // m: lever that turns the push's force into the torque

struct TrialOptions {
    double rate = 1000;                       // Hz
    bool virtual_time = false;                // a simulated device, as fast as it computes
    double homing_time = 60;                  // s to wait for homing
    double push = 1;                          // N, the larger of the two pushes; the other is half of it
    const std::atomic<bool>* stop = nullptr;  // set: the trial must end now
};

struct HomingTrial {
    bool done = false;
    double seconds = 0;  // 0: calibrated from the start
};

struct RestTrial {
    std::uint64_t cycles = 0, fresh = 0, stale = 0, bad = 0;
    double sample_rate = 0;        // Hz, of new samples
    std::vector<double> lateness;  // s, of each cycle's begin; empty on a virtual clock
    std::vector<double> transfer;  // s, of read and write together; likewise
    /// s, each from an order without effort to the next sample: the round trip of a device that answers
    /// orders. For a device that sends by itself: the time to its next sample.
    std::vector<double> round_trip;
    std::vector<double> counts_apart;  // per joint: between its lowest and highest reading
    double tip_noise = 0;              // m rms about the mean
    double tip_apart = 0;              // m, largest distance from the mean
    double turned_apart = 0;           // rad, largest turn from where it began
};

/// From pushes in both directions along an axis, so that gravity, drift and asymmetric friction cancel. For a
/// turn about the axis: kg m^2, N m; neither size nor delay is known.
struct PushTrial {
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();
    double cosine = 0;    // 1, between the push and the motion of the tip
    double mass = 0;      // kg that moved: (F2 - F1) / (a2 - a1)
    double friction = 0;  // N of dry friction: F1 - m a1
    double delay = 0;     // s from the write to the start of the motion: the total delay, tau
    double size = 0;      // 1, the acceleration relative to the model's (LinkConfig::apparent_mass); 0:
                          // unknown
};

struct WallTrial {
    double stiffness = 0;  // N/m, the largest with which the ringing of a knock dies away
    double predicted = 0;  // N/m, b / (T/2 + tau) by LinkConfig, with the hand's damping if it is held
    bool held = false;     // by a hand whose grip is known (LinkConfig::grip_damping)
    bool bounded = false;  // the search ended at its upper bound: a stiffer wall may be stable
};

struct Trial {
    drivers::LinkConfig link;
    double rate = 0;
    bool real_time = false;
    HomingTrial homing;
    RestTrial rest;
    std::vector<PushTrial> pushes;
    std::vector<PushTrial> turns;  // for devices that render torque
    WallTrial wall;
};

/// b / (T/2 + tau) without a hand, N/m; 0: its damping is unknown.
double promised_alone(const drivers::LinkConfig& link, double rate);

/// Runs all trials. `say`: one line before each. Throws std::runtime_error: unplugged, too fast, not homed,
/// out of its workspace, interrupted; the motors are at zero then.
Trial try_device(drivers::Device& device, const TrialOptions& options,
                 const std::function<void(const std::string&)>& say);

/// "x", "y" or "z".
std::string axis_name(const PushTrial& push);

/// What is wrong, and what to do about it: one line each.
std::vector<std::string> findings(const Trial& trial);

}  // namespace knurl::cli
