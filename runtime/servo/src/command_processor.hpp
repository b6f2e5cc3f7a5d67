#pragma once
// Reads what a claim's application sends. Bytes are copied once into private memory and checked there before
// they have any effect. So they cannot crash or stall the servo, or affect another claim.

#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include <knurl/servo/input_log.hpp>

#include "claim_impl.hpp"

namespace knurl::servo {

/// A struct from bytes at any alignment.
template <class T>
T read_as(const std::byte* from) noexcept {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

template <class T>
std::span<const std::byte> as_bytes(const T& value) noexcept {
    return std::as_bytes(std::span(&value, 1));
}

/// The device's state, by which commands are answered.
struct Authority {
    Supervisor& supervisor;
    bool calibrated = false;
    double speed = 0;           // m/s, of the hand
    bool ending = false;        // the servo is about to end: arming is refused
    std::uint32_t trouble = 0;  // faults that this cycle's sample would raise
    double load = 0;            // share of the period that cycles take
};

struct CommandCounts {
    std::uint64_t commands_done = 0, commands_refused = 0;
    std::uint64_t batches_taken = 0, batches_refused = 0, batches_merged = 0;
};

/// Scratch memory for one claim at a time; all lasting state is in the claim.
class CommandProcessor {
  public:
    CommandProcessor();

    /// Executes the waiting groups of commands whose replies fit, up to so many cells. (Offline: all groups
    /// that were there before the first cycle.) A group is executed or refused as a whole, in one cycle.
    /// Returns the number of cells.
    std::uint32_t take_commands(Claim::Impl& claim, const Authority& authority, std::uint32_t most,
                                Nanoseconds now) noexcept;
    /// Takes the newest batch, unless it was committed after commands that still wait. Returns its cells.
    std::uint32_t take_batch(Claim::Impl& claim, std::uint64_t cycle, Nanoseconds now) noexcept;

    const CommandCounts& counts() const noexcept { return counts_; }

    InputLog* input_log = nullptr;  // null: nobody records
    bool shows = false;             // somebody watches the scenes: changes are marked in Claim::Impl::unshown

  private:
    /// A command of the present group; it points into the private copy.
    struct Command {
        protocol::CommandHeader header;
        const std::byte* body = nullptr;
        const std::byte* params = nullptr;
    };
    struct Answer {
        Verdict verdict;
        protocol::RefusalReason reason = protocol::RefusalReason::none;
        explicit operator bool() const noexcept { return static_cast<bool>(verdict); }
    };
    /// The result of parsing a group: `cells` of them, or malformed at command `at`.
    struct Parsed {
        std::uint32_t cells = 0;
        std::size_t commands = 0;
        bool malformed = false;
    };

    bool copied_to(Claim::Impl& claim, std::size_t cells) noexcept;
    Parsed parse_group(Claim::Impl& claim, std::uint32_t from) noexcept;
    Answer check(Claim::Impl& claim, const Command& command, const Authority& authority,
                 bool& reset) noexcept;
    Answer check_add(Claim::Impl& claim, const Command& command, double load) noexcept;
    Answer check_remove(Claim::Impl& claim, const Command& command) noexcept;
    bool check_group(Claim::Impl& claim, std::size_t commands, const Authority& authority) noexcept;
    void do_command(Claim::Impl& claim, const Command& command, const Authority& authority,
                    protocol::Reply& reply) noexcept;
    void remember(Claim::Impl& claim, std::uint32_t slot) noexcept;
    void malformed(Claim::Impl& claim, std::uint64_t number) noexcept;

    Verdict check_entries(Claim::Impl& claim, const protocol::BatchHeader& header) noexcept;
    void apply_entries(Claim::Impl& claim, const protocol::BatchHeader& header) noexcept;

    std::vector<std::byte> cells_;
    std::uint32_t available_ = 0, copied_ = 0;  // cells in the present ring; those of them that are in cells_
    std::vector<Command> group_;
    std::vector<protocol::Reply> replies_;
    std::vector<std::pair<std::uint32_t, ClaimSlot>> undo_;  // slots as they were before the group
    std::vector<std::byte> entries_;
    std::uint32_t bad_kind_ = 0, bad_slot_ = 0;  // of the entry for which a batch was refused
    CommandCounts counts_;
};

}  // namespace knurl::servo
