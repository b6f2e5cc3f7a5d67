#pragma once
// The input log: while somebody records a device, its servo writes every input of `Servo::step` here, in
// order. What is in it replays exactly (replay.hpp), from a keyframe on: a copy of what the servo remembers,
// made while nobody holds the device.
//
//   InputLogHeader | ring of slots, as of the reports: one writer, readers whose mapping is read-only
//
// A record is a type and some bytes, in as many slots as it needs. The servo never waits for a reader: one
// that is too slow is told that there is a gap.

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <type_traits>
#include <vector>

#include <knurl/protocol/device_segment.hpp>
#include <knurl/servo/clock.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/shm/broadcast_ring.hpp>

namespace knurl::servo {

enum class InputType : std::uint16_t {
    keyframe = 1,     // words: what the servo remembered before the next record
    adopt,            // number, ClaimTerms
    drop,             // number
    drop_all,         //
    commands,         // number, whole cells: those that this cycle took
    commands_broken,  // number: its command ring made no sense
    batch,            // number, BatchHeader, entries
    batch_broken,     // number: its batches made no sense
    cycle,            // CycleInput: ends the records of a cycle
    asset,            // number of the claim, of the asset, digest of its source, which is elsewhere
    asset_forgotten,  // number of the claim, of the asset
};

/// What a cycle was given besides what claims sent. Without the velocities where the device measures none.
struct CycleInput {
    std::uint64_t cycle = 0;
    Nanoseconds deadline = 0, now = 0;      // arguments of step
    Nanoseconds read_ns = 0, write_ns = 0;  // what its clock said
    std::uint32_t status = 0;               // drivers::ReadStatus
    std::uint32_t flags = 0;                // below
    std::uint32_t buttons = 0;
    std::uint32_t reserved = 0;
    std::array<double, 8> position = {};  // of the sample that the device gave
    std::array<double, 8> velocity = {};

    static constexpr std::uint32_t has_velocity = 1, calibrated = 2, written = 4, guardian = 8, jumped = 16;
    std::size_t bytes() const noexcept {
        return (flags & has_velocity) != 0 ? sizeof(CycleInput) : offsetof(CycleInput, velocity);
    }
};
static_assert(std::is_trivially_copyable_v<CycleInput> && sizeof(CycleInput) == 184);

/// Written once, before the memory is shared.
struct InputLogHeader {
    static constexpr std::uint64_t magic_word = 0x65706174'6c6e6b;  // "knltape"
    std::uint64_t magic = magic_word;
    std::uint64_t layout = 0;          // input_log_layout()
    std::uint64_t device_figures = 0;  // figures_of its device
    ServoOptions options;
};
static_assert(std::is_trivially_copyable_v<InputLogHeader> && std::is_trivially_copyable_v<ClaimTerms>);

inline constexpr std::size_t input_log_slot_bytes = 128;
inline constexpr std::size_t input_log_slot_payload = input_log_slot_bytes - 8;  // a cycle without velocities
inline constexpr std::uint32_t input_log_slots = 65'536;  // 8 MiB: a minute at 1 kHz, less what is sent
inline constexpr std::size_t input_log_header_bytes = 4096;
inline constexpr std::size_t input_log_bytes =
    input_log_header_bytes + shm::broadcast_bytes(input_log_slots, input_log_slot_bytes);
inline constexpr std::size_t max_keyframe_words = 512;
/// No record is longer: the largest batch, or all cells of a command ring, and what stands before it.
inline constexpr std::size_t max_input_record =
    protocol::max_batch_bytes + std::size_t{protocol::max_command_cells} * 64 + 4096;

/// Hash over the types in an input log. Together with protocol::wire_hash: what this build can read.
std::uint64_t input_log_layout() noexcept;
/// Hash over a device's figures and kinematics: a recording replays on no other.
std::uint64_t figures_of(const drivers::Device& device);

/// The servo's end. Made by another thread (the broker), used by the servo's alone. Nothing here allocates.
class InputLog {
  public:
    static constexpr std::uint64_t keyframe_every = 1024;  // cycles, at least, while nobody holds the device

    /// `memory`: input_log_bytes, zero.
    InputLog(std::byte* memory, const InputLogHeader& header);
    void put(InputType type, std::initializer_list<std::span<const std::byte>> parts) noexcept;
    /// Slots written so far; may be asked by any thread that maps the memory.
    static std::uint64_t written(const std::byte* memory);

  private:
    shm::BroadcastWriter slots_;
};

struct InputRecord {
    InputType type{};
    std::vector<std::byte> bytes;
};

/// A recorder's end. `memory` may be mapped read-only.
class InputLogReader {
  public:
    /// From slot `from` on.
    InputLogReader(const std::byte* memory, std::uint64_t from);

    enum class Next { nothing, record, gap };
    /// `gap`: something was overwritten before it could be read; the records go on behind it.
    Next next(InputRecord& out);
    std::uint64_t missed() const noexcept { return slots_.missed(); }  // slots
    InputLogHeader header() const;

  private:
    const std::byte* memory_;
    shm::BroadcastReader slots_;
    std::uint64_t missed_ = 0;
    std::uint32_t expected_ = 0;  // index of the next slot of the record at hand; 0: a new one begins
    InputRecord record_;
};

}  // namespace knurl::servo
