#pragma once
// An application that lets a hand play with bodies, on any servo.

#include <atomic>
#include <functional>

#include "coupled.hpp"
#include "script.hpp"

namespace bodies {

struct PlayOptions {
    std::string device;              // empty: the only one
    double rate = 60;                // Hz of the simulation's frames
    double slow = 0;                 // s added to each step
    double lose_at = 0;              // s: the engine loses a body, to try that error; 0: never
    double seconds = 0;              // 0: until `stop`
    const Script* script = nullptr;  // takes and releases by the script; null: by button or key
    CoupledOptions coupled = {};
};

struct Played {
    struct Cycle {
        double t;  // s since the device was active
        Vector3d hand, force;
    };
    struct Frame {
        double t;
        std::vector<Vector3d> bodies;  // m, their middles
        double gained, hand;           // J, by the bodies; put in by the hand
    };
    std::vector<Cycle> cycles;
    std::vector<Frame> frames;
    knurl::EnergyAccount account;
    std::uint64_t pushed = 0, short_of = 0;  // frames with a force on a body; those in which the account
                                             // bounded it
    std::uint64_t jumps = 0;                 // of bodies
    double jump = 0;                         // N, the largest change of the force between consecutive cycles
    double torque = 0;                       // N m, the largest
    std::uint64_t late = 0;                  // frames that came more than half a frame too late
    std::uint64_t unread = 0;
    std::uint32_t faults = 0;
};

/// `told` gets messages; `key` returns a key pressed since (0: none): space takes and releases, r resets all
/// bodies, q ends. Throws knurl::Error. Throws std::runtime_error if the engine has lost a body, once its
/// force has faded.
Played play(knurl::Client& client, World& world, const PlayOptions& options, const std::atomic<bool>& stop,
            const std::function<void(const std::string&)>& told, const std::function<char()>& key);

}  // namespace bodies
