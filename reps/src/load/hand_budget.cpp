#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <knurl/reps/hand_budget.hpp>

#include "scene/clamped.hpp"

namespace knurl {

HandLoad isotropic_load(double stiffness, double damping) noexcept {
    HandLoad load;
    load.stiffness.topLeftCorner<3, 3>().diagonal().setConstant(stiffness);
    load.damping.topLeftCorner<3, 3>().diagonal().setConstant(damping);
    return load;
}

// The hand's displacement (x, theta) displaces the point by x + theta cross arm, and a force there has the
// moment arm cross force: K -> T^T K T.
HandLoad moved_by(const HandLoad& load, const Eigen::Vector3d& arm) noexcept {
    Matrix6 t = Matrix6::Identity();
    t.topRightCorner<3, 3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    HandLoad moved{.stiffness = t.transpose() * load.stiffness * t, .energy = load.energy};
    if (!load.damping.isZero(0)) moved.damping = t.transpose() * load.damping * t;
    return moved;
}

// The symmetric part of -d((theta x a) x F)/dtheta = (a . F) - a F^T.
Eigen::Matrix3d turned_force(const Eigen::Vector3d& arm, const Eigen::Vector3d& force) noexcept {
    return arm.dot(force) * Eigen::Matrix3d::Identity() -
           0.5 * (arm * force.transpose() + force * arm.transpose());
}

HandLoad as_shares(const HandLoad& load, const Limits& limits) noexcept {
    HandLoad shares;
    if (!std::isfinite(limits.max_stiffness) || !(limits.max_stiffness > 0)) return shares;
    const auto scaled = [&](const Matrix6& matrix, double translation, double rotation) {
        if (!(translation > 0) || matrix.isZero(0)) return Matrix6(Matrix6::Zero());
        Eigen::Matrix<double, 6, 1> unit;
        unit.head<3>().setConstant(1 / std::sqrt(translation));
        unit.tail<3>().setConstant(std::isfinite(rotation) && rotation > 0 ? 1 / std::sqrt(rotation) : 0);
        return Matrix6(unit.asDiagonal() * matrix * unit.asDiagonal());
    };
    const double b = largest_damping(limits), torsion = limits.max_torsion;
    shares.stiffness = scaled(load.stiffness, limits.max_stiffness, torsion);
    shares.energy = 1 / (limits.metre * limits.newton) * load.energy;
    shares.damping = scaled(load.damping, b, b * (torsion / limits.max_stiffness));
    return shares;
}

namespace {

double largest_eigenvalue(const Matrix6& matrix) noexcept {
    if (matrix.bottomRightCorner<3, 3>().isZero(0)) {
        using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;
        const Eigen::Matrix3d part = matrix.topLeftCorner<3, 3>();
        return Solver(part, Eigen::EigenvaluesOnly).eigenvalues().z();
    }
    return Eigen::SelfAdjointEigenSolver<Matrix6>(matrix, Eigen::EigenvaluesOnly).eigenvalues()(5);
}

}  // namespace

double largest_eigenvalue_above_1(const Matrix6& matrix) noexcept {
    if (!(matrix.squaredNorm() > 1)) return 1;  // Frobenius: no eigenvalue is larger than its root
    return std::max(1.0, largest_eigenvalue(matrix));
}

SceneLoad& SceneLoad::operator+=(const SceneLoad& other) noexcept {
    contacts += other.contacts;
    effects += other.effects;
    damping += other.damping;
    in_contacts += other.in_contacts;
    in_effects += other.in_effects;
    surfaces = surfaces || other.surfaces;
    return *this;
}

SceneLoad operator*(double gain, const SceneLoad& load) noexcept {
    return {gain * load.contacts,    gain * load.effects,    gain * load.damping,
            gain * load.in_contacts, gain * load.in_effects, load.surfaces};
}

LoadBound& LoadBound::operator+=(const LoadBound& other) noexcept {
    contacts += other.contacts;
    effects += other.effects;
    damping += other.damping;
    surfaces = surfaces || other.surfaces;
    return *this;
}

bool LoadBound::exceeds() const noexcept {
    constexpr double most = 1 + 1e-9;
    return contacts + effects > most || damping > most ||
           (surfaces && effects > HandBudget::effects_share * most);
}

namespace {

// The largest s <= 1 for which no eigenvalue of `taken` + s `contacts` is above 1: with L L^T = 1 - `taken`,
// it is 1 / lambda_max(L^-1 contacts L^-T).
double contacts_left(const Matrix6& taken, const Matrix6& contacts) noexcept {
    if (contacts.isZero(0)) return 1;
    if (taken.isZero(0)) return 1 / largest_eigenvalue_above_1(contacts);
    const Matrix6 left = Matrix6::Identity() - taken;
    const Eigen::LLT<Matrix6> root(left);
    if (root.info() != Eigen::Success) return 0;
    Matrix6 seen = root.matrixL().solve(contacts);
    seen = root.matrixL().solve(seen.transpose().eval());
    return 1 / largest_eigenvalue_above_1(0.5 * (seen + seen.transpose()));
}

}  // namespace

void HandBudget::advance(const SceneLoad& load, double spent, double dt) noexcept {
    const double share = load.surfaces ? effects_share : 1;
    HandScales targets;
    targets.effects = 1 / largest_eigenvalue_above_1(load.effects / share);
    targets.contacts = contacts_left(targets.effects * load.effects, load.contacts);
    targets.damping = 1 / largest_eigenvalue_above_1(load.damping);
    if (!(dt > 0)) return;
    HandScales next = slewed(targets, dt);
    if (std::isfinite(dt)) pay(next, load, spent);
    scales_ = next;
}

HandScales HandBudget::slewed(const HandScales& targets, double dt) const noexcept {
    constexpr double least = 1e-6;  // scenes divide by them
    const auto slew = [&](double scale, double target) {
        return std::clamp(std::max(least, target), scale * std::max(0.0, 1 - dt / fall_time),
                          scale * (1 + dt / rise_time));
    };
    return {slew(scales_.contacts, targets.contacts), slew(scales_.effects, targets.effects),
            slew(scales_.damping, targets.damping)};
}

namespace {

// J that the hand receives when the scales rise from `from` to `to`.
double cost(const HandScales& from, const HandScales& to, const SceneLoad& load) noexcept {
    return std::max(0.0, to.effects - from.effects) * load.in_effects.held +
           std::max(0.0, to.contacts - from.contacts) * load.in_contacts.held;
}

}  // namespace

// With E = m v^2 / 2 + s V: the energy that a rising scale adds must have been taken from the hand before.
void HandBudget::pay(HandScales& next, const SceneLoad& load, double spent) noexcept {
    if (!(cost(scales_, next, load) > 0)) {  // nothing waits
        tank_ = 0;
        return;
    }
    const double used = largest_eigenvalue(scales_.contacts * load.contacts + scales_.effects * load.effects);
    tank_ += scales_.contacts * load.in_contacts.freed + scales_.effects * load.in_effects.freed +
             spent_share * (1 - used) * spent;
    tank_ = std::clamp(tank_, 0.0, cost(scales_, {}, load));  // more would never be spent
    const auto rise = [this](double from, double& to, double held) {
        const double costs = std::max(0.0, to - from) * held;
        if (costs > tank_) to = from + tank_ / held;
        tank_ = std::max(0.0, tank_ - costs);
        if (to > 1 - 1e-9) to = 1;  // removes rounding
    };
    rise(scales_.effects, next.effects, load.in_effects.held);
    rise(scales_.contacts, next.contacts, load.in_contacts.held);
}

}  // namespace knurl
