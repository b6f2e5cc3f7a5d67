#pragma once
// Claims at rest. Most of a crowd holds the device and says nothing: what a cycle does for one of those has
// no effect until its application sends something, or until it counts as silent. So of one at rest a cycle
// reads this and one word of its segment, and leaves alone its rings, its scene, and its row in the table.
// What comes out is the same to the last bit (ServoOptions::rest is false for who wants to compare).

#include <cstdint>
#include <limits>

#include <knurl/servo/clock.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::servo {

struct Rest {
    static constexpr Nanoseconds for_ever = std::numeric_limits<Nanoseconds>::max();
    static constexpr std::uint64_t due_every =
        64;  // cycles: looked at all the same, for the table of clients

    /// It was looked at in the last cycle and had nothing to do (`dozing`), or in the cycle before that too
    /// (`resting`). Between the two it is looked at once more after its word has been read: what its
    /// application sent in between is found.
    enum class State : std::uint32_t { awake, dozing, resting };

    const std::uint64_t* sent = nullptr;  // WaiterFlag::sent, of its segment
    std::uint64_t seen = 0;               // its value before the last look at the rings
    Nanoseconds until = for_ever;         // then it counts as silent
    std::uint32_t row = 0;
    State state = State::awake;
    bool armed = false;     // wants force: the supervisor counts it
    bool keeps_on = false;  // and keeps the device on

    /// Once in a cycle, before the rings are looked at. False: nothing of it is to be looked at.
    bool look(std::uint64_t cycle, Nanoseconds now) noexcept {
        if (state == State::awake) return true;
        const std::uint64_t count = shm::sent_so_far<>(*sent);
        if (state == State::resting && (count != seen || now >= until)) state = State::awake;
        seen = count;
        return state != State::resting || (cycle + row) % due_every == 0;
    }
};

}  // namespace knurl::servo
