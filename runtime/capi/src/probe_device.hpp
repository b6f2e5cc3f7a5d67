#pragma once
// A device that is exactly where somebody puts it, cycle by cycle.

#include <knurl_offline.h>

#include <knurl/drivers/device.hpp>
#include <knurl/drivers/pose_mechanism.hpp>

namespace knurl::capi {

class ProbeDevice final : public drivers::Device {
  public:
    /// `period`: s, from one place to the next, for velocities that are not given.
    explicit ProbeDevice(double period);

    const drivers::LinkConfig& link() const noexcept override { return link_; }
    const drivers::Mechanism& mechanism() const noexcept override { return mechanism_; }
    drivers::ReadStatus read(drivers::Nanoseconds, drivers::JointSample& sample) noexcept override {
        sample = sample_;
        return drivers::ReadStatus::ok;
    }
    bool write(drivers::Nanoseconds, const drivers::JointEfforts&) noexcept override { return true; }
    void make_safe() noexcept override {}

    /// Where it is in the next cycle. False: not finite, or an orientation without a length; nothing changes.
    bool put(const knurl_pose& pose) noexcept;

  private:
    drivers::PoseMechanism mechanism_;
    drivers::LinkConfig link_;
    drivers::JointSample sample_;
    double period_;
    bool was_put_ = false;
};

}  // namespace knurl::capi
