#pragma once
// Claims at rest. Most of a crowd holds the device and says nothing: what a cycle does for one of those has
// no effect until its application sends something, or until it counts as silent. So of one at rest a cycle
// reads this and one word of its segment, and leaves alone its rings and its scene. What comes out is the
// same to the last bit (ServoOptions::rest is false for who wants to compare).

#include <cstdint>
#include <limits>

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
    bool armed = false;     // wants force: the supervisor counts it
    bool keeps_on = false;  // and keeps the device on

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

}  // namespace knurl::servo
