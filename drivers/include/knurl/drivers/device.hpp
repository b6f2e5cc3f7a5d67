#pragma once
// The contract of a driver: read joint positions, write joint efforts. Nothing of Cartesian space is here.

#include <array>
#include <cstdint>
#include <memory>

#include <knurl/drivers/link_config.hpp>
#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

using Nanoseconds = std::int64_t;  // CLOCK_MONOTONIC, or the virtual clock's

enum class ReadStatus : std::uint32_t {
    ok,
    stale,  // no new sample this cycle: the old one is repeated
    bad,    // garbage arrived: count it, keep the old sample
    unplugged,
};

struct JointSample {
    std::array<double, max_joints> position = {};  // rad (m if prismatic)
    std::array<double, max_joints> velocity = {};  // rad/s, only if has_velocity
    bool has_velocity = false;  // the device measures velocity itself; else the servo differentiates
    bool calibrated = true;     // homing is done
    std::uint32_t buttons = 0;  // bit mask, as the contacts are: open_device() debounces (debounce.hpp)
};

using JointEfforts = std::array<double, max_joints>;  // N m (N if prismatic)

/// What the servo tells a device besides efforts.
enum class Notice : std::uint32_t {
    claim_active,  // a claim's gain has just reached 1: a scripted hand begins its motion
    enabled,       // efforts other than zero may follow
    disabled,      // only zero efforts follow: devices with an enable line drop it
};

/// All but the destructor is noexcept, allocates nothing and never blocks the cycle: a slow transport belongs
/// on a thread of the driver's own. `read` comes before `write` in every cycle.
class Device {
  public:
    virtual ~Device() = default;  // leaves the motors at zero

    virtual const LinkConfig& link() const noexcept = 0;
    virtual const Mechanism& mechanism() const noexcept = 0;
    /// False: `JointSample::buttons` stays 0.
    virtual bool has_buttons() const noexcept { return true; }

    virtual ReadStatus read(Nanoseconds now, JointSample& sample) noexcept = 0;
    /// Returns false when the device is gone.
    virtual bool write(Nanoseconds now, const JointEfforts& efforts) noexcept = 0;
    virtual void notify(Notice) noexcept {}

    /// Zero efforts at once. Called by the guardian, a process forked after the device was opened, when the
    /// servo has died or stalled: it may touch nothing but what a fork leaves valid (descriptors, shared
    /// mappings).
    virtual void make_safe() noexcept = 0;
};

}  // namespace knurl::drivers
