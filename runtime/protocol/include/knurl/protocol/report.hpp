#pragma once
// What the servo publishes each cycle, of one device, in that device's own frame (a claim's library turns it
// into its world frame). Wire type: fixed width, no padding.

#include <array>
#include <cstdint>
#include <type_traits>

#include <knurl/reps/vec.hpp>

namespace knurl {

enum class DeviceState : std::uint32_t {
    disconnected = 0,
    idle = 1,   // zero force; positions are read
    armed = 2,  // claimed and calibrated, gain 0, waiting for a slow hand
    ramp_up = 3,
    active = 4,
    ramp_down = 5,
    fault = 6,  // zero force, latched until a claim's owner resets it
};

/// Why a device is in `fault`: a bit mask in the report.
namespace fault {
inline constexpr std::uint32_t not_finite = 1u << 0;  // a scene's wrench was not finite
inline constexpr std::uint32_t slew = 1u << 1;        // the wrench changed too fast for too long
inline constexpr std::uint32_t speed = 1u << 2;       // the hand went faster than the limit
inline constexpr std::uint32_t power = 1u << 3;       // too much power into the hand
inline constexpr std::uint32_t unplugged = 1u << 4;
inline constexpr std::uint32_t bad_samples = 1u << 5;   // ten bad samples in a row
inline constexpr std::uint32_t encoder_jump = 1u << 6;  // an impossible jump of position went on
inline constexpr std::uint32_t clock_jump = 1u << 7;    // the clock jumped (suspend)
inline constexpr std::uint32_t kinematics = 1u << 8;    // the mechanism had no pose for the joints
inline constexpr std::uint32_t guardian = 1u << 9;  // the guardian zeroed the device while the servo stalled
}  // namespace fault

struct Report {
    std::uint64_t cycle = 0;
    std::int64_t deadline_ns = 0;       // CLOCK_MONOTONIC: when the cycle should have begun
    std::int64_t read_ns = 0;           // when the joint sample had been read
    std::int64_t write_ns = 0;          // when the efforts had been written
    std::array<double, 8> joints = {};  // rad
    Vec3 position;                      // m
    Quat orientation;
    Vec3 velocity;          // m/s, smooth (FOAW 16)
    Vec3 slow_velocity;     // m/s, first order 20 Hz: for prediction
    Vec3 angular_velocity;  // rad/s
    Vec3 scene_force;       // N, the scenes' sum before the supervisor
    Vec3 scene_torque;      // N m, about `position`
    Vec3 sent_force;        // N, after the supervisor
    Vec3 sent_torque;       // N m
    Vec3 contact_point;     // m, of probe 0 (of the first claim in contact); else its position
    DeviceState state = DeviceState::disconnected;
    std::uint32_t faults = 0;
    std::uint32_t buttons = 0;
    std::uint32_t flags = 0;       // report_flags
    std::uint64_t late_count = 0;  // cycles whose write ended after the next deadline
    // What happened in reports that a reader did not get:
    std::uint32_t presses = 0;  // a bit per button, turned over whenever the button goes down
    std::uint32_t touches = 0;  // how often `touching` began
};

namespace report_flags {
inline constexpr std::uint32_t clamped = 1u << 0;   // the supervisor reduced the wrench in this cycle
inline constexpr std::uint32_t stale = 1u << 1;     // no new joint sample in this cycle
inline constexpr std::uint32_t guardian = 1u << 2;  // the guardian had zeroed the device before this cycle
inline constexpr std::uint32_t touching = 1u << 3;  // some surface is felt
// Looked at in every 16th cycle:
// The arm hardly moves, and pushes badly, in one direction. Of devices with three driven joints or more.
inline constexpr std::uint32_t near_singular = 1u << 4;
// A joint is within 1 % of its range of a stop. Of joints with stops of their own, not of rows that several
// motors turn together.
inline constexpr std::uint32_t at_joint_limit = 1u << 5;
}  // namespace report_flags

static_assert(std::is_trivially_copyable_v<Report> && sizeof(Report) == 376 && sizeof(Report) <= 384);
static_assert(sizeof(Report) % 8 == 0);

}  // namespace knurl
