#pragma once
// Dynamics of an arm in joint space with its mass at the tip, one sub-step at a time.

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/sim_profile.hpp>

namespace knurl::drivers {

/// The arm is a tip of mass m (with rotational inertia), constrained by joints with small inertias: M(q) =
/// J^T diag(m, I) J + I_joint. Coriolis forces need no derivative of J: momentum is carried over a sub-step
/// as the tip's velocity, p = J_new^T diag(m, I) (J_old q') + I_joint q'. That projects the old velocity onto
/// the new posture in the metric of the masses. It can remove energy but never add any; with a square J and
/// no joint inertia it is a free mass at the tip.
class Arm {
  public:
    using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_joints, 1>;
    using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_joints, max_joints>;
    using TipJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, max_joints>;
    using Twist = Eigen::Matrix<double, 6, 1>;   // linear, angular
    using Wrench = Eigen::Matrix<double, 6, 1>;  // force, torque

    explicit Arm(const SimProfile& profile);

    void place(const JointArray& joints, const JointArray& rates) noexcept;
    void set_mass(double mass) noexcept { mass_ = mass; }  // kg, device and finger

    /// Advances by h s under these efforts and this wrench on the tip; the arm adds its own dry friction.
    void step(double h, const JointVector& efforts, const Wrench& tip) noexcept;

    /// N, the last step's efforts at the tip, as a held tip feels them (J^-T tau if J is square).
    const Eigen::Vector3d& motor_force() const noexcept { return motor_force_; }
    double kinetic_energy() const noexcept;

    Eigen::Index joints() const noexcept { return n_; }
    const JointVector& position() const noexcept { return q_; }
    const JointVector& rates() const noexcept { return rates_; }
    const TipPose& pose() const noexcept { return pose_; }
    const Twist& twist() const noexcept { return twist_; }

  private:
    bool refresh() noexcept;  // false, without a change: the joints have no pose
    Twist weighted(const Twist& twist) const noexcept;

    const Mechanism& mechanism_;
    Eigen::Index n_;
    double mass_, rotational_inertia_, joint_inertia_, coulomb_;
    JointVector q_, rates_;
    TipPose pose_;
    Jacobian wide_;
    TipJacobian jacobian_;
    Twist twist_ = Twist::Zero();  // of the tip, after the last sub-step
    Eigen::Vector3d motor_force_ = Eigen::Vector3d::Zero();
    Eigen::LLT<JointMatrix> inertia_;
};

}  // namespace knurl::drivers
