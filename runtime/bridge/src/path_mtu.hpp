#pragma once
// How long datagrams to the other end may be. The path may carry less that way than the other, and drop what
// is longer without a word (a link whose ends differ, a router whose errors are filtered); TCP gets through
// there, and so do short datagrams. So a length is used only while the other end says that one of it came
// through lately: long pings go on for as long as the connection lives, since a path can become narrower.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "wire.hpp"

namespace knurl::bridge {

/// What has come through to us lately: in the last two to four seconds, in which one of the long pings comes
/// through on a bad network too.
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
    /// The other end's word for the longest of ours that has come through lately.
    void came_through(std::uint64_t longest) noexcept {
        const bool wide = longest >= datagram_bytes;
        if (!wide) refused_ = false;
        bytes_ = wide && !refused_ ? datagram_bytes : least_datagram_bytes;
    }
    /// The kernel has refused one for its length: what came through before says nothing any more.
    void refused() noexcept {
        bytes_ = least_datagram_bytes;
        refused_ = true;
    }

  private:
    std::size_t bytes_ = least_datagram_bytes;
    bool refused_ = false;
};

}  // namespace knurl::bridge
