#pragma once

#include <cstdint>
#include <ctime>

namespace knurl::servo {

using Nanoseconds = std::int64_t;

/// Where the time stamps inside a cycle come from. Time itself is an argument of Servo::step.
class Clock {
  public:
    virtual ~Clock() = default;
    virtual Nanoseconds now() noexcept = 0;
};

/// CLOCK_MONOTONIC, read in user space.
class MonotonicClock final : public Clock {
  public:
    Nanoseconds now() noexcept override {
        timespec t{};
        clock_gettime(CLOCK_MONOTONIC, &t);
        return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
    }
};

/// Stands still until told: a minute of servo time runs in an instant, twice the same to the last bit.
class VirtualClock final : public Clock {
  public:
    Nanoseconds now() noexcept override { return time; }
    Nanoseconds time = 0;
};

}  // namespace knurl::servo
