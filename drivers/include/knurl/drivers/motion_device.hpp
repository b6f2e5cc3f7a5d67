#pragma once
// A device that is exactly where a motion says: offline evaluation without a device.

#include <optional>

#include <knurl/drivers/device.hpp>
#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/pose_mechanism.hpp>

namespace knurl::drivers {

/// Joints are those of PoseMechanism, velocities are the motion's own; efforts are ignored. It limits
/// nothing: peak force and damping are 0 in its LinkConfig, so whoever derives limits from them must know
/// that it has none.
class MotionDevice final : public Device {
  public:
    explicit MotionDevice(Motion motion);

    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return mechanism_; }
    bool has_buttons() const noexcept override { return false; }

    /// The motion at the time set by `at`, else at `now` (0 ns is the motion's t = 0). A motion's row that is
    /// less than a nanosecond from `now` counts as now, since the clock cannot say its time more exactly.
    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override;
    bool write(Nanoseconds, const JointEfforts&) noexcept override { return true; }
    void make_safe() noexcept override {}  // moves no motor

    /// The next reads are at exactly t seconds of the motion: a cycle at t = i/3000 s is no whole nanosecond.
    void at(double t) noexcept { time_ = t; }

    const Motion& motion() const noexcept { return motion_; }

  private:
    Motion motion_;
    PoseMechanism mechanism_;
    LinkConfig link_;
    std::optional<double> time_;  // s
    std::size_t hint_ = 0;
};

}  // namespace knurl::drivers
