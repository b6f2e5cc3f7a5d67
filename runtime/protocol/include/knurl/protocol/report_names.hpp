#pragma once

/// @file
/// The words for what a Report says in numbers, for people and for the reference: states, faults, flags.

#include <array>
#include <cstdint>
#include <string_view>

#include <knurl/protocol/report.hpp>

namespace knurl::protocol {

/// A state, fault or flag in words.
struct ReportName {
    /// Value of the state; of faults and flags the bit alone.
    std::uint32_t value;
    /// Its name.
    std::string_view name;
    /// Its meaning.
    std::string_view meaning;
};

/// The states.
inline constexpr std::array state_names{
    ReportName{0, "disconnected", "the device does not answer; no force"},
    ReportName{1, "idle", "positions are read; no force"},
    ReportName{2, "armed", "a claim has armed it; no force yet, it waits for a slow hand"},
    ReportName{3, "ramp up", "the force comes in"},
    ReportName{4, "active", "the whole force"},
    ReportName{5, "ramp down", "the force goes out"},
    ReportName{6, "fault", "no force, until somebody resets it"},
};

/// The faults.
inline constexpr std::array fault_names{
    ReportName{fault::not_finite, "not finite", "a scene's wrench was not finite"},
    ReportName{fault::slew, "slew", "the wrench changed too fast for too long"},
    ReportName{fault::speed, "speed", "the hand was faster than the limit"},
    ReportName{fault::power, "power", "too much power went into the hand"},
    ReportName{fault::unplugged, "unplugged", "the device is gone"},
    ReportName{fault::bad_samples, "bad samples", "ten bad samples in a row"},
    ReportName{fault::encoder_jump, "encoder jump", "an impossible jump of the position went on"},
    ReportName{fault::clock_jump, "clock jump",
               "the clock jumped: the machine was suspended, or the servo stopped"},
    ReportName{fault::kinematics, "kinematics", "the mechanism had no pose for the joints"},
    ReportName{fault::guardian, "guardian", "the guardian put the motors to zero while the servo stalled"},
    ReportName{fault::overload, "overload", "cycles took longer than the period, on average over 20 ms"},
    ReportName{fault::unguarded, "unguarded", "the guardian process stood still"},
};

/// The flags.
inline constexpr std::array flag_names{
    ReportName{report_flags::clamped, "clamped", "the supervisor reduced the wrench in this cycle"},
    ReportName{report_flags::stale, "stale", "no new joint sample in this cycle"},
    ReportName{report_flags::guardian, "guardian",
               "the guardian had put the motors to zero before this cycle"},
    ReportName{report_flags::touching, "touching", "a surface is felt"},
    ReportName{report_flags::near_singular, "near singular",
               "the arm hardly moves in one direction; looked at in every 16th cycle"},
    ReportName{report_flags::at_joint_limit, "at joint limit",
               "a joint is within 1 % of its range of a stop; looked at in every 16th cycle"},
};

static_assert(state_names.size() == static_cast<std::size_t>(DeviceState::fault) + 1);

}  // namespace knurl::protocol
