#pragma once

/// @file
/// Three sliding axes along x, y, z: the joints are the position.

#include <cmath>

#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// Three prismatic joints (m, N); knows no orientation and takes no torque.
class Cartesian final : public Mechanism {
  public:
    /// Three.
    int joints() const noexcept override { return 3; }

    /// False if a joint is not finite or too few are given.
    bool forward(std::span<const double> joints, TipPose& pose, Jacobian& jacobian) const noexcept override {
        if (joints.size() < 3 || !std::isfinite(joints[0]) || !std::isfinite(joints[1]) ||
            !std::isfinite(joints[2])) {
            return false;
        }
        pose.position = {joints[0], joints[1], joints[2]};
        pose.orientation.setIdentity();
        jacobian.setZero();
        jacobian.topLeftCorner<3, 3>().setIdentity();
        return true;
    }
};

}  // namespace knurl::drivers
