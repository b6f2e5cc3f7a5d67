#include <algorithm>
#include <cstring>
#include <utility>

#include <knurl/servo/record_log.hpp>

namespace knurl::servo {

namespace {

/// The header of a slot. `index` counts a record's slots from 0.
struct SlotHeader {
    std::uint32_t bytes = 0;  // of the whole record
    std::uint16_t type = 0;
    std::uint16_t index = 0;
};
static_assert(sizeof(SlotHeader) == log_slot_bytes - log_slot_payload);

std::byte* with_empty_ring(std::byte* memory) {
    shm::broadcast_init(memory);
    return memory;
}

}  // namespace

RecordLog::RecordLog(std::byte* memory, std::uint32_t slots)
    : slots_(with_empty_ring(memory), slots, log_slot_bytes) {}

void RecordLog::put(std::uint16_t type, std::initializer_list<std::span<const std::byte>> parts) noexcept {
    std::size_t bytes = 0;
    for (const auto& part : parts) bytes += part.size();
    SlotHeader header{.bytes = static_cast<std::uint32_t>(bytes), .type = type};
    alignas(8) std::byte slot[log_slot_bytes];
    std::size_t filled = 0;
    const auto publish = [&] {
        std::memcpy(slot, &header, sizeof header);
        slots_.publish(slot);
        ++header.index;
        filled = 0;
    };
    for (const auto& part : parts) {
        for (std::size_t at = 0; at < part.size();) {
            if (filled == log_slot_payload) publish();
            const std::size_t n = std::min(part.size() - at, log_slot_payload - filled);
            std::memcpy(slot + sizeof header + filled, part.data() + at, n);
            filled += n;
            at += n;
        }
    }
    std::memset(slot + sizeof header + filled, 0, log_slot_payload - filled);
    publish();
}

std::uint64_t RecordLog::written(const std::byte* memory, std::uint32_t slots) {
    return shm::BroadcastReader(memory, slots, log_slot_bytes).published();
}

RecordLogReader::RecordLogReader(const std::byte* memory, std::uint32_t slots, std::uint64_t from,
                                 std::size_t longest)
    : slots_(memory, slots, log_slot_bytes, from), longest_(longest) {}

RecordLogReader::Next RecordLogReader::next(LogRecord& out) {
    alignas(8) std::byte slot[log_slot_bytes];
    while (slots_.next(slot)) {
        SlotHeader header;
        std::memcpy(&header, slot, sizeof header);
        if (slots_.missed() != missed_) {
            missed_ = slots_.missed();
            expected_ = 0;
            return Next::gap;
        }
        // In the middle of a record whose beginning was overwritten: skip to the next record.
        if (header.index != expected_ || header.bytes > longest_) continue;
        if (header.index == 0) {
            record_.type = header.type;
            record_.bytes.clear();
        }
        const std::size_t n = std::min<std::size_t>(header.bytes - record_.bytes.size(), log_slot_payload);
        record_.bytes.insert(record_.bytes.end(), slot + sizeof header, slot + sizeof header + n);
        ++expected_;
        if (record_.bytes.size() < header.bytes) continue;
        expected_ = 0;
        std::swap(out, record_);
        return Next::record;
    }
    return Next::nothing;
}

}  // namespace knurl::servo
