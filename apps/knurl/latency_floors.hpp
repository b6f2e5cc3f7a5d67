#pragma once
// The lower bounds of latency for any haptics server on this machine, measured in the same run, in blocks
// between its own.

#include <vector>

#include <knurl/measure/sleeper.hpp>

namespace knurl::cli {

using measure::Nanoseconds, measure::now_ns, measure::sleep_until, measure::settle_on;

/// Which CPU each side uses. `priority`: SCHED_FIFO of the helper thread on the servo's CPU; 0 or no right to
/// it: ordinary.
struct Placement {
    unsigned client_cpu = 0;  // the calling thread's
    unsigned servo_cpu = 0;
    int priority = 0;
};

/// poll() on one descriptor until then, rounded up to a millisecond. False: not ready.
bool ready(int fd, short events, Nanoseconds until);

// Each runs for about `length` and appends samples in ns. The first two of a block are left out, since caches
// are cold. Where samples are due at a fixed rate, one that took longer also stands for those that it
// delayed, each from its own due time (coordinated omission).

/// A cache line moves from one CPU to the other; half of a round trip. Nothing if both are the same CPU.
void ping_pong_block(const Placement& placement, Nanoseconds length, std::vector<double>& samples);

/// From a write to an eventfd on the servo's CPU to the wake-up in poll() on the client's.
void eventfd_block(const Placement& placement, Nanoseconds length, std::vector<double>& samples);

/// Lateness of an empty loop with absolute sleeps of `period` on the servo's CPU, beside the running servo.
/// `phase`: a deadline of the servo; this loop's deadlines lie half-way between those.
void bare_loop_block(const Placement& placement, Nanoseconds period, Nanoseconds phase, Nanoseconds length,
                     std::vector<double>& samples);

}  // namespace knurl::cli
