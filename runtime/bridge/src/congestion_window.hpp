#pragma once
// How many bytes of assets may be under way at once. A queue before the narrowest link would delay commands,
// batches and reports alike, on any connection. So, as in RFC 6817 (LEDBAT), the window is as large as the
// path holds without a queue. It grows while pieces are acknowledged within `target_ns` of the fastest, and
// shrinks otherwise.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "wire.hpp"

namespace knurl::bridge {

class CongestionWindow {
  public:
    static constexpr std::size_t least = asset_piece_bytes;
    static constexpr std::size_t most = 32 * asset_piece_bytes;  // 1 Gbit/s over a round trip of 2 ms
    static constexpr std::int64_t target_ns = 10'000'000;
    /// So many slow pieces in a row at the `least` window show that the path itself is slow.
    static constexpr int slow_ones = 16;

    bool has_room(std::size_t on_their_way) const noexcept {
        return static_cast<double>(on_their_way + asset_piece_bytes) <= bytes_;
    }

    /// The other end has acknowledged so many bytes, `delay_ns` after they were sent.
    void taken(std::size_t bytes, std::int64_t delay_ns) noexcept {
        quickest_ns_ = std::min(quickest_ns_, delay_ns);
        const double late = static_cast<double>(delay_ns - quickest_ns_) / static_cast<double>(target_ns);
        constexpr auto piece = static_cast<double>(asset_piece_bytes);
        const auto taken = static_cast<double>(bytes);
        // Per window of acknowledged pieces: up to one piece more, or up to two fifths less.
        bytes_ += late < 1 ? (1 - late) * piece * taken / bytes_ : -std::min(late - 1, 1.0) * taken / 2;
        bytes_ = std::clamp(bytes_, static_cast<double>(least), static_cast<double>(most));
        if (bytes_ > piece) {
            slow_ = 0;
            quickest_slow_ns_ = never;
            return;
        }
        quickest_slow_ns_ = std::min(quickest_slow_ns_, delay_ns);
        if (++slow_ < slow_ones) return;
        quickest_ns_ = quickest_slow_ns_;
        slow_ = 0;
        quickest_slow_ns_ = never;
    }

  private:
    static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
    double bytes_ = 2 * asset_piece_bytes;
    std::int64_t quickest_ns_ = never, quickest_slow_ns_ = never;
    int slow_ = 0;
};

}  // namespace knurl::bridge
