#pragma once

/// @file
/// The contract of a driver: read joint positions, write joint efforts. Nothing of Cartesian space is here.

#include <array>
#include <cstdint>
#include <memory>

#include <knurl/drivers/link_config.hpp>
#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// Time (ns) of CLOCK_MONOTONIC, or of the virtual clock.
using Nanoseconds = std::int64_t;

/// What a read has brought.
enum class ReadStatus : std::uint32_t {
    /// A new sample.
    ok,
    /// No new sample in this cycle: the old one is repeated.
    stale,
    /// Garbage arrived: the servo counts it and keeps the old sample.
    bad,
    /// The device is gone.
    unplugged,
};

/// What a read brings.
struct JointSample {
    /// Positions of the joints (rad; m if prismatic).
    std::array<double, max_joints> position = {};
    /// Velocities of the joints (rad/s; m/s if prismatic), if `has_velocity`.
    std::array<double, max_joints> velocity = {};
    /// True: the device measures velocity itself; false: the servo differentiates.
    bool has_velocity = false;
    /// True: homing is done.
    bool calibrated = true;
    /// Bit mask of the buttons' contacts as they are: open_device() debounces them (debounce.hpp).
    std::uint32_t buttons = 0;
};

/// Efforts of the joints (N m; N if prismatic).
using JointEfforts = std::array<double, max_joints>;

/// What the servo tells a device besides efforts.
enum class Notice : std::uint32_t {
    /// A claim's gain has just reached 1: a scripted hand begins its motion.
    claim_active,
    /// Efforts other than zero may follow.
    enabled,
    /// Only zero efforts follow: devices with an enable line drop it.
    disabled,
};

/// A haptic device. All but the destructor is noexcept, allocates nothing and never blocks the cycle: a slow
/// transport belongs on a thread of the driver's own. `read` comes before `write` in every cycle.
class Device {
  public:
    /// Leaves the motors at zero.
    virtual ~Device() = default;

    /// What the device says about itself; the same for its whole life, unless a setter says otherwise.
    virtual const LinkConfig& link() const noexcept = 0;
    /// Its kinematics.
    virtual const Mechanism& mechanism() const noexcept = 0;
    /// False: `JointSample::buttons` stays 0.
    virtual bool has_buttons() const noexcept { return true; }

    /// Reads the joints. `now`: when the cycle began. Fills in `sample` if the status is ok.
    virtual ReadStatus read(Nanoseconds now, JointSample& sample) noexcept = 0;
    /// Writes the joints' efforts. False: the device is gone.
    virtual bool write(Nanoseconds now, const JointEfforts& efforts) noexcept = 0;
    /// Tells the device what happens besides; see Notice.
    virtual void notify(Notice) noexcept {}

    /// Zero efforts at once. The guardian calls it, a process forked after the device was opened, when the
    /// servo has died or stalled. It may touch nothing but what a fork leaves valid (descriptors, shared
    /// mappings).
    virtual void make_safe() noexcept = 0;
};

}  // namespace knurl::drivers
