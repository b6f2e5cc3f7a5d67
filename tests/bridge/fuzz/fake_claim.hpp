#pragma once
// The servo's side of a claim, which checks what the servo relies on.

#include <cstring>

#include <knurl/link/transport.hpp>

#include "peer_stream.hpp"
#include "streams.hpp"

namespace knurl::fuzz {

constexpr std::uint32_t ring_cells = 64;
constexpr std::uint32_t batch_capacity = 4096;  // bytes

class FakeChannel final : public detail::ClaimChannel {
  public:
    bool full = false;        // no room for commands now
    bool render = false;      // the peer's role
    std::uint64_t cells = 0;  // received so far

    bool push(const void* commands, std::uint32_t count) noexcept override {
        if (full) return false;
        // Whole messages; the last of them ends its group.
        const auto* at = static_cast<const std::byte*>(commands);
        bool more = false;
        for (std::uint32_t i = 0; i < count;) {
            protocol::CommandHeader header;
            std::memcpy(static_cast<void*>(&header), at + std::size_t{i} * shm::cell_bytes, sizeof header);
            require(header.cells > 0 && header.cells <= count - i);
            if (render) require((header.flags & protocol::command_flags::restricted) != 0);
            more = (header.flags & protocol::command_flags::more) != 0;
            i += header.cells;
        }
        require(count > 0 && count <= ring_cells && !more);
        cells += count;
        return true;
    }
    std::uint32_t command_cells() const noexcept override { return ring_cells; }
    bool reply(protocol::Reply&) noexcept override { return false; }
    bool publish(const protocol::BatchHeader& header, std::span<const std::byte> entries) noexcept override {
        require(entries.size() == header.bytes && header.bytes <= batch_capacity && header.bytes % 8 == 0);
        return true;
    }
    bool feedback(protocol::FeedbackHeader&, std::vector<protocol::FeedbackEntry>&) override { return false; }
};

/// A peer's stream on such a claim.
struct FakeClaim {
    FakeChannel* channel = new FakeChannel;
    PeerStream stream{1,
                      [this] {
                          detail::Attachment attachment;
                          attachment.terms.capacity.representations = 16;
                          attachment.terms.capacity.batch_bytes = batch_capacity;
                          attachment.channel.reset(channel);
                          return attachment;
                      }(),
                      0};
};

}  // namespace knurl::fuzz
