#pragma once
// How long datagrams to the other end may be. The path may carry less that way than the other, and drop what
// is longer without a word (a link whose ends differ, a router whose errors are filtered); TCP gets through
// there, and so do short datagrams. So a length is used only when the other end has said that one of it came
// through.

#include <cstddef>
#include <cstdint>

#include "wire.hpp"

namespace knurl::bridge {

class PathWidth {
  public:
    std::size_t bytes() const noexcept { return bytes_; }
    /// The other end's word for the longest of ours so far.
    void came_through(std::uint64_t longest) noexcept {
        if (!refused_ && longest >= datagram_bytes) bytes_ = datagram_bytes;
    }
    /// The kernel has refused one for its length: the path was wide once, and is not any more. That it was
    /// says nothing from then on.
    void refused() noexcept {
        bytes_ = least_datagram_bytes;
        refused_ = true;
    }

  private:
    std::size_t bytes_ = least_datagram_bytes;
    bool refused_ = false;
};

}  // namespace knurl::bridge
