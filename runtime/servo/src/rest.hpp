#pragma once
// Claims at rest. Most of a crowd holds the device and says nothing, and what it has there is out of the
// hand's reach: what a cycle does for one of those has no effect until its application sends something, until
// it counts as silent, or until the hand has come nearer. So of one at rest a cycle reads this and one word
// of its segment, and leaves alone its rings and its scene. What comes out is the same to the last bit
// (ServoOptions::rest is false for who wants to compare).

#include <cstdint>
#include <limits>

#include <Eigen/Core>

#include <knurl/reps/scene_time.hpp>
#include <knurl/servo/clock.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::servo {

/// Of one claim. Half a line: 128 of them are gone through in every cycle.
struct alignas(32) Rest {
    static constexpr Nanoseconds for_ever = std::numeric_limits<Nanoseconds>::max();

    const shm::WaiterFlag* flag = nullptr;  // in its segment
    /// flag->sent, read before a look at the rings: what was counted up to here has been found. Whatever else
    /// stands there now is a reason to look.
    std::uint64_t seen = 0;
    Nanoseconds until = for_ever;  // then it counts as silent
    bool resting = false;
    bool armed = false;         // wants force: the supervisor counts it
    bool keeps_on = false;      // and keeps the device on
    bool surfaces = false;      // it has some, out of reach: the hand's budget keeps a share for them
    std::uint32_t present = 0;  // representations, out of the hand's reach; 0: there are none

    /// Once in a cycle, before the rings are looked at. False: nothing of it is to be looked at.
    bool look(Nanoseconds now) noexcept {
        if (!resting) return true;
        const std::uint64_t count = shm::sent_so_far<>(flag->sent);
        if (count == seen && now < until) return false;
        seen = count;
        resting = false;
        return true;
    }
};
static_assert(sizeof(Rest) == 32);

/// A scene out of the hand's reach: while the hand stays in a ball, and nobody changes the scene, an
/// evaluation would do nothing but let time pass. So none is made; when one is due again the scene is told
/// how many were left out (Scene::pass), and nobody can tell.
struct StillScene {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m, device: the ball
    double within = 0;                             // m
    std::uint64_t since = 0;                       // cycle: the last evaluation
    bool on = false;

    bool holds(const Eigen::Vector3d& hand) const noexcept {
        return (hand - at).squaredNorm() < within * within;
    }
};

/// What still scenes are told, kept for all of them in each cycle: half a line each.
struct alignas(32) StillClock {
    SceneTime time;
    double held_share = 1;  // of the time; 0: it is silent
};

}  // namespace knurl::servo
