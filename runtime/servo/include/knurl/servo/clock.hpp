#pragma once

#include <cstdint>
#include <ctime>

namespace knurl::servo {

/// Time (ns).
using Nanoseconds = std::int64_t;

/// Where the time stamps inside a cycle come from. Time itself is an argument of Servo::step.
class Clock {
  public:
    virtual ~Clock() = default;
    /// The time.
    virtual Nanoseconds now() noexcept = 0;
};

/// CLOCK_MONOTONIC, read in user space.
class MonotonicClock final : public Clock {
  public:
    /// The time.
    Nanoseconds now() noexcept override {
        timespec t{};
        clock_gettime(CLOCK_MONOTONIC, &t);
        return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
    }
};

/// Stands still until it is set: a minute of servo time runs in an instant, twice the same to the last bit.
class VirtualClock final : public Clock {
  public:
    /// The time that was set.
    Nanoseconds now() noexcept override { return time; }
    /// The time; the caller sets it.
    Nanoseconds time = 0;
};

}  // namespace knurl::servo
