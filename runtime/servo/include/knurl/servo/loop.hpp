#pragma once

/// @file
/// The thread around Servo::step: when a cycle begins, and what happens when it does not begin in time.

#include <atomic>
#include <cstdint>

#include <knurl/servo/clock.hpp>
#include <knurl/servo/guardian.hpp>
#include <knurl/shm/counters.hpp>

namespace knurl::shm {
class Waker;
}

namespace knurl::servo {

class Servo;

/// Deadlines t0 + i T, never re-based after a cycle that ended late: missed cycles are caught up and counted,
/// so that no lateness hides (coordinated omission). Only after a gap longer than `stall` time begins anew,
/// one period ahead: a loop that can never keep up thus sleeps now and then, which a FIFO thread must.
class Deadlines {
  public:
    /// `rate` in Hz, `stall` in ns.
    Deadlines(double rate, Nanoseconds stall);

    /// Sets t0: the first deadline is `now`.
    void start(Nanoseconds now) noexcept;
    /// The present deadline.
    Nanoseconds current() const noexcept;
    /// To the next deadline; `now`: when the cycle ended.
    void advance(Nanoseconds now) noexcept;

    /// Cycles that ended after the next had to begin.
    std::uint64_t ended_late() const noexcept { return ended_late_; }
    /// Times that t0 was set anew.
    std::uint64_t restarts() const noexcept { return restarts_; }

  private:
    double rate_;  // Hz
    Nanoseconds stall_;
    Nanoseconds t0_ = 0;
    std::uint64_t i_ = 0;
    std::uint64_t ended_late_ = 0;
    std::uint64_t restarts_ = 0;
};

/// How a loop runs.
struct LoopOptions {
    /// Rate (Hz).
    double rate = 1000;
    /// Last part of each wait that is spun (ns).
    Nanoseconds spin = 0;
    /// A longer gap sets t0 anew (ns).
    Nanoseconds stall = 20'000'000;
    /// Time without a beat of the guardian after which it stands still (ns).
    Nanoseconds guardian_patience = GuardianWatch::patience;
};

/// What the loop saw, read after it has ended.
struct LoopCounts {
    /// Cycles.
    std::uint64_t cycles = 0;
    /// Cycles that ended after the next had to begin.
    std::uint64_t ended_late = 0;
    /// Times that t0 was set anew.
    std::uint64_t restarts = 0;
    /// Latest begin of a cycle (ns).
    Nanoseconds worst_lateness = 0;
    /// The longest cycle (ns).
    Nanoseconds longest = 0;
};

/// The thread of one device.
class Loop {
  public:
    /// `counters`: the device's, of which the loop writes Count::wakes.
    Loop(Servo& servo, shm::Waker& waker, const shm::Counters& counters, const GuardianSigns& guardian,
         const LoopOptions& options);

    /// The thread's body, until stop().
    void run() noexcept;
    /// From any thread: no cycle begins any more. Relaxed: it orders nothing, since a join follows.
    void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

    /// What it saw, once run() has returned.
    const LoopCounts& seen() const noexcept { return seen_; }

  private:
    Servo& servo_;
    shm::Waker& waker_;
    shm::Counters counters_;
    GuardianSigns guardian_;
    LoopOptions options_;
    LoopCounts seen_;
    std::atomic<bool> stop_ = false;
};

}  // namespace knurl::servo
