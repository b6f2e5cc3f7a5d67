#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include <knurl/reps/hand_budget.hpp>

#include "clamped.hpp"

namespace knurl {

HandLoad isotropic_load(double stiffness, double damping) noexcept {
    HandLoad load;
    load.stiffness.topLeftCorner<3, 3>().diagonal().setConstant(stiffness);
    load.damping.topLeftCorner<3, 3>().diagonal().setConstant(damping);
    return load;
}

// The hand's displacement (x, theta) displaces the point by x + theta cross arm, and a force there has the moment
// arm cross force: K -> T^T K T.
HandLoad moved_by(const HandLoad& load, const Eigen::Vector3d& arm) noexcept {
    Matrix6 t = Matrix6::Identity();
    t.topRightCorner<3, 3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    return {t.transpose() * load.stiffness * t, t.transpose() * load.damping * t};
}

HandLoad as_shares(const HandLoad& load, const Limits& limits) noexcept {
    HandLoad shares;
    if (!std::isfinite(limits.max_stiffness) || !(limits.max_stiffness > 0)) return shares;
    const auto scaled = [&](const Matrix6& matrix, double translation, double rotation) {
        if (!(translation > 0)) return Matrix6(Matrix6::Zero());
        Eigen::Matrix<double, 6, 1> unit;
        unit.head<3>().setConstant(1 / std::sqrt(translation));
        unit.tail<3>().setConstant(std::isfinite(rotation) && rotation > 0 ? 1 / std::sqrt(rotation) : 0);
        return Matrix6(unit.asDiagonal() * matrix * unit.asDiagonal());
    };
    const double b = largest_damping(limits), torsion = limits.max_torsion;
    shares.stiffness = scaled(load.stiffness, limits.max_stiffness, torsion);
    shares.damping = scaled(load.damping, b, b * (torsion / limits.max_stiffness));
    return shares;
}

double largest_eigenvalue_above_1(const Matrix6& matrix) noexcept {
    if (!(matrix.squaredNorm() > 1)) return 1;  // Frobenius: no eigenvalue is larger than its root
    if (matrix.bottomRightCorner<3, 3>().isZero(0)) {
        using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;
        const Eigen::Matrix3d part = matrix.topLeftCorner<3, 3>();
        return std::max(1.0, Solver(part, Eigen::EigenvaluesOnly).eigenvalues().z());
    }
    return std::max(1.0,
                    Eigen::SelfAdjointEigenSolver<Matrix6>(matrix, Eigen::EigenvaluesOnly).eigenvalues()(5));
}

void HandBudget::advance(const HandLoad& shares, double dt) noexcept {
    ++computed_;
    move(1 / largest_eigenvalue_above_1(shares.stiffness), 1 / largest_eigenvalue_above_1(shares.damping),
         dt);
}

void HandBudget::advance_within(double dt) noexcept {
    if (!rests()) move(1, 1, dt);
}

void HandBudget::move(double stiffness, double damping, double dt) noexcept {
    if (!(dt > 0)) return;
    const auto slewed = [&](double scale, double target) {
        return std::clamp(target, scale * std::max(0.0, 1 - dt / fall_time), scale * (1 + dt / rise_time));
    };
    stiffness_ = slewed(stiffness_, stiffness);
    damping_ = slewed(damping_, damping);
}

}  // namespace knurl
