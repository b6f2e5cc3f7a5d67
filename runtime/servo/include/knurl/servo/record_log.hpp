#pragma once

/// @file
/// A log of records in shared memory: one writer that never waits, any number of readers whose mapping may be read-only.
/// A record is a type and some bytes, in as many slots as it needs. A reader that is too slow sees a gap.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include <knurl/shm/broadcast_ring.hpp>

namespace knurl::servo {

/// Bytes of a slot.
inline constexpr std::size_t log_slot_bytes = 128;
/// Bytes of a slot that a record may use.
inline constexpr std::size_t log_slot_payload = log_slot_bytes - 8;
/// Bytes of a log of so many slots.
constexpr std::size_t record_log_bytes(std::uint32_t slots) {
    return shm::broadcast_bytes(slots, log_slot_bytes);
}

/// The writer's end. Nothing here allocates but the constructor.
class RecordLog {
  public:
    /// `memory`: record_log_bytes(slots), zero.
    RecordLog(std::byte* memory, std::uint32_t slots);
    /// Appends a record of these parts.
    void put(std::uint16_t type, std::initializer_list<std::span<const std::byte>> parts) noexcept;
    /// Slots written so far; any thread that maps the memory may call it.
    static std::uint64_t written(const std::byte* memory, std::uint32_t slots);

  private:
    shm::BroadcastWriter slots_;
};

/// A record.
struct LogRecord {
    /// Its type.
    std::uint16_t type = 0;
    /// Its bytes.
    std::vector<std::byte> bytes;
};

/// A reader's end.
class RecordLogReader {
  public:
    /// Reads from slot `from` on. A record of more than `longest` bytes is none.
    RecordLogReader(const std::byte* memory, std::uint32_t slots, std::uint64_t from, std::size_t longest);

    /// What next() has found.
    enum class Next {
        /// Nothing new.
        nothing,
        /// A record.
        record,
        /// Something was overwritten before it could be read; the records go on behind it.
        gap,
    };
    /// The next record.
    Next next(LogRecord& out);
    /// Slots that were overwritten before they could be read.
    std::uint64_t missed() const noexcept { return slots_.missed(); }

  private:
    shm::BroadcastReader slots_;
    std::size_t longest_;
    std::uint64_t missed_ = 0;
    std::uint32_t expected_ = 0;  // index of the next slot of the record at hand; 0: a new one begins
    LogRecord record_;
};

}  // namespace knurl::servo
