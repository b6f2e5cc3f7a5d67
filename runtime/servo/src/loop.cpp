#include <algorithm>

#include <knurl/protocol/device_segment.hpp>
#include <knurl/servo/loop.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::servo {

namespace {

void sleep_until(Nanoseconds t) noexcept {
    // A signal or a stop may end the wait early or late; the caller checks the clock in any case.
    const timespec until{.tv_sec = t / 1'000'000'000, .tv_nsec = t % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

void relax() noexcept {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

Nanoseconds read_clock(clockid_t clock) noexcept {
    timespec t{};
    clock_gettime(clock, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

/// While the machine is suspended CLOCK_MONOTONIC stops and CLOCK_BOOTTIME continues. No deadline is missed,
/// but the hand may have moved. Costs one reading of a clock per cycle.
class SuspendWatch {
  public:
    bool slept(Nanoseconds monotonic_now) noexcept {
        // A preemption since monotonic_now was read looks like a jump. So both clocks are read again, in the
        // order in which a preemption can only hide a jump until the next cycle.
        if (read_clock(CLOCK_BOOTTIME) - monotonic_now - offset_ <= jump) return false;
        const Nanoseconds offset = read_offset();
        if (offset - offset_ <= jump) return false;
        offset_ = offset;
        return true;
    }

  private:
    static Nanoseconds read_offset() noexcept {
        const Nanoseconds boot = read_clock(CLOCK_BOOTTIME);
        return boot - read_clock(CLOCK_MONOTONIC);
    }

    static constexpr Nanoseconds jump = 10'000'000;
    // too small an offset would look like a jump
    Nanoseconds offset_ = std::max({read_offset(), read_offset(), read_offset()});
};

}  // namespace

Deadlines::Deadlines(double rate, Nanoseconds stall) : rate_(rate), stall_(stall) {}

void Deadlines::start(Nanoseconds now) noexcept {
    t0_ = now;
    i_ = 0;
}

Nanoseconds Deadlines::current() const noexcept {
    // Computed from i each time: a period of 333 333.3 ns rounded to whole nanoseconds would drift. A double
    // counts nanoseconds exactly for 104 days, and to 16 ns for four years.
    return t0_ + static_cast<Nanoseconds>(static_cast<double>(i_) * (1e9 / rate_));
}

void Deadlines::advance(Nanoseconds now) noexcept {
    ++i_;
    const Nanoseconds late = now - current();
    if (late <= 0) return;
    ++ended_late_;
    if (late > stall_) {
        ++restarts_;
        start(now + static_cast<Nanoseconds>(1e9 / rate_));
    }
}

Loop::Loop(Servo& servo, shm::Waker& waker, const shm::Counters& counters, const GuardianSigns& guardian,
           const LoopOptions& options)
    : servo_(servo), waker_(waker), counters_(counters), guardian_(guardian), options_(options) {}

void Loop::run() noexcept {
    MonotonicClock clock;
    Deadlines deadlines(options_.rate, options_.stall);
    SuspendWatch suspend;
    GuardianWatch guardian_watch(options_.guardian_patience);
    std::uint64_t acts_seen = guardian_.acts.load(std::memory_order_acquire);
    deadlines.start(clock.now() + static_cast<Nanoseconds>(1e9 / options_.rate));
    while (!stop_.load(std::memory_order_relaxed)) {
        const Nanoseconds deadline = deadlines.current();
        Nanoseconds now = clock.now();
        if (now < deadline - options_.spin) {
            sleep_until(deadline - options_.spin);
            now = clock.now();
        }
        while (now < deadline) {  // at most options_.spin long
            relax();
            now = clock.now();
        }
        // guardian: ++acts (rel) ─sb─> zeroes the device. Here: acts (acq), and a new value sets gain 0 and
        // ramps up. Pairs with keep_watch's release. A servo that was stopped between this load and the write
        // still writes one force when it continues; the next cycle finds the word.
        const std::uint64_t acts = guardian_.acts.load(std::memory_order_acquire);
        if (acts != acts_seen) {
            acts_seen = acts;
            servo_.guardian_acted();
        }
        servo_.guardian_is_still(guardian_watch.still(now, guardian_.beat.load(std::memory_order_relaxed)));
        if (suspend.slept(now)) servo_.clock_jumped();
        servo_.step(deadline, now);
        if (waker_.wake(servo_.wake_targets()) > 0)
            counters_.increment(static_cast<std::size_t>(protocol::Count::wakes));

        ++seen_.cycles;
        seen_.worst_lateness = std::max(seen_.worst_lateness, now - deadline);
        const Nanoseconds end = clock.now();
        servo_.took(end - now);
        seen_.longest = std::max(seen_.longest, end - now);
        deadlines.advance(end);
    }
    seen_.ended_late = deadlines.ended_late();
    seen_.restarts = deadlines.restarts();
}

}  // namespace knurl::servo
