#pragma once
// What a device does when nobody but this program holds it: rest, small pushes, a wall. SI units, device
// frame.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <knurl/drivers/device.hpp>

namespace knurl::cli {

/// What is as it should be: the bounds of findings(), which the table states beside each figure.
namespace bounds {
inline constexpr double push_cosine = 0.97;  // 14 degrees
// A handle that is three times as hard to turn about one axis as about another goes 30 degrees astray.
inline constexpr double turn_cosine = 0.85;
inline constexpr double least_size = 0.7, greatest_size = 1.4;  // of a force, times the model's
inline constexpr double fresh = 0.99;                           // of the cycles with a new sample
inline constexpr double wall = 0.9;                             // of what is promised
}  // namespace bounds

inline constexpr double twist_lever = 0.05;  // m: a torque is as large as the push at its end

struct TrialOptions {
    double rate = 1000;                       // Hz
    bool virtual_time = false;                // a simulated device, as fast as it computes
    double homing_time = 60;                  // s to wait for it
    double push = 1;                          // N, the larger of the two pushes; half of it is the other
    const std::atomic<bool>* stop = nullptr;  // set: it is to end now
};

struct HomingTrial {
    bool done = false;
    double seconds = 0;  // 0: it was calibrated from the start
};

struct RestTrial {
    std::uint64_t cycles = 0, fresh = 0, stale = 0, bad = 0;
    double sample_rate = 0;        // Hz, of fresh samples
    std::vector<double> lateness;  // s, of each cycle's begin; empty on a virtual clock
    std::vector<double> transfer;  // s, of read and write together; likewise
    /// s, each from an order of no effort until the next sample is there: the round trip of a device that
    /// answers orders; of one that speaks by itself, how long its next word takes.
    std::vector<double> round_trip;
    std::vector<double> counts_apart;  // per joint: between its lowest and highest reading
    double tip_noise = 0;              // m rms about the mean
    double tip_apart = 0;              // m, largest distance from the mean
    double turned_apart = 0;           // rad, largest turn from where it began
};

/// From pushes both ways along one axis, so that gravity, drift and a slanted friction fall out. Of a turn
/// about it: kg m^2, N m; neither its size nor its delay is known.
struct PushTrial {
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();
    double cosine = 0;    // 1, between the push and the way that the tip went
    double mass = 0;      // kg that moved: (F2 - F1) / (a2 - a1)
    double friction = 0;  // N of dry friction: F1 - m a1
    double delay = 0;     // s from the write to the motion's begin: everything late, tau
    double size = 0;      // 1, the acceleration over the model's (LinkConfig::apparent_mass); 0: not known
};

struct WallTrial {
    double stiffness = 0;  // N/m, the largest at which the ringing of a knock dies away
    double predicted = 0;  // N/m, b / (T/2 + tau) by LinkConfig, with the hand's damping if it is held
    bool held = false;     // by a hand whose grip is known (LinkConfig::grip_damping)
    bool bounded = false;  // the search ended at its upper bound: it may be stiffer
};

struct Trial {
    drivers::LinkConfig link;
    double rate = 0;
    bool real_time = false;
    HomingTrial homing;
    RestTrial rest;
    std::vector<PushTrial> pushes;
    std::vector<PushTrial> turns;  // of devices that render torque
    WallTrial wall;
};

/// b / (T/2 + tau) with nobody's hand on it, N/m; 0: its damping is not known.
double promised_alone(const drivers::LinkConfig& link, double rate);

/// Runs all of it. `say`: one line about what comes next. Throws std::runtime_error: unplugged, too fast,
/// not homed, out of its workspace, told to stop; the motors are at zero then.
Trial try_device(drivers::Device& device, const TrialOptions& options,
                 const std::function<void(const std::string&)>& say);

/// "x", "y" or "z".
std::string axis_name(const PushTrial& push);

/// What is not as it should be, and what to do about it: one line each.
std::vector<std::string> findings(const Trial& trial);

}  // namespace knurl::cli
