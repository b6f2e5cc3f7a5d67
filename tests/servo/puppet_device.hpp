#pragma once
// A device whose tip is where the test puts it, and which remembers its commands.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include <knurl/drivers/device.hpp>

namespace knurl::servo::testing {

/// The joints are the tip's coordinates or, with `six`, its position and small rotations.
class Straight final : public drivers::Mechanism {
  public:
    explicit Straight(int joints) : joints_(joints) {}
    int joints() const noexcept override { return joints_; }
    bool forward(std::span<const double> joints, drivers::TipPose& pose,
                 drivers::Jacobian& jacobian) const noexcept override {
        if (broken) return false;
        pose.position = {joints[0], joints[1], joints[2]};
        pose.orientation.setIdentity();
        jacobian.setZero();
        for (int i = 0; i < joints_; ++i) jacobian(i, i) = 1;
        jacobian(2, 2) = lever_z;
        return true;
    }
    bool broken = false;
    double lever_z = 1;  // m a unit of joint 3, as the Jacobian says

  private:
    int joints_;
};

class PuppetDevice final : public drivers::Device {
  public:
    explicit PuppetDevice(int joints = 3) : mechanism_(joints) {
        link_.name = "puppet";
        link_.sensed_joints = link_.actuated_joints = joints;
        link_.radians_per_count.assign(static_cast<std::size_t>(joints), 0);
        link_.effort_limit.assign(static_cast<std::size_t>(joints), 1000);
        link_.workspace_radius = 0.1;
        link_.peak_force = 10;
        link_.continuous_force = 5;
        link_.damping = 3.2;
        link_.lag = 0.53e-3;
        link_.apparent_mass = 0.15;
        if (joints >= 6) {
            link_.renders_torque = link_.senses_orientation = true;
            link_.peak_torque = 0.5;
        }
    }

    const drivers::LinkConfig& link() const noexcept override { return link_; }
    const drivers::Mechanism& mechanism() const noexcept override { return mechanism_; }
    drivers::ReadStatus read(Nanoseconds, drivers::JointSample& sample) noexcept override {
        for (std::size_t i = 0; i < 3; ++i) sample.position[i] = tip[static_cast<Eigen::Index>(i)];
        if (has_velocity)
            for (std::size_t i = 0; i < 3; ++i) sample.velocity[i] = velocity[static_cast<Eigen::Index>(i)];
        sample.has_velocity = has_velocity;
        sample.calibrated = calibrated;
        return status;
    }
    bool write(Nanoseconds, const drivers::JointEfforts& efforts) noexcept override {
        last = efforts;
        ++writes;
        return there;
    }
    void notify(drivers::Notice notice) noexcept override {
        if (notice_count < sizeof notices / sizeof *notices) notices[notice_count++] = notice;
    }
    void make_safe() noexcept override { last = {}; }

    Eigen::Vector3d force() const { return {last[0], last[1], last[2]}; }
    bool told(drivers::Notice notice) const {
        return std::find(notices, notices + notice_count, notice) != notices + notice_count;
    }

    drivers::LinkConfig link_;
    Straight mechanism_;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    bool has_velocity = false;
    drivers::ReadStatus status = drivers::ReadStatus::ok;
    bool calibrated = true;
    bool there = true;
    drivers::JointEfforts last = {};
    std::uint64_t writes = 0;
    drivers::Notice notices[64] = {};
    std::size_t notice_count = 0;
};

}  // namespace knurl::servo::testing
