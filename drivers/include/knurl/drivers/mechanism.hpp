#pragma once

/// @file
/// Joints <-> Cartesian. A serial chain from a table, or a closed form.

#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace knurl::drivers {

/// The tip as the joints place it, in the device's base frame.
struct TipPose {
    /// Position (m).
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    /// Orientation: turns the tip's axes into the base's.
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// Rows 0 to 2: d(position)/d(joint) (m/rad); rows 3 to 5: angular velocity per joint rate. Columns past the
/// mechanism's joints are zero.
using Jacobian = Eigen::Matrix<double, 6, 8>;

/// Forward kinematics: from joints to the tip's pose and Jacobian.
class Mechanism {
  public:
    virtual ~Mechanism() = default;
    /// Number of joints.
    virtual int joints() const noexcept = 0;

    /// False when there is no pose for these joints: keep the last pose, write zero effort, count it. Depends
    /// on the joints alone: what `pose` held before is no start value, so that the same joints give the same
    /// bits in a servo, a replay and a guardian.
    virtual bool forward(std::span<const double> joints, TipPose& pose,
                         Jacobian& jacobian) const noexcept = 0;
};

}  // namespace knurl::drivers
