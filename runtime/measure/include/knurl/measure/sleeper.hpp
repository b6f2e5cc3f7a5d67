#pragma once
// What a thread that only sleeps shows about a machine: how late it wakes, and when the machine stood still.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace knurl::measure {

using Nanoseconds = std::int64_t;

/// CLOCK_MONOTONIC.
Nanoseconds now_ns() noexcept;
void sleep_until(Nanoseconds t) noexcept;
/// Binds the calling thread to a CPU with that SCHED_FIFO priority (0: ordinary, also if its maker is not).
/// False: it runs without what was not allowed.
bool settle_on(unsigned cpu, int priority);

/// How late each cycle began, in order.
struct Beginnings {
    std::vector<Nanoseconds> deadline;  // CLOCK_MONOTONIC
    std::vector<Nanoseconds> late;
};

/// A loop from `first` (or the thread's start, on the same grid) to `first` + `length` with absolute sleeps
/// of `period`.
struct BareLoop {
    unsigned cpu = 0;
    int priority = 0;  // SCHED_FIFO; 0, or no right to it: ordinary
    Nanoseconds first = 0, period = 0, length = 0;
    const std::atomic<bool>* stop = nullptr;  // ends it early
};

/// A servo's sleeps without any work, in a separate thread. Like a servo, it skips missed cycles.
Beginnings bare_loop(const BareLoop& loop);

/// A time at which a witness was late.
struct Gap {
    Nanoseconds begin = 0, end = 0;  // when it should have woken, when it did
};

/// How long in the worst `window` the machine stood still, on at least one CPU: gaps of several CPUs overlap,
/// and no time counts twice. In any order; without a window, over all.
Nanoseconds stood_still(std::vector<Gap> gaps, Nanoseconds window = std::numeric_limits<Nanoseconds>::max());

/// A thread on each of these CPUs that sleeps for 1 ms at a time, with the highest priority. When it is late
/// nevertheless, the machine itself stood still. (A virtual machine is stopped for tens of milliseconds at
/// times.) Without the right to that priority it records nothing.
class Witness {
  public:
    static constexpr Nanoseconds long_gap = 1'000'000;

    Witness(const std::vector<unsigned>& cpus, int priority);
    ~Witness();
    Witness(const Witness&) = delete;
    Witness& operator=(const Witness&) = delete;
    /// The number of CPUs on which it has that right.
    std::size_t watching() const;
    /// The gaps above `long_gap` since the last call, in order of their ends.
    std::vector<Gap> gaps();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::measure
