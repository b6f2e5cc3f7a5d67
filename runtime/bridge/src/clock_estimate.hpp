#pragma once
// The offset of another host's clock, from exchanges of time stamps, with a guaranteed bound. Each direction
// of an exchange gives an inequality, since a datagram cannot arrive before it was sent. The true line
// offset(t) = a + drift t satisfies all of them (Duda et al., "Estimating global time in distributed
// systems", ICDCS 1987). The estimate is the middle of the remaining interval, the uncertainty half its
// width. The truth is inside, however asymmetric the path; symmetric delays bring it near the middle.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace knurl::bridge {

class ClockEstimate {
  public:
    /// Before the first exchange nothing is known.
    static constexpr std::int64_t unknown = std::numeric_limits<std::int64_t>::max();
    static constexpr std::size_t window = 64;                  // exchanges
    static constexpr std::int64_t window_ns = 20'000'000'000;  // older ones are forgotten
    static constexpr double max_drift = 1e-3;  // s/s: two quartzes, each slewed by NTP with at most 500 ppm
    static constexpr double wander = 2e-6;     // s/s by which the drift itself may differ within the window

    /// One exchange, ns: sent here at t0, received there at t1, answered at t2 (remote clock), received here
    /// at t3. An impossible exchange (t3 < t0, t2 < t1, t3 not after the last one's) is ignored: false.
    bool add(std::int64_t t0, std::int64_t t1, std::int64_t t2, std::int64_t t3) noexcept;

    bool known() const noexcept { return count_ > 0; }
    /// remote clock - local clock, ns, at local time `now`; 0 while unknown.
    std::int64_t offset_at(std::int64_t now) const noexcept;
    /// ns: |offset_at(now) - truth| is at most this. It grows while no exchange arrives.
    std::int64_t uncertainty(std::int64_t now) const noexcept;
    /// s/s: how much faster the remote clock runs.
    double drift() const noexcept;
    /// s/s: |drift() - truth at the newest exchange| is at most this; max_drift while unknown.
    double drift_uncertainty() const noexcept;
    /// ns, without the remote's processing time: the shortest in the window. 0 while unknown.
    std::int64_t round_trip() const noexcept;
    /// A clock was set, or the remote is another host.
    void forget() noexcept { count_ = 0; }

  private:
    struct Exchange {
        std::int64_t t0 = 0, t3 = 0;
        std::int64_t above = 0;  // offset(t0) <= above: t1 - t0
        std::int64_t below = 0;  // offset(t3) >= below: t2 - t3
        std::int64_t round_trip = 0;
    };
    bool solve() noexcept;
    const Exchange& at(std::size_t i) const noexcept { return exchanges_[(first_ + i) % window]; }

    std::array<Exchange, window> exchanges_{};
    std::size_t first_ = 0, count_ = 0;
    // The remaining interval at the newest t3.
    double low_ = 0, high_ = 0;                // ns, relative to the newest `below`
    double least_drift_ = 0, most_drift_ = 0;  // s/s
};

}  // namespace knurl::bridge
