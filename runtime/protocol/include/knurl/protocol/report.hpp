#pragma once

/// @file
/// What the servo publishes each cycle, of one device, in that device's own frame (a claim's library turns it
/// into its world frame). Wire type: fixed width, no padding.

#include <array>
#include <cstdint>
#include <type_traits>

#include <knurl/reps/vec.hpp>

namespace knurl {

/// State of a device (Supervisor).
enum class DeviceState : std::uint32_t {
    /// The device does not answer; no force.
    disconnected = 0,
    /// Positions are read; no force.
    idle = 1,
    /// Claimed and calibrated, gain 0; it waits for a slow hand.
    armed = 2,
    /// The force ramps up.
    ramp_up = 3,
    /// The whole force.
    active = 4,
    /// The force ramps down.
    ramp_down = 5,
    /// No force, latched until a reset.
    fault = 6,
};

/// Why a device is in `fault`: a bit mask in the report.
namespace fault {
/// A scene's wrench was not finite.
inline constexpr std::uint32_t not_finite = 1u << 0;
/// The wrench changed too fast for too long.
inline constexpr std::uint32_t slew = 1u << 1;
/// The hand was faster than the limit.
inline constexpr std::uint32_t speed = 1u << 2;
/// Too much power went into the hand.
inline constexpr std::uint32_t power = 1u << 3;
/// The device is gone.
inline constexpr std::uint32_t unplugged = 1u << 4;
/// Ten bad samples in a row.
inline constexpr std::uint32_t bad_samples = 1u << 5;
/// An impossible jump of the position went on.
inline constexpr std::uint32_t encoder_jump = 1u << 6;
/// The clock jumped: the machine was suspended, or the servo stopped.
inline constexpr std::uint32_t clock_jump = 1u << 7;
/// The mechanism had no pose for the joints.
inline constexpr std::uint32_t kinematics = 1u << 8;
/// The guardian put the motors to zero while the servo stalled.
inline constexpr std::uint32_t guardian = 1u << 9;
/// Cycles took longer than the period, on average over 20 ms.
inline constexpr std::uint32_t overload = 1u << 10;
/// The guardian stood still: nobody would have zeroed the motors in place of the servo.
inline constexpr std::uint32_t unguarded = 1u << 11;
}  // namespace fault

/// What the servo publishes in each cycle of a device. In the device frame; a claim's library converts it
/// into the claim's world frame.
struct Report {
    /// Number of the cycle.
    std::uint64_t cycle = 0;
    /// When the cycle should have begun (ns of CLOCK_MONOTONIC).
    std::int64_t deadline_ns = 0;
    /// When the joint sample had been read (ns).
    std::int64_t read_ns = 0;
    /// When the efforts had been written (ns).
    std::int64_t write_ns = 0;
    /// Positions of the joints (rad; m if prismatic).
    std::array<double, 8> joints = {};
    /// Position of the tip (m).
    Vec3 position;
    /// Orientation of the tip.
    Quat orientation;
    /// Velocity of the tip, smooth (FOAW 16) (m/s).
    Vec3 velocity;
    /// Velocity of the tip by a first-order filter of 20 Hz, for prediction (m/s).
    Vec3 slow_velocity;
    /// Angular velocity of the tip (rad/s).
    Vec3 angular_velocity;
    /// Sum of the scenes' forces before the supervisor (N).
    Vec3 scene_force;
    /// Sum of the scenes' torques about `position` (N m).
    Vec3 scene_torque;
    /// Force after the supervisor (N).
    Vec3 sent_force;
    /// Torque after the supervisor (N m).
    Vec3 sent_torque;
    /// Contact point (m) of probe 0 of the first claim in contact; else the probe's position.
    Vec3 contact_point;
    /// State of the device.
    DeviceState state = DeviceState::disconnected;
    /// Bit mask of faults (knurl::fault).
    std::uint32_t faults = 0;
    /// Bit mask of the buttons that are down.
    std::uint32_t buttons = 0;
    /// Bit mask of report_flags.
    std::uint32_t flags = 0;
    /// Cycles whose write ended after the next deadline.
    std::uint64_t late_count = 0;
    /// A bit per button that flips whenever the button goes down: tells of presses in reports that a reader
    /// missed.
    std::uint32_t presses = 0;
    /// How often `touching` began.
    std::uint32_t touches = 0;
};

namespace report_flags {
/// The supervisor reduced the wrench in this cycle.
inline constexpr std::uint32_t clamped = 1u << 0;
/// No new joint sample in this cycle.
inline constexpr std::uint32_t stale = 1u << 1;
/// The guardian had put the motors to zero before this cycle.
inline constexpr std::uint32_t guardian = 1u << 2;
/// A surface is touched.
inline constexpr std::uint32_t touching = 1u << 3;
/// The arm hardly moves, and pushes badly, in one direction. Evaluated in every 16th cycle, for devices with
/// three driven joints or more.
inline constexpr std::uint32_t near_singular = 1u << 4;
/// A joint is within 1 % of its range of a stop. Evaluated in every 16th cycle, for joints with stops of
/// their own, not for rows that several motors turn together.
inline constexpr std::uint32_t at_joint_limit = 1u << 5;
}  // namespace report_flags

static_assert(std::is_trivially_copyable_v<Report> && sizeof(Report) == 376 && sizeof(Report) <= 384);
static_assert(sizeof(Report) % 8 == 0);

}  // namespace knurl
