// Which claims a cycle looks at (rest.hpp).

#include "claim_impl.hpp"
#include "servo_impl.hpp"

namespace knurl::servo {

void Servo::Impl::find_awake(Nanoseconds now) noexcept {
    // Two passes here too: the words of many applications arrive together. Those of claims that are awake
    // are read at the end of the cycle (shm::who_waits).
    for (std::size_t i = 0; i < claims_size; ++i) __builtin_prefetch(rests[i].flag);
    awake_size = 0;
    resting_armed = 0;
    resting_keep_on = false;
    for (std::size_t i = 0; i < claims_size; ++i) {
        if (rests[i].look(now)) {
            awake[awake_size++] = i;
        } else {
            resting_armed += rests[i].armed ? 1 : 0;
            resting_keep_on = resting_keep_on || rests[i].keeps_on;
        }
    }
}

void Servo::Impl::rouse(Nanoseconds now) noexcept {
    awake_size = 0;
    for (std::size_t i = 0; i < claims_size; ++i) {
        awake[awake_size++] = i;
        Claim::Impl& c = *claims[i]->impl;
        if (c.channels && options.silence && rests[i].resting) c.watch_silence(now);
        rests[i].resting = false;
    }
    resting_armed = 0;
    resting_keep_on = false;
}

/// One that was looked at in this cycle.
void Servo::Impl::put_to_rest(std::size_t index) noexcept {
    const Claim::Impl& c = *claims[index]->impl;
    Rest& rest = rests[index];
    rest.resting = options.rest && c.nothing_to_do();
    if (!rest.resting) return;
    rest.armed = c.wants_force();
    rest.keeps_on = rest.armed && !c.joined;
    rest.until =
        c.channels && options.silence && !(c.silent_for > 0) ? c.silence.heard_until() : Rest::for_ever;
}

}  // namespace knurl::servo
