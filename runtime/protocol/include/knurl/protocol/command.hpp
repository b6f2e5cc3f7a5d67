#pragma once

/// @file
/// Messages of the command channel: a header and a body, in 64-byte cells of an SPSC ring. Commands that
/// belong together are pushed at once and all but the last carry `more`: the servo does all of them in one
/// cycle, and if one of them is refused, none is done.

#include <algorithm>
#include <cstdint>

#include <knurl/protocol/bounds.hpp>
#include <knurl/reps/scene.hpp>

namespace knurl::protocol {

/// What a command does, and its body.
enum class CommandType : std::uint32_t {
    /// Adds a representation: AddBody, then `bytes` of parameters.
    add = 1,
    /// Removes a representation: RemoveBody.
    remove = 2,
    /// Places a probe: PlaceProbeBody.
    place_probe = 3,
    /// Allows force; no body.
    arm = 4,
    /// This claim's gain goes to 0; no body.
    disarm = 5,
    /// Leaves a fault: idle without force, until a claim arms anew; no body.
    reset_fault = 6,
    /// The application is alive, though it does not commit; no body.
    alive = 7,
};

namespace command_flags {
/// The next message belongs to the same group.
inline constexpr std::uint32_t more = 1u << 0;
/// Set by a bridge: this peer may join a device that another client has switched on, and no more. The servo
/// refuses the command if it is `reset_fault`, or `arm` while the device is neither in ramp_up nor active; in
/// its place in the order and with its whole group, as any other. A claim that was armed so does not keep the
/// device on when the others have gone.
inline constexpr std::uint32_t restricted = 1u << 1;
/// All flags.
inline constexpr std::uint32_t all = more | restricted;
}  // namespace command_flags

/// What a command begins with.
struct CommandHeader {
    /// Cells of the whole message, this header included.
    std::uint32_t cells = 0;
    /// What it does.
    CommandType type{};
    /// Its number: 1, 2, ... in order, without gaps.
    std::uint64_t number = 0;
    /// command_flags.
    std::uint32_t flags = 0;
    /// Bytes of parameters behind the body.
    std::uint32_t bytes = 0;
};

/// Body of `add`.
struct AddBody {
    /// Slot and generation for the representation.
    RepresentationId id;
    /// Its kind.
    Kind kind = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// How it is used.
    AddOptions options;
};

/// Body of `remove`.
struct RemoveBody {
    /// The representation.
    RepresentationId id;
};

/// Body of `place_probe`.
struct PlaceProbeBody {
    /// The probe, 0 to 15.
    std::uint32_t probe = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Where it is placed.
    ProbePlacement placement;
};

/// The servo's answer to one command: one cell.
struct Reply {
    /// Number of the command.
    std::uint64_t command = 0;
    /// Verdict::Code.
    std::uint32_t code = 0;
    /// Verdict::field.
    std::uint32_t field = 0;
    /// Verdict::value.
    double value = 0;
    /// Code refused: a RefusalReason; contradiction: Verdict::reason.
    std::uint32_t reason = 0;
    /// Kind of the representation, for the sentence.
    std::uint32_t kind = 0;
    /// Of `add`: stiffness after clamping (N/m).
    double applied_stiffness = 0;
    /// Verdict::against.
    double against = 0;
    /// Padding; 0.
    std::uint64_t reserved[2] = {};
};
static_assert(sizeof(Reply) == 64);

/// Result of the servo's check of a command.
inline Verdict verdict_of(const Reply& reply) noexcept {
    return {static_cast<Verdict::Code>(reply.code), reply.field, reply.value, reply.reason, reply.against};
}

/// Why the device's state forbids a command.
enum class RefusalReason : std::uint32_t {
    /// It does not.
    none = 0,
    /// The device is not calibrated: home it first.
    not_calibrated,
    /// The device is in fault: reset it first; value: the fault mask.
    in_fault,
    /// Wait until the hand is slow; value: its speed (m/s).
    hand_too_fast,
    /// The device is in no fault.
    not_in_fault,
    /// Another command of the same group was refused.
    group_refused,
    /// The device is gone.
    disconnected,
    /// The message does not parse.
    malformed,
    /// This client may not: command_flags::restricted, observe_and_reset.
    forbidden,
    /// The cause of the fault goes on: end it first; value: the mask of what goes on.
    cause_persists,
    /// The cycle has no time left for it; value: what it takes already, as a share of the period; against: up to
    /// what it takes more, 0 for a claim that was shed.
    cycle_full,
};

/// A batch of parameter updates in the triple buffer: this header, then per entry an EntryHeader and its
/// parameters padded to 8 bytes. The number of commands issued before it is the buffer's tag.
struct BatchHeader {
    /// 1, 2, ..., one per commit.
    std::uint64_t sequence = 0;
    /// Number of commands issued before it.
    std::uint64_t commands_before = 0;
    /// Cycle of the report from which it was computed; 0: none.
    std::uint64_t report_cycle = 0;
    /// When commit was called (ns of CLOCK_MONOTONIC).
    std::int64_t commit_ns = 0;
    /// Number of entries.
    std::uint32_t entries = 0;
    /// Bytes of all entries.
    std::uint32_t bytes = 0;
};

/// What an entry of a batch begins with.
struct EntryHeader {
    /// The representation.
    RepresentationId id;
    /// Its kind.
    Kind kind = 0;
    /// Bytes of parameters before padding: all, or KindInfo::geometry_bytes of them.
    std::uint32_t bytes = 0;
    /// Version of these parameters, since an entry may arrive twice. Of two entries for one representation in
    /// a batch the last counts.
    std::uint64_t version = 0;
};
static_assert(sizeof(EntryHeader) + max_parameter_bytes <= batch_bytes_for(1));

/// Feedback in a triple buffer back: this header, then `entries` FeedbackEntry. World frame of the claim.
struct FeedbackHeader {
    /// Cycle to which the feedback belongs. While a claim has nothing within the hand's reach, feedback comes
    /// when something changes, and stays true until then.
    std::uint64_t cycle = 0;
    /// Sequence of the newest batch that has taken effect.
    std::uint64_t batch = 0;
    /// Cycle in which it did.
    std::uint64_t batch_cycle = 0;
    /// Cycle of the report from which it was computed.
    std::uint64_t batch_report_cycle = 0;
    /// When it was committed (ns).
    std::int64_t batch_commit_ns = 0;
    /// When the first force computed from it had been written (ns).
    std::int64_t batch_write_ns = 0;
    /// Time from the read of the report from which it was computed to that write (ns).
    std::int64_t batch_age_ns = 0;
    /// Batches that were refused.
    std::uint64_t batches_refused = 0;
    /// Sequence of the last refused batch; the following fields say why.
    std::uint64_t refused_batch = 0;
    /// Verdict::Code.
    std::uint32_t refused_code = 0;
    /// Verdict::field.
    std::uint32_t refused_field = 0;
    /// Verdict::value.
    double refused_value = 0;
    /// Verdict::against.
    double refused_against = 0;
    /// Kind of the representation.
    std::uint32_t refused_kind = 0;
    /// Slot of the representation.
    std::uint32_t refused_slot = 0;
    /// Gain of this claim, 0 to 1.
    double gain = 0;
    /// Time since the last commit, if that counts as silence (s), as of `cycle`; 0: not silent.
    double silence = 0;
    /// Scales of the hand's budget (scales_of); all bits set: all of them 1.
    std::uint64_t scales = ~std::uint64_t{0};
    /// Number of entries.
    std::uint32_t entries = 0;
    /// Verdict::reason.
    std::uint32_t refused_reason = 0;
};

/// Three scales in one word, to half a millionth: a header is in every datagram of feedback.
inline std::uint64_t packed(const HandScales& scales) noexcept {
    constexpr double most = (1 << 21) - 1;
    const auto part = [](double scale) {
        return static_cast<std::uint64_t>(std::clamp(scale, 0.0, 1.0) * most + 0.5);
    };
    return part(scales.contacts) | part(scales.effects) << 21 | part(scales.damping) << 42 |
           std::uint64_t{1} << 63;
}
/// The scales in a header.
inline HandScales scales_of(const FeedbackHeader& header) noexcept {
    constexpr std::uint64_t most = (1 << 21) - 1;
    const auto part = [&](int from) {
        return static_cast<double>(header.scales >> from & most) / static_cast<double>(most);
    };
    return {part(0), part(21), part(42)};
}

/// Result of the servo's check of the last batch that it refused.
inline Verdict verdict_of(const FeedbackHeader& header) noexcept {
    return {static_cast<Verdict::Code>(header.refused_code), header.refused_field, header.refused_value,
            header.refused_reason, header.refused_against};
}

/// Feedback of one representation; as Feedback.
struct FeedbackEntry {
    /// The representation.
    RepresentationId id;
    /// Force on the hand (N).
    Vec3 force;
    /// Torque on the hand (N m).
    Vec3 torque;
    /// Contact point (m). Where it is not touched: the probe's position at the last change of the other
    /// fields.
    Vec3 contact_point;
    /// Stiffness as applied (N/m).
    double stiffness = 0;
    /// Stiffness of its friction, as applied (N/m).
    double tangential_stiffness = 0;
    /// Bit mask of Feedback::touching and the others.
    std::uint32_t flags = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
};

}  // namespace knurl::protocol
