#include "pending_batch.hpp"

#include <algorithm>
#include <cstring>

namespace knurl::bridge {

namespace {

constexpr std::size_t padded(std::size_t bytes) noexcept {
    return (bytes + 7) / 8 * 8;
}

}  // namespace

PendingBatch::PendingBatch(const protocol::ClaimCapacity& capacity)
    : slots_(capacity.representations),
      message_(sizeof(protocol::BatchHeader) + capacity.batch_bytes),
      most_bytes_(capacity.batch_bytes) {
    pending_.reserve(capacity.representations);
}

void PendingBatch::merge(const protocol::BatchHeader& header, std::span<const std::byte> entries) noexcept {
    newest_ = header.sequence;
    const std::byte* at = entries.data();
    const std::byte* const end = at + entries.size();
    for (std::uint32_t i = 0; i < header.entries; ++i) {
        protocol::EntryHeader entry;
        if (static_cast<std::size_t>(end - at) < sizeof entry) break;
        std::memcpy(&entry, at, sizeof entry);
        at += sizeof entry;
        if (entry.bytes > protocol::max_parameter_bytes ||
            static_cast<std::size_t>(end - at) < padded(entry.bytes))
            break;
        take_entry(entry, at);
        at += padded(entry.bytes);
    }
    write_message(header);
}

void PendingBatch::take_entry(const protocol::EntryHeader& header, const std::byte* params) noexcept {
    if (header.id.slot >= slots_.size()) return;
    PendingSlot& slot = slots_[header.id.slot];
    if (!slot.pending) pending_.push_back(header.id.slot);
    // New geometry alone is written over the pending parameters, which stay complete.
    const std::uint32_t on_their_way = slot.pending && slot.header.id == header.id ? slot.header.bytes : 0;
    slot.pending = true;
    slot.header = header;
    slot.header.bytes = std::max(header.bytes, on_their_way);
    slot.sequence = newest_;
    std::memcpy(slot.params, params, header.bytes);
}

void PendingBatch::write_message(protocol::BatchHeader header) noexcept {
    std::byte* const begin = message_.data() + sizeof header;
    std::size_t bytes = 0;
    header.entries = 0;
    const auto add = [&](const PendingSlot& slot) {
        const std::size_t size = padded(slot.header.bytes);
        if (bytes + sizeof slot.header + size > most_bytes_) return;
        std::memcpy(begin + bytes, &slot.header, sizeof slot.header);
        bytes += sizeof slot.header;
        std::memset(begin + bytes, 0, size);
        std::memcpy(begin + bytes, slot.params, slot.header.bytes);
        bytes += size;
        ++header.entries;
    };
    // The newest commit always fits. Parameters of an unconfirmed removal may not fit once their place is
    // taken, and then they are not needed.
    for (const bool newest : {true, false})
        for (const std::uint32_t index : pending_)
            if ((slots_[index].sequence == newest_) == newest) add(slots_[index]);
    header.bytes = static_cast<std::uint32_t>(bytes);
    std::memcpy(message_.data(), &header, sizeof header);
    message_size_ = sizeof header + bytes;
}

void PendingBatch::acknowledged(std::uint64_t sequence) noexcept {
    if (sequence <= acknowledged_) return;
    acknowledged_ = sequence;
    std::erase_if(pending_, [&](std::uint32_t index) {
        PendingSlot& slot = slots_[index];
        if (slot.sequence <= sequence) slot.pending = false;
        return !slot.pending;
    });
}

void PendingBatch::removed(RepresentationId id) noexcept {
    if (id.slot >= slots_.size()) return;
    PendingSlot& slot = slots_[id.slot];
    if (!slot.pending || slot.header.id != id) return;
    slot.pending = false;
    std::erase(pending_, id.slot);
}

}  // namespace knurl::bridge
