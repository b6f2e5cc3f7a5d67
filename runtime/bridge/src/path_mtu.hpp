#pragma once
// How long datagrams to the other end may be. A path may carry less in one direction and drop longer
// datagrams silently (a link with unequal ends, a router whose errors are filtered). TCP and short datagrams
// get through there. So a length is used only while the other end confirms a recent datagram of that length.
// Long pings continue for the life of the connection, since a path can become narrower.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "wire.hpp"

namespace knurl::bridge {

/// The longest recent datagram that has arrived here: of the last two to four seconds. In that time a long
/// ping gets through even on a bad network.
class LongestLately {
  public:
    void came(std::size_t bytes, std::int64_t now_ns) noexcept {
        roll(now_ns);
        now_ = std::max<std::uint64_t>(now_, bytes);
    }
    std::uint64_t bytes(std::int64_t now_ns) noexcept {
        roll(now_ns);
        return std::max(now_, before_);
    }

  private:
    static constexpr std::int64_t span_ns = 2'000'000'000;

    void roll(std::int64_t now_ns) noexcept {
        if (now_ns - since_ns_ < span_ns) return;
        before_ = now_ns - since_ns_ < 2 * span_ns ? now_ : 0;
        now_ = 0;
        since_ns_ = now_ns;
    }

    std::uint64_t now_ = 0, before_ = 0;
    std::int64_t since_ns_ = 0;
};

class PathMtu {
  public:
    std::size_t bytes() const noexcept { return bytes_; }
    /// The other end reports the longest recent datagram from here.
    void came_through(std::uint64_t longest) noexcept {
        const bool wide = longest >= datagram_bytes;
        if (!wide) refused_ = false;
        bytes_ = wide && !refused_ ? datagram_bytes : least_datagram_bytes;
    }
    /// The kernel has refused a datagram for its length, so earlier confirmations no longer count.
    void refused() noexcept {
        bytes_ = least_datagram_bytes;
        refused_ = true;
    }

  private:
    std::size_t bytes_ = least_datagram_bytes;
    bool refused_ = false;
};

}  // namespace knurl::bridge
