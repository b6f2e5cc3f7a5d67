#pragma once
// Any serial arm from a table: Denavit-Hartenberg rows, and how the motors are coupled to them.

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
    double theta = 0;  // rad
    double d = 0;      // m
    double a = 0;      // m
    double alpha = 0;  // rad
    bool prismatic = false;
};

struct SerialChainTable {
    std::vector<DhRow> rows;  // 1 to max_joints, from the base outwards
    /// theta_DH = A q_motor (+ the row's own theta). Rows alone do not describe a PHANToM, whose
    /// parallelogram measures both arm angles from the base. Empty: the identity.
    Eigen::MatrixXd coupling = {};
    Eigen::Isometry3d base = Eigen::Isometry3d::Identity();  // row 0's frame in the device frame
    Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();  // the tip in the last row's frame
    /// The hand holds the tip through a passive gimbal: no orientation is known and no torque gets through.
    /// The pose then has the identity's orientation and the Jacobian zero angular rows.
    bool position_only = false;

    /// What is added to row `row`'s theta (or d) in a posture: that row of A q.
    double variable(std::size_t row, std::span<const double> motors) const;
};

/// Joints are the MOTORS: the Jacobian is J_DH A, so that tau_motor = J^T F as it stands. Bounded by
/// max_joints, nothing allocated after construction.
class SerialChain final : public Mechanism {
  public:
    /// Throws std::runtime_error: no or too many rows, numbers that are not finite, a link longer than 10 m
    /// (millimetres?), a coupling of wrong size or singular.
    explicit SerialChain(const SerialChainTable& table);

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
