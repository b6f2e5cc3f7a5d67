#pragma once

/// @file
/// The input log: while somebody records a device, its servo writes every input of `Servo::step` here, in
/// order. What is in it replays exactly (replay.hpp), from a keyframe on: a copy of what the servo remembers,
/// made while nobody holds the device.
///
///     InputLogHeader | a log of records (record_log.hpp)
///
/// The servo never waits for a reader: one that is too slow sees a gap.

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <type_traits>
#include <vector>

#include <knurl/protocol/device_segment.hpp>
#include <knurl/servo/clock.hpp>
#include <knurl/servo/record_log.hpp>
#include <knurl/servo/servo.hpp>

namespace knurl::servo {

/// Types of records, and what is in each.
enum class InputType : std::uint16_t {
    /// Words: what the servo remembered before the next record.
    keyframe = 1,
    /// A claim was taken over: number, ClaimTerms.
    adopt,
    /// A claim was dropped: number.
    drop,
    /// The servo is about to end: nothing.
    drop_all,  //
    /// Number of the claim, whole cells: the commands that this cycle took.
    commands,
    /// Number of the claim: its command ring made no sense.
    commands_broken,
    /// Number of the claim, BatchHeader, entries.
    batch,
    /// Number of the claim: its batches made no sense.
    batch_broken,
    /// CycleInput: ends the records of a cycle.
    cycle,
    /// Number of the claim, of the asset, digest of its source, which is elsewhere.
    asset,
    /// Number of the claim, of the asset.
    asset_forgotten,
    /// Number of the claim: it was shed, because the cycles had no time for it.
    shed,
};

/// What a cycle was given besides what claims sent. Without the velocities where the device measures none.
struct CycleInput {
    /// Number of the cycle.
    std::uint64_t cycle = 0;
    /// Argument of Servo::step (ns).
    Nanoseconds deadline = 0;
    /// Argument of Servo::step (ns).
    Nanoseconds now = 0;
    /// Time of its clock after the read (ns).
    Nanoseconds read_ns = 0;
    /// Time of its clock after the write (ns).
    Nanoseconds write_ns = 0;
    /// drivers::ReadStatus.
    std::uint32_t status = 0;
    /// Bit mask of the flags below.
    std::uint32_t flags = 0;
    /// Bit mask of buttons.
    std::uint32_t buttons = 0;
    /// Share of the period that cycles took, as the servo decided by it (millionths).
    std::uint32_t load_ppm = 0;
    /// Positions of the sample that the device gave (rad, m).
    std::array<double, 8> position = {};
    /// Velocities of that sample (rad/s, m/s).
    std::array<double, 8> velocity = {};

    /// Flag: JointSample::has_velocity.
    static constexpr std::uint32_t has_velocity = 1;
    /// Flag: JointSample::calibrated.
    static constexpr std::uint32_t calibrated = 2;
    /// Flag: what Device::write returned.
    static constexpr std::uint32_t written = 4;
    /// Flag: the guardian had acted.
    static constexpr std::uint32_t guardian = 8;
    /// Flag: the clock had jumped.
    static constexpr std::uint32_t jumped = 16;
    /// Flag: the guardian stands still.
    static constexpr std::uint32_t guardian_still = 32;
    /// Bytes of it that are in the record.
    std::size_t bytes() const noexcept {
        return (flags & has_velocity) != 0 ? sizeof(CycleInput) : offsetof(CycleInput, velocity);
    }
};
static_assert(std::is_trivially_copyable_v<CycleInput> && sizeof(CycleInput) == 184);

/// What the log is of. Written once, before the memory is shared.
struct InputLogHeader {
    /// "knltape".
    static constexpr std::uint64_t magic_word = 0x65706174'6c6e6b;
    /// magic_word.
    std::uint64_t magic = magic_word;
    /// input_log_layout().
    std::uint64_t layout = 0;
    /// figures_of the device.
    std::uint64_t device_figures = 0;
    /// Options of the servo.
    ServoOptions options;
};
static_assert(std::is_trivially_copyable_v<InputLogHeader> && std::is_trivially_copyable_v<ClaimTerms>);

/// Number of slots: 8 MiB, a minute at 1 kHz, less what is sent.
inline constexpr std::uint32_t input_log_slots = 65'536;
/// Bytes before the slots.
inline constexpr std::size_t input_log_header_bytes = 4096;
/// Bytes of the whole log.
inline constexpr std::size_t input_log_bytes = input_log_header_bytes + record_log_bytes(input_log_slots);
/// Most words of a keyframe.
inline constexpr std::size_t max_keyframe_words = 512;
/// Most bytes of a record: the largest batch, or all cells of a command ring, and what stands before it.
inline constexpr std::size_t max_input_record =
    protocol::max_batch_bytes + std::size_t{protocol::max_command_cells} * 64 + 4096;

/// Hash over the types in an input log. Together with protocol::wire_hash: what this build can read.
std::uint64_t input_log_layout() noexcept;
/// Hash over a device's figures and kinematics: a recording replays on no other.
std::uint64_t figures_of(const drivers::Device& device);

/// The servo's end of the log. Made by another thread (the broker), used by the servo's alone. Nothing here
/// allocates.
class InputLog {
  public:
    /// Least number of cycles between two keyframes; they are made only while nobody holds the device.
    static constexpr std::uint64_t keyframe_every = 1024;

    /// `memory`: input_log_bytes, zero.
    InputLog(std::byte* memory, const InputLogHeader& header);
    /// Appends a record of these parts.
    void put(InputType type, std::initializer_list<std::span<const std::byte>> parts) noexcept;
    /// Slots written so far; any thread that maps the memory may call it.
    static std::uint64_t written(const std::byte* memory);

  private:
    RecordLog log_;
};

/// A record.
struct InputRecord {
    /// Its type.
    InputType type{};
    /// Its bytes.
    std::vector<std::byte> bytes;
};

/// A recorder's end of the log. `memory` may be mapped read-only.
class InputLogReader {
  public:
    /// Reads from slot `from` on.
    InputLogReader(const std::byte* memory, std::uint64_t from);

    /// What next() has found.
    using Next = RecordLogReader::Next;
    /// The next record.
    Next next(InputRecord& out);
    /// Slots that were overwritten before they could be read.
    std::uint64_t missed() const noexcept { return log_.missed(); }
    /// The header.
    InputLogHeader header() const;

  private:
    const std::byte* memory_;
    RecordLogReader log_;
    LogRecord record_;
};

}  // namespace knurl::servo
