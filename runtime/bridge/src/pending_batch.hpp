#pragma once
// The application's end of the data channel: commits that may not have reached the servo. For each slot the
// newest parameters are pending until the servo has acknowledged their batch or a later one. Each message
// contains all that is pending, under the newest sequence. So any datagram that arrives makes up for all that
// were lost before it.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <knurl/protocol/claim_segment.hpp>
#include <knurl/protocol/command.hpp>

namespace knurl::bridge {

class PendingBatch {
  public:
    explicit PendingBatch(const protocol::ClaimCapacity& capacity);

    /// Adds a commit: `entries` is header.bytes long, at most the claim's batch_bytes. Rewrites message().
    void merge(const protocol::BatchHeader& header, std::span<const std::byte> entries) noexcept;
    /// The servo has taken (or refused) everything up to that batch.
    void acknowledged(std::uint64_t sequence) noexcept;
    /// The servo has confirmed a removal, so its pending parameters are dropped.
    void removed(RepresentationId id) noexcept;

    bool unacknowledged() const noexcept { return newest_ > acknowledged_; }
    std::uint64_t sequence() const noexcept { return newest_; }
    std::size_t entries() const noexcept { return pending_.size(); }
    /// BatchHeader and all pending entries, as of the newest commit. Each repetition sends the same bytes.
    std::span<const std::byte> message() const noexcept { return {message_.data(), message_size_}; }

  private:
    struct PendingSlot {
        protocol::EntryHeader header;
        std::uint64_t sequence = 0;  // of the batch with these parameters
        bool pending = false;
        std::byte params[protocol::max_parameter_bytes];
    };
    void take_entry(const protocol::EntryHeader& header, const std::byte* params) noexcept;
    void write_message(protocol::BatchHeader header) noexcept;

    std::vector<PendingSlot> slots_;
    std::vector<std::uint32_t> pending_;  // reserved
    std::vector<std::byte> message_;
    std::size_t message_size_ = 0;
    std::size_t most_bytes_;
    std::uint64_t newest_ = 0, acknowledged_ = 0;
};

}  // namespace knurl::bridge
