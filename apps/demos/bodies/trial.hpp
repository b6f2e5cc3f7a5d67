#pragma once
// A script played on a virtual clock: servo, device, hand, coupling and engine in step, reproducible to the
// last bit. Used by tests and --compare.

#include <functional>

#include "coupled.hpp"
#include "offline_hand.hpp"
#include "script.hpp"

namespace bodies {

struct TrialOptions {
    double rate = 60;  // Hz of the simulation's frames
    CoupledOptions coupled = {};
    std::string device = "premium15";
    bool clamp = true;                  // to the device's limits
    double slower = 1;                  // real time of a frame over its simulated time
    double stop_at = -1, stop_for = 0;  // s: the simulation stands still
    double reset_at = -1;               // s: all bodies return to their first places
    double kick_at = -1;                // s: simulates an engine error with the body `kicked`
    std::size_t kicked = 0;
    Vector3d kick = Vector3d::Zero();  // m/s
    double force_in_loop = 0;          // N/m: instead of the coupling, a force computed and sent in each
                                       // frame
    double seconds = 0;                // 0: the script's
};

/// A cycle of the servo.
struct Moment {
    double t = 0;  // s
    const knurl::Report& report;
    const knurl::drivers::SimState& truth;
    double put_in = 0;     // J, by the hand since the start, net
    double stiffness = 0;  // N/m, of the touched surface, as rendered
};

struct Trial {
    knurl::EnergyAccount account;
    std::uint64_t short_of = 0;  // frames in which the account reduced the force
    std::uint64_t jumps = 0;
    double gained = 0;      // J, by the bodies
    double jump = 0;        // N, the largest change of the force in a cycle of a millisecond
    double motor_work = 0;  // J, by the device's motors on the hand
    std::uint32_t faults = 0;
    std::uint64_t frames = 0;
};

Trial run_trial(World& world, const Script& script, const TrialOptions& options,
                const std::function<void(const Moment&)>& each = {});

}  // namespace bodies
