#include "sim/arm.hpp"

#include <algorithm>

namespace knurl::drivers {

Arm::Arm(const SimProfile& profile)
    : mechanism_(*profile.mechanism),
      n_(profile.joints),
      mass_(profile.mass),
      rotational_inertia_(profile.rotational_inertia),
      joint_inertia_(profile.joint_inertia),
      coulomb_(profile.coulomb),
      q_(JointVector::Zero(n_)),
      rates_(JointVector::Zero(n_)),
      jacobian_(TipJacobian::Zero(6, n_)),
      inertia_(n_) {
    wide_.setZero();
    place(profile.centre, {});
}

void Arm::place(const JointArray& joints, const JointArray& rates) noexcept {
    for (Eigen::Index i = 0; i < n_; ++i) {
        q_[i] = joints[static_cast<std::size_t>(i)];
        rates_[i] = rates[static_cast<std::size_t>(i)];
    }
    refresh();
    twist_ = jacobian_ * rates_;
    motor_force_.setZero();
}

bool Arm::refresh() noexcept {
    if (!mechanism_.forward({q_.data(), static_cast<std::size_t>(n_)}, pose_, wide_)) {
        return false;
    }
    jacobian_ = wide_.leftCols(n_);
    return true;
}

Arm::Twist Arm::weighted(const Twist& twist) const noexcept {
    Twist momentum;
    momentum << mass_ * twist.head<3>(), rotational_inertia_ * twist.tail<3>();
    return momentum;
}

void Arm::step(double h, const JointVector& efforts, const Wrench& tip) noexcept {
    JointMatrix m(n_, n_);
    m.noalias() = mass_ * jacobian_.topRows<3>().transpose() * jacobian_.topRows<3>();
    m.noalias() += rotational_inertia_ * jacobian_.bottomRows<3>().transpose() * jacobian_.bottomRows<3>();
    m.diagonal().array() += joint_inertia_;
    inertia_.compute(m);
    const JointVector acceleration = inertia_.solve(efforts);
    motor_force_.noalias() = mass_ * (jacobian_.topRows<3>() * acceleration);

    JointVector momentum(n_);
    momentum.noalias() = jacobian_.transpose() * (weighted(twist_) + h * tip);
    momentum += joint_inertia_ * rates_ + h * efforts;
    rates_ = inertia_.solve(momentum);

    // Dry friction, implicit: an impulse that slows the tip, at most to rest. So the tip can stick.
    Eigen::Vector3d velocity = jacobian_.topRows<3>() * rates_;
    const double speed = velocity.norm();
    if (coulomb_ > 0 && speed > 0) {
        const double slower = std::min(speed, h * coulomb_ / mass_);
        JointVector impulse(n_);
        impulse.noalias() = jacobian_.topRows<3>().transpose() * (velocity * (-mass_ * slower / speed));
        rates_ += inertia_.solve(impulse);
    }
    twist_.noalias() = jacobian_ * rates_;
    const JointVector before = q_;
    q_ += h * rates_;
    if (!refresh()) {
        // The legs of a delta cannot separate: a stop without rebound, at the last place where they met.
        q_ = before;
        rates_.setZero();
        twist_.setZero();
    }
}

double Arm::kinetic_energy() const noexcept {
    return 0.5 * (twist_.dot(weighted(twist_)) + joint_inertia_ * rates_.squaredNorm());
}

}  // namespace knurl::drivers
