#pragma once

/// @file
/// A device whose maker's library says where the tip is, and nothing of its joints.

#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// Joints x, y, z (m); of a device with a wrist three more, the rotation vector of the tip's orientation (rad); of one
/// with a gripper its gap (m), which moves nothing at the tip. Efforts are J^T W: for the position the force itself;
/// for the rotation vector r the torque through the left Jacobian of the rotation group, since the rate of r is no
/// angular velocity.
class CartesianTool final : public Mechanism {
  public:
    /// `gripper`: which joint is the gripper's gap: 3 (before the wrist) or the last; -1: it has none.
    explicit CartesianTool(bool wrist, int gripper = -1) noexcept : wrist_(wrist), gripper_(gripper) {}

    /// 3 to 7.
    int joints() const noexcept override { return 3 + (wrist_ ? 3 : 0) + (gripper_ >= 0 ? 1 : 0); }
    /// False if a joint is not finite or too few are given, or the rotation vector is longer than 2 pi, where the left
    /// Jacobian is singular.
    bool forward(std::span<const double> joints, TipPose& pose, Jacobian& jacobian) const noexcept override;

    /// First joint of the rotation vector.
    int rotation() const noexcept { return gripper_ == 3 ? 4 : 3; }

    /// Omega = J(r) r': the left Jacobian of the rotation group.
    static Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& rotation) noexcept;
    /// The rotation vector of this orientation that is nearest to `last`: so that it does not leap by 2 pi where a
    /// hand turns past half a turn.
    static Eigen::Vector3d rotation_near(const Eigen::Quaterniond& orientation,
                                         const Eigen::Vector3d& last) noexcept;

  private:
    bool wrist_;
    int gripper_;
};

}  // namespace knurl::drivers
