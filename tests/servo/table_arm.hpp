#pragma once
// A device whose own dynamics cost nothing, for programs that measure the cycle.

#include <array>
#include <cmath>
#include <memory>
#include <string_view>

#include <knurl/drivers/sim_device.hpp>

namespace knurl::servo {

/// The arm of a profile, with its joints on a slow closed path of 4096 samples, in whole encoder counts.
class TableArm final : public drivers::Device {
  public:
    explicit TableArm(std::string_view name = "premium15") {
        const drivers::SimProfile profile = drivers::sim_profile(name);
        joints_ = static_cast<std::size_t>(profile.joints);
        const drivers::SimDevice device(profile);
        link_ = device.link();
        mechanism_ = profile.mechanism;
        for (std::size_t i = 0; i < path_.size(); ++i) {
            const double phase = 2 * M_PI * static_cast<double>(i) / static_cast<double>(path_.size());
            for (std::size_t j = 0; j < joints_; ++j) {
                const double q = profile.centre[j] + 0.1 * std::sin(phase * static_cast<double>(j + 1));
                const double count = link_.radians_per_count[j];
                path_[i][j] = count > 0 ? std::round(q / count) * count : q;
            }
        }
    }

    const drivers::LinkConfig& link() const noexcept override { return link_; }
    const drivers::Mechanism& mechanism() const noexcept override { return *mechanism_; }
    drivers::ReadStatus read(Nanoseconds, drivers::JointSample& sample) noexcept override {
        const auto& joints = path_[next_++ % path_.size()];
        for (std::size_t j = 0; j < joints_; ++j) sample.position[j] = joints[j];
        return drivers::ReadStatus::ok;
    }
    bool write(Nanoseconds, const drivers::JointEfforts& efforts) noexcept override {
        efforts_ = efforts;
        return true;
    }
    void make_safe() noexcept override {}
    /// What was written last.
    const drivers::JointEfforts& efforts() const noexcept { return efforts_; }

  private:
    drivers::LinkConfig link_;
    std::shared_ptr<const drivers::Mechanism> mechanism_;
    std::size_t joints_ = 0;
    std::array<std::array<double, protocol::max_joints>, 4096> path_ = {};
    std::size_t next_ = 0;
    drivers::JointEfforts efforts_ = {};
};

}  // namespace knurl::servo
