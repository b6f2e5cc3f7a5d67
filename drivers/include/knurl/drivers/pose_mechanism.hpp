#pragma once

/// @file
/// A "device" whose joints are a pose: for a probe that is exactly where a recording or a motion says.

#include <cmath>

#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// Seven positions x, y, z (m), qw, qx, qy, qz, but six velocities: JointSample::velocity[0..2] is the tip's
/// linear velocity (m/s) and [3..5] its angular velocity (rad/s, device frame). A quaternion's derivative is
/// no angular velocity; so the Jacobian maps the six velocities, and is the identity in columns 0 to 5, and
/// efforts J^T W are the wrench itself. Whoever differentiates positions joint by joint must not do so here:
/// a device with this mechanism has has_velocity set.
class PoseMechanism final : public Mechanism {
  public:
    /// Seven.
    int joints() const noexcept override { return 7; }

    /// False for anything that is not finite, or a quaternion shorter than 1e-6; others are normalised.
    bool forward(std::span<const double> joints, TipPose& pose, Jacobian& jacobian) const noexcept override {
        if (joints.size() < 7) {
            return false;
        }
        const Eigen::Vector3d position(joints[0], joints[1], joints[2]);
        const Eigen::Quaterniond orientation(joints[3], joints[4], joints[5], joints[6]);
        const double length = orientation.norm();
        if (!position.allFinite() || !(length > 1e-6) || !std::isfinite(length)) {
            return false;
        }
        pose.position = position;
        // A unit quaternion is passed on to the bit: dividing by 1 +- 1e-16 would change it.
        pose.orientation = std::abs(length - 1) < 1e-15 ? orientation : orientation.normalized();
        jacobian.setZero();
        jacobian.topLeftCorner<6, 6>().setIdentity();
        return true;
    }
};

}  // namespace knurl::drivers
