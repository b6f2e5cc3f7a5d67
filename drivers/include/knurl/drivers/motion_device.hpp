#pragma once

/// @file
/// A device that is exactly where a motion says: offline evaluation without a device.

#include <optional>

#include <knurl/drivers/device.hpp>
#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/pose_mechanism.hpp>

namespace knurl::drivers {

/// Joints are those of PoseMechanism, velocities are the motion's own; efforts are ignored. It limits
/// nothing: peak force and damping are 0 in its LinkConfig, so code that derives limits from them must know
/// that it has none.
class MotionDevice final : public Device {
  public:
    /// A device that follows this motion.
    explicit MotionDevice(Motion motion);

    /// No limits.
    const LinkConfig& link() const noexcept override { return link_; }
    /// A PoseMechanism.
    const Mechanism& mechanism() const noexcept override { return mechanism_; }
    /// None.
    bool has_buttons() const noexcept override { return false; }

    /// The motion at the time set by `at`, else at `now` (0 ns is the motion's t = 0). A motion's row that is
    /// less than a nanosecond from `now` counts as now, since the clock cannot say its time more exactly.
    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override;
    /// Ignores the efforts.
    bool write(Nanoseconds, const JointEfforts&) noexcept override { return true; }
    /// It moves no motor.
    void make_safe() noexcept override {}

    /// The next reads are at exactly t seconds of the motion: a cycle at t = i/3000 s is no whole number of
    /// nanoseconds.
    void at(double t) noexcept { time_ = t; }

    /// The motion.
    const Motion& motion() const noexcept { return motion_; }

  private:
    Motion motion_;
    PoseMechanism mechanism_;
    LinkConfig link_;
    std::optional<double> time_;  // s
    std::size_t hint_ = 0;
};

}  // namespace knurl::drivers
