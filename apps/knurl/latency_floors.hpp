#pragma once
// What no haptics server can beat on this machine: the floors that its latencies are stated against, measured
// in the same run, in blocks between its own.

#include <vector>

#include <knurl/measure/sleeper.hpp>

namespace knurl::cli {

using measure::Nanoseconds, measure::now_ns, measure::sleep_until, measure::settle_on;

/// Who runs where. `priority`: SCHED_FIFO of the helper's thread on the servo's CPU; 0 or no right to it:
/// ordinary.
struct Placement {
    unsigned client_cpu = 0;  // the calling thread's
    unsigned servo_cpu = 0;
    int priority = 0;
};

/// poll() on one descriptor until then, to the millisecond above. False: it is not ready.
bool ready(int fd, short events, Nanoseconds until);

// Each runs for about `length` and appends samples in ns. The first two of a block are left out: caches are
// cold. Where samples are due at a pace, one that took longer than that stands for those that it kept from
// being taken as well, each from its own time on (coordinated omission).

/// A cache line goes from one CPU to the other; half of a round trip. Nothing if both are the same CPU.
void ping_pong_block(const Placement& placement, Nanoseconds length, std::vector<double>& samples);

/// From a write to an eventfd on the servo's CPU to the sleeper's waking in poll() on the client's.
void eventfd_block(const Placement& placement, Nanoseconds length, std::vector<double>& samples);

/// Lateness of a loop with absolute sleeps of `period` and nothing in it, on the servo's CPU, while the servo
/// runs there too. `phase`: a deadline of the servo's; this loop's lie half-way between those.
void bare_loop_block(const Placement& placement, Nanoseconds period, Nanoseconds phase, Nanoseconds length,
                     std::vector<double>& samples);

}  // namespace knurl::cli
