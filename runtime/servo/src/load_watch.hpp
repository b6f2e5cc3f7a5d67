#pragma once
// How much of its period the cycle takes, and which application takes most of it. Bounds hold per claim; this
// is the bound of their sum:
//
//   share of the period     0 ------------ room ------------ shed ------------ 1
//   new representations     taken          refused (cycle_full)
//   the costliest claim     as it is                         shed: its force fades, its scene rests
//   the device              on                                                 ramps down, fault::overload
//
// A single long cycle is a stall and not a load: what counts is a mean over `memory`, in which one cycle counts
// as two periods at most.

#include <algorithm>
#include <cstdint>

#include <knurl/servo/clock.hpp>

namespace knurl::servo {

class LoadWatch {
  public:
    static constexpr double room = 0.6, shed = 0.75, full = 1;
    static constexpr double memory = 20e-3;  // s
    static constexpr double most = 2;        // periods, of one cycle
    /// From this share on, the time of each claim is measured: below, two readings of the clock a claim would
    /// cost more than they tell.
    static constexpr double looks_from = 0.5;

    explicit LoadWatch(Nanoseconds period) noexcept
        : period_(static_cast<double>(period)), weight_(std::min(1.0, period_ * 1e-9 / memory)) {}

    /// A cycle took so long (ns).
    void took(Nanoseconds time) noexcept {
        last_ = std::clamp(static_cast<double>(time) / period_, 0.0, most);
        mean_ += weight_ * (last_ - mean_);
    }
    /// A claim that took this share of the period is evaluated no more: the next decision waits for what
    /// comes of this one.
    void relieve(double share) noexcept { mean_ = std::max(0.0, mean_ - share); }

    /// Share of the period.
    double mean() const noexcept { return mean_; }
    bool looks() const noexcept { return last_ > looks_from; }
    bool has_room() const noexcept { return mean_ <= room; }
    bool sheds() const noexcept { return mean_ > shed; }
    bool overloaded() const noexcept { return mean_ > full; }
    double share_of(Nanoseconds time) const noexcept { return static_cast<double>(time) / period_; }

    /// What an input log keeps, so that a replay decides alike: parts per million.
    std::uint32_t ppm() const noexcept { return static_cast<std::uint32_t>(mean_ * 1e6); }
    void set_ppm(std::uint32_t ppm) noexcept { mean_ = 1e-6 * ppm; }
    /// Between cycles: what is remembered is what the log keeps.
    void round() noexcept { set_ppm(ppm()); }

  private:
    double period_;  // ns
    double weight_;  // of one cycle in the mean
    double last_ = 0, mean_ = 0;
};

}  // namespace knurl::servo
