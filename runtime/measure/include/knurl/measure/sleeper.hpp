#pragma once
// What a thread that only sleeps sees of a machine: how late it is woken, and when the machine stood still.

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
/// Binds the calling thread to a CPU and gives it that SCHED_FIFO priority (0: ordinary, whatever its maker's
/// is). False: it runs on without what was not allowed.
bool settle_on(unsigned cpu, int priority);

/// How late each cycle began, in the order in which they came.
struct Beginnings {
    std::vector<Nanoseconds> deadline;  // CLOCK_MONOTONIC
    std::vector<Nanoseconds> late;
};

/// Who sleeps from `first` (or when its thread has started, on the same grid) to `first` + `length` in
/// absolute sleeps of `period`.
struct BareLoop {
    unsigned cpu = 0;
    int priority = 0;  // SCHED_FIFO; 0, or no right to it: ordinary
    Nanoseconds first = 0, period = 0, length = 0;
    const std::atomic<bool>* stop = nullptr;  // ends it early
};

/// A servo's way of sleeping with nothing in between, in a thread of its own. As a servo, it does not make up
/// for cycles that it has missed.
Beginnings bare_loop(const BareLoop& loop);

/// When a witness was late.
struct Gap {
    Nanoseconds begin = 0, end = 0;  // when it should have been awake, when it was
};

/// For how long of the worst `window` the machine stood still, one CPU of it at least: the gaps of several
/// CPUs overlap, and no time counts twice. In any order; without a window, all of them.
Nanoseconds stood_still(std::vector<Gap> gaps, Nanoseconds window = std::numeric_limits<Nanoseconds>::max());

/// A thread on each of these CPUs that sleeps for 1 ms at a time, above everybody's priority: when it is late
/// all the same, the machine itself stood still. (A virtual one is taken off its processors for tens of
/// milliseconds at times.) Without the right to that priority it is no witness, and sees nothing.
class Witness {
  public:
    static constexpr Nanoseconds long_gap = 1'000'000;

    Witness(const std::vector<unsigned>& cpus, int priority);
    ~Witness();
    Witness(const Witness&) = delete;
    Witness& operator=(const Witness&) = delete;
    /// On how many CPUs it has what it needs.
    std::size_t watching() const;
    /// Those above `long_gap` since the last call, in the order in which they ended.
    std::vector<Gap> gaps();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::measure
