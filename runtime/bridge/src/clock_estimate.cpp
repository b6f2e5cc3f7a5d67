#include "clock_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace knurl::bridge {

namespace {

// Nothing below overflows: stamps are within +-2^61, their differences within +-2^62.
bool sane(std::int64_t t) noexcept {
    constexpr std::int64_t limit = std::int64_t{1} << 61;
    return t >= -limit && t <= limit;
}

}  // namespace

bool ClockEstimate::add(std::int64_t t0, std::int64_t t1, std::int64_t t2, std::int64_t t3) noexcept {
    if (!sane(t0) || !sane(t1) || !sane(t2) || !sane(t3) || t3 < t0 || t2 < t1 || t3 - t0 < t2 - t1)
        return false;
    if (count_ > 0 && t3 <= at(count_ - 1).t3) return false;
    if (count_ == window) {
        first_ = (first_ + 1) % window;
        --count_;
    }
    exchanges_[(first_ + count_) % window] = {
        .t0 = t0, .t3 = t3, .above = t1 - t0, .below = t2 - t3, .round_trip = (t3 - t0) - (t2 - t1)};
    ++count_;
    while (count_ > 1 && t3 - at(0).t3 > window_ns) {
        first_ = (first_ + 1) % window;
        --count_;
    }
    // No line satisfies all constraints: a clock was set or slewed. The older constraints no longer hold.
    while (!solve()) {
        first_ = (first_ + 1) % window;
        --count_;
    }
    return true;
}

/// The lines y = a + b t with y(t0_j) <= above_j and y(t3_i) >= below_i for all i, j. Eliminating a gives b
/// (t0_j - t3_i) <= above_j - below_i for each pair. It bounds b from above where t0_j is later, and from
/// below where it is earlier. At a time after all of them the highest line has the greatest b, the lowest the
/// least.
bool ClockEstimate::solve() noexcept {
    const Exchange& newest = at(count_ - 1);
    // ns relative to the newest exchange, so that a double keeps nanoseconds over 20 s with any offset.
    const auto when = [&](std::int64_t t) { return static_cast<double>(t - newest.t3); };
    const auto slack = [&](std::int64_t t) { return wander * -when(t); };
    const auto above = [&](const Exchange& e) {
        return static_cast<double>(e.above - newest.below) + slack(e.t0);
    };
    const auto below = [&](const Exchange& e) {
        return static_cast<double>(e.below - newest.below) - slack(e.t3);
    };

    double least = -max_drift, most = max_drift;
    for (std::size_t i = 0; i < count_; ++i)
        for (std::size_t j = 0; j < count_; ++j) {
            const double dt = when(at(j).t0) - when(at(i).t3);
            const double dy = above(at(j)) - below(at(i));
            if (dt > 0)
                most = std::min(most, dy / dt);
            else if (dt < 0)
                least = std::max(least, dy / dt);
            else if (dy < 0)
                return false;
        }
    if (least > most) return false;

    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count_; ++i) {
        high = std::min(high, above(at(i)) - most * when(at(i).t0));
        low = std::max(low, below(at(i)) - least * when(at(i).t3));
    }
    low_ = low;
    high_ = high;
    least_drift_ = least;
    most_drift_ = most;
    return true;
}

std::int64_t ClockEstimate::offset_at(std::int64_t now) const noexcept {
    if (!known()) return 0;
    const Exchange& newest = at(count_ - 1);
    const double middle = 0.5 * (low_ + high_) + drift() * (static_cast<double>(now - newest.t3));
    return newest.below + std::llround(middle);
}

std::int64_t ClockEstimate::uncertainty(std::int64_t now) const noexcept {
    if (!known()) return unknown;
    const double dt = static_cast<double>(now - at(count_ - 1).t3);
    // Before the newest exchange the two lines may cross, so only the bound on the drift is used there.
    const double half_drift =
        dt >= 0 ? 0.5 * (most_drift_ - least_drift_) + wander : max_drift + std::abs(drift());
    return static_cast<std::int64_t>(std::ceil(0.5 * (high_ - low_) + half_drift * std::abs(dt))) + 1;
}

double ClockEstimate::drift() const noexcept {
    return known() ? 0.5 * (least_drift_ + most_drift_) : 0;
}

double ClockEstimate::drift_uncertainty() const noexcept {
    return known() ? 0.5 * (most_drift_ - least_drift_) : max_drift;
}

std::int64_t ClockEstimate::round_trip() const noexcept {
    std::int64_t shortest = 0;
    for (std::size_t i = 0; i < count_; ++i)
        shortest = i == 0 ? at(i).round_trip : std::min(shortest, at(i).round_trip);
    return shortest;
}

}  // namespace knurl::bridge
