#pragma once

/// @file
/// Any serial arm from a table: Denavit-Hartenberg rows, and how the motors are coupled to them.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <knurl/drivers/link_config.hpp>
#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// One row in the standard (distal) convention, T = Rz(theta) Tz(d) Tx(a) Rx(alpha): Denavit & Hartenberg
/// 1955, as in Spong, Hutchinson & Vidyasagar, "Robot Modeling and Control", section 3.2. The joint's
/// variable is added to theta (to d if prismatic).
struct DhRow {
    /// Rotation about z (rad).
    double theta = 0;
    /// Translation along z (m).
    double d = 0;
    /// Translation along x (m).
    double a = 0;
    /// Rotation about x (rad).
    double alpha = 0;
    /// True: the joint slides along z.
    bool prismatic = false;
};

/// A serial arm: rows, and how the motors are coupled to them.
struct SerialChainTable {
    /// 1 to max_joints rows, from the base outwards.
    std::vector<DhRow> rows;
    /// theta_DH = A q_motor (+ the row's own theta). Rows alone do not describe a PHANToM, whose
    /// parallelogram measures both arm angles from the base. Empty: the identity.
    Eigen::MatrixXd coupling = {};
    /// Frame of row 0 in the device frame.
    Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
    /// Frame of the tip in the last row's frame.
    Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
    /// True: the hand holds the tip through a passive gimbal, so no orientation is known and no torque gets
    /// through. The pose then has the identity's orientation and the Jacobian zero angular rows.
    bool position_only = false;

    /// What is added to theta (or d) of row `row` in a posture: that row of A q.
    double variable(std::size_t row, std::span<const double> motors) const;
};

/// Joints are the MOTORS: the Jacobian is J_DH A, so that tau_motor = J^T F as it stands. Bounded by
/// max_joints, nothing allocated after construction.
class SerialChain final : public Mechanism {
  public:
    /// Throws std::runtime_error: no or too many rows, numbers that are not finite, a link longer than 10 m
    /// (millimetres?), a coupling of wrong size or singular.
    explicit SerialChain(const SerialChainTable& table);

    /// Number of motors.
    int joints() const noexcept override { return static_cast<int>(count_); }

    /// False if a joint is not finite or too few are given.
    bool forward(std::span<const double> joints, TipPose& pose, Jacobian& jacobian) const noexcept override;

  private:
    struct Row {
        double theta, d, a, cos_alpha, sin_alpha;
        bool prismatic;
    };

    std::size_t count_;
    std::array<Row, max_joints> rows_ = {};
    std::array<std::array<double, max_joints>, max_joints> coupling_ = {};  // [row][motor]
    bool coupled_;
    bool position_only_;
    Eigen::Matrix3d base_rotation_, tool_rotation_;
    Eigen::Vector3d base_position_, tool_position_;
};

}  // namespace knurl::drivers
