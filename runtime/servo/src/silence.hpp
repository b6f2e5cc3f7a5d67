#pragma once
// An application is silent when it has not committed for three of its own intervals, measured or stated, but
// at least 250 ms. Over a network the limit grows by the possible delay of a commit.

#include <algorithm>
#include <cstdint>

#include <knurl/servo/clock.hpp>

namespace knurl::servo {

class SilenceWatch {
  public:
    static constexpr double shortest = 0.25;   // s
    static constexpr double unmeasured = 3.5;  // s: the limit until three intervals are measured
    static constexpr double intervals = 3;
    static constexpr std::uint32_t needed = 3;  // measured intervals
    static constexpr double weight = 0.25;      // of a new interval in the running mean

    /// `stated`: s, how often the application will commit; 0: measure it. `delay`: s, by how much a commit
    /// may be delayed more than the previous one.
    explicit SilenceWatch(double stated, double delay = 0) noexcept
        : stated_(stated > 0 ? stated : 0), delay_(delay) {}

    void begin(Nanoseconds now) noexcept { last_sign_ = last_batch_ = now; }

    /// A batch was taken.
    void renew(Nanoseconds now) noexcept {
        if (batches_++ > 0) {
            // A pause counts for at most the limit of an unmeasured application, so one hang does not spoil
            // the mean.
            const double interval =
                std::min(static_cast<double>(now - last_batch_) * 1e-9, unmeasured / intervals);
            mean_ = measured_ < needed ? mean_ + (interval - mean_) / (measured_ + 1)
                                       : mean_ + weight * (interval - mean_);
            measured_ = std::min(measured_ + 1, needed);
        }
        last_batch_ = now;
        sign_of_life(now);
    }
    /// The application sent something other than a commit.
    void sign_of_life(Nanoseconds now) noexcept { last_sign_ = now; }

    double limit() const noexcept {
        if (stated_ > 0) return delay_ + std::max(shortest, intervals * stated_);
        return delay_ + (measured_ < needed ? unmeasured : std::max(shortest, intervals * mean_));
    }
    /// s, since it counts as silent; 0: not silent.
    double silent_for(Nanoseconds now) const noexcept {
        return std::max(0.0, static_cast<double>(now - last_sign_) * 1e-9 - limit());
    }
    /// The earliest time at which silent_for() can exceed 0, if nothing arrives.
    Nanoseconds heard_until() const noexcept {
        return last_sign_ + static_cast<Nanoseconds>(limit() * 1e9) - 1;
    }
    /// s, between commits: stated, measured, or 0 while unknown.
    double interval() const noexcept { return stated_ > 0 ? stated_ : measured_ >= needed ? mean_ : 0; }

  private:
    double stated_, delay_, mean_ = 0;
    std::uint64_t batches_ = 0;
    std::uint32_t measured_ = 0;
    Nanoseconds last_batch_ = 0, last_sign_ = 0;
};

}  // namespace knurl::servo
