#include <bit>
#include <stdexcept>
#include <string>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/counters.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>

namespace knurl::shm {

void require_aligned(const void* memory, const char* who) {
    if (memory == nullptr || reinterpret_cast<std::uintptr_t>(memory) % line_bytes != 0)
        throw std::invalid_argument(std::string(who) +
                                    ": its memory must begin on a 128-byte boundary; place it at a "
                                    "multiple of 128 from the segment's beginning");
}

void require_power_of_two(std::uint32_t count, const char* who) {
    if (count < 2 || !std::has_single_bit(count))
        throw std::invalid_argument(std::string(who) + ": " + std::to_string(count) +
                                    " places; choose a power of two, 2 or more");
}

void require_whole_words(std::size_t bytes, const char* who) {
    if (bytes == 0 || bytes % sizeof(std::uint64_t) != 0)
        throw std::invalid_argument(std::string(who) + ": slots of " + std::to_string(bytes) +
                                    " bytes; choose a multiple of 8");
}

void spsc_init(std::byte* memory) {
    require_aligned(memory, "command ring");
    const SpscPlaces<> places = spsc_places(memory, 2);
    HardwareMemory::store(*places.tail, 0, std::memory_order::relaxed);
    HardwareMemory::store(*places.head, 0, std::memory_order::relaxed);
}

SpscPlaces<> spsc_places(std::byte* memory, std::uint32_t cells) {
    require_aligned(memory, "command ring");
    require_power_of_two(cells, "command ring");
    return {.tail = reinterpret_cast<std::uint64_t*>(memory + offsetof(SpscShared, tail)),
            .head = reinterpret_cast<std::uint64_t*>(memory + offsetof(SpscShared, head)),
            .cells = reinterpret_cast<std::uint64_t*>(memory + sizeof(SpscShared))};
}

void triple_init(std::byte* memory) {
    require_aligned(memory, "triple buffer");
    HardwareMemory::store(*reinterpret_cast<std::uint64_t*>(memory),
                          TripleMid::make(triple_first_mid, false, 0), std::memory_order::relaxed);
}

TriplePlaces<> triple_places(std::byte* memory, std::size_t slot_bytes) {
    require_aligned(memory, "triple buffer");
    require_whole_words(slot_bytes, "triple buffer");
    return {.mid = reinterpret_cast<std::uint64_t*>(memory),
            .slots = reinterpret_cast<std::uint64_t*>(memory + line_bytes),
            .slot_words = slot_bytes / sizeof(std::uint64_t),
            .stride_words = round_up(slot_bytes, line_bytes) / sizeof(std::uint64_t)};
}

void broadcast_init(std::byte* memory) {
    require_aligned(memory, "report ring");
    HardwareMemory::store(*reinterpret_cast<std::uint64_t*>(memory), 0, std::memory_order::relaxed);
}

BroadcastPlaces<> broadcast_places(const std::byte* memory, std::uint32_t slots, std::size_t slot_bytes) {
    require_aligned(memory, "report ring");
    require_power_of_two(slots, "report ring");
    require_whole_words(slot_bytes, "report ring");
    auto* bytes = const_cast<std::byte*>(memory);  // readers only load
    return {.end = reinterpret_cast<std::uint64_t*>(bytes),
            .slots = reinterpret_cast<std::uint64_t*>(bytes + line_bytes),
            .count = slots,
            .stride_words = round_up(slot_bytes, broadcast_slot_unit) / sizeof(std::uint64_t),
            .slot_words = slot_bytes / sizeof(std::uint64_t)};
}

std::uint64_t* CountersReader::checked(const std::byte* memory) {
    require_aligned(memory, "counters");
    return reinterpret_cast<std::uint64_t*>(const_cast<std::byte*>(memory));
}

}  // namespace knurl::shm
