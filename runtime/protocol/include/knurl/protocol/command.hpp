#pragma once
// Messages of the command channel: a header and a body, in 64-byte cells of an SPSC ring. Commands that
// belong together are pushed at once and all but the last carry `more`: the servo does all of them in one
// cycle, and if one of them is refused, none is done.

#include <algorithm>
#include <cstdint>

#include <knurl/protocol/bounds.hpp>
#include <knurl/reps/scene.hpp>

namespace knurl::protocol {

enum class CommandType : std::uint32_t {
    add = 1,          // AddBody, then `bytes` of parameters
    remove = 2,       // RemoveBody
    place_probe = 3,  // PlaceProbeBody
    arm = 4,          // no body
    disarm = 5,       // no body: this claim's gain goes to 0
    reset_fault = 6,  // no body: idle without force; who wants force arms anew
};

namespace command_flags {
inline constexpr std::uint32_t more = 1u << 0;  // the next message belongs to the same group
// Set by a bridge: this peer may join a device that somebody else has switched on, and no more. The servo
// refuses the command if it is `reset_fault`, or `arm` while the device is neither in ramp_up nor active; in
// its place in the order and with its whole group, as it refuses any other. A claim that was armed so does
// not keep the device on when the others have gone.
inline constexpr std::uint32_t restricted = 1u << 1;
inline constexpr std::uint32_t all = more | restricted;
}  // namespace command_flags

struct CommandHeader {
    std::uint32_t cells = 0;  // of the whole message, this header included
    CommandType type{};
    std::uint64_t number = 0;  // 1, 2, ... in order, without gaps
    std::uint32_t flags = 0;   // command_flags
    std::uint32_t bytes = 0;   // of parameters behind the body
};

struct AddBody {
    RepresentationId id;
    Kind kind = 0;
    std::uint32_t reserved = 0;
    AddOptions options;
};

struct RemoveBody {
    RepresentationId id;
};

struct PlaceProbeBody {
    std::uint32_t probe = 0;
    std::uint32_t reserved = 0;
    ProbePlacement placement;
};

/// The servo's answer to one command: one cell.
struct Reply {
    std::uint64_t command = 0;  // its number
    std::uint32_t code = 0;     // Verdict::Code
    std::uint32_t field = 0;
    double value = 0;
    std::uint32_t reason = 0;      // code refused: RefusalReason; contradiction: which of the kind's
    std::uint32_t kind = 0;        // of the representation, for the sentence
    double applied_stiffness = 0;  // N/m: of an `add`, after clamping
    double against = 0;            // Verdict::against
    std::uint64_t reserved[2] = {};
};
static_assert(sizeof(Reply) == 64);

/// What the servo's check of the parameters said.
inline Verdict verdict_of(const Reply& reply) noexcept {
    return {static_cast<Verdict::Code>(reply.code), reply.field, reply.value, reply.reason, reply.against};
}

/// Why the device's state forbids a command.
enum class RefusalReason : std::uint32_t {
    none = 0,
    not_calibrated,  // home the device first
    in_fault,        // reset it first; value: the fault mask
    hand_too_fast,   // wait until the hand is slow; value: m/s
    not_in_fault,
    group_refused,  // another command of the same group was refused
    disconnected,
    malformed,       // the message does not parse
    forbidden,       // command_flags::restricted, observe_and_reset
    cause_persists,  // mend what led to the fault; value: the mask of what goes on
};

/// A batch of parameter updates in the triple buffer: this header, then per entry an EntryHeader and its
/// parameters padded to 8 bytes. The number of commands issued before it is the buffer's tag.
struct BatchHeader {
    std::uint64_t sequence = 0;  // 1, 2, ... one per commit
    std::uint64_t commands_before = 0;
    std::uint64_t report_cycle = 0;  // the report that it was computed from; 0: none
    std::int64_t commit_ns = 0;      // CLOCK_MONOTONIC, when commit was called
    std::uint32_t entries = 0;
    std::uint32_t bytes = 0;  // of all entries
};

struct EntryHeader {
    RepresentationId id;
    Kind kind = 0;
    std::uint32_t bytes = 0;  // of parameters, before padding: all, or KindInfo::geometry_bytes of them
    // Of these parameters: an entry may arrive twice. Of two for one representation in a batch the last
    // counts.
    std::uint64_t version = 0;
};
static_assert(sizeof(EntryHeader) + max_parameter_bytes <= batch_bytes_for(1));

/// Feedback in a triple buffer back: this header, then `entries` FeedbackEntry. World frame of the claim.
struct FeedbackHeader {
    /// Of which it is. While a claim has nothing within the hand's reach it comes when something
    /// changes, and stays true until then.
    std::uint64_t cycle = 0;
    std::uint64_t batch = 0;               // sequence of the newest batch that has taken effect
    std::uint64_t batch_cycle = 0;         // the cycle in which it did
    std::uint64_t batch_report_cycle = 0;  // the report that it was computed from
    std::int64_t batch_commit_ns = 0;      // when it was committed
    std::int64_t batch_write_ns = 0;       // when the first force computed from it had been written
    std::int64_t batch_age_ns = 0;         // from the read of the report it was computed from to that write
    std::uint64_t batches_refused = 0;
    std::uint64_t refused_batch = 0;  // sequence of the last refused one; verdict:
    std::uint32_t refused_code = 0;
    std::uint32_t refused_field = 0;
    double refused_value = 0;
    double refused_against = 0;  // refused_code contradiction: the figure that the value contradicts
    std::uint32_t refused_kind = 0;
    std::uint32_t refused_slot = 0;
    double gain = 0;     // this claim's, 0-1
    double silence = 0;  // s since the last commit counted as silence, as of `cycle`; 0: not silent
    std::uint64_t scales = ~std::uint64_t{0};  // scales_of: what the hand's budget leaves; all of them 1
    std::uint32_t entries = 0;
    std::uint32_t refused_reason = 0;  // refused_code contradiction: which of the kind's
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
inline HandScales scales_of(const FeedbackHeader& header) noexcept {
    constexpr std::uint64_t most = (1 << 21) - 1;
    const auto part = [&](int from) {
        return static_cast<double>(header.scales >> from & most) / static_cast<double>(most);
    };
    return {part(0), part(21), part(42)};
}

/// What the servo's check said of the last batch that it refused.
inline Verdict verdict_of(const FeedbackHeader& header) noexcept {
    return {static_cast<Verdict::Code>(header.refused_code), header.refused_field, header.refused_value,
            header.refused_reason, header.refused_against};
}

struct FeedbackEntry {
    RepresentationId id;
    Vec3 force;                       // N on the hand
    Vec3 torque;                      // N m
    Vec3 contact_point;               // m; of what is not touched: the probe, when the rest last changed
    double stiffness = 0;             // N/m applied
    double tangential_stiffness = 0;  // N/m of its friction, applied
    std::uint32_t flags = 0;          // Feedback::touching, ...
    std::uint32_t reserved = 0;
};

}  // namespace knurl::protocol
