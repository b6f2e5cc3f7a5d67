#pragma once

/// @file
/// How stiff and how damped the hand feels a scene at the moment: what each representation adds, summed at
/// the hand.

#include <Eigen/Core>

#include <knurl/reps/limits.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

/// 6 x 6: translation before rotation.
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Energy of parts at full strength (J).
struct PartEnergy {
    /// Most that the hand can get out of them from here (J).
    double held = 0;
    /// What of that a fade has taken away in this cycle, where the hand is (J).
    double freed = 0;

    /// Adds another part's energy.
    PartEnergy& operator+=(const PartEnergy& other) noexcept {
        held += other.held;
        freed += other.freed;
        return *this;
    }
};
/// The energy at that scale.
inline PartEnergy operator*(double scale, const PartEnergy& energy) noexcept {
    return {scale * energy.held, scale * energy.freed};
}

/// Symmetric, translation (m) before rotation (rad), world axes: how a wrench (N, N m) falls off with
/// displacement and with velocity. Where a representation pushes away, its stiffness is negative.
struct HandLoad {
    /// Stiffness (N/m, N/rad, N m/rad).
    Matrix6 stiffness = Matrix6::Zero();
    /// Damping (N s/m, N s/rad, N m s/rad).
    Matrix6 damping = Matrix6::Zero();
    /// Energy that the hand can get out of it.
    PartEnergy energy = {};

    /// Adds another load.
    HandLoad& operator+=(const HandLoad& other) noexcept {
        stiffness += other.stiffness;
        damping += other.damping;
        energy += other.energy;
        return *this;
    }
};

/// The load at that scale.
inline HandLoad operator*(double scale, const HandLoad& load) noexcept {
    return {scale * load.stiffness, scale * load.damping, scale * load.energy};
}

/// A load that is the same in every direction, without rotation. Stiffness in N/m, damping in N s/m.
HandLoad isotropic_load(double stiffness, double damping) noexcept;

/// The load seen from another point. It acts at a point of the hand `arm` (m, world axes) away from the point
/// that is looked at.
HandLoad moved_by(const HandLoad& load, const Eigen::Vector3d& arm) noexcept;

/// Stiffness (N m/rad) that a force (N) of constant direction adds where its arm (m) turns with the hand. A
/// pull outwards restores, one inwards gives way.
Eigen::Matrix3d turned_force(const Eigen::Vector3d& arm, const Eigen::Vector3d& force) noexcept;

/// As shares of what the device stands: 1 is k_max (N/m) or kappa_max (N m/rad), and b_max = m / (4 (T + tau
/// + tau_f)) or b_max kappa_max / k_max. Dimensionless, so loads of differently scaled worlds add up. Where
/// kappa_max is not known nothing is said of rotation; where k_max is not known, nothing at all. Energy is
/// the device's (J).
HandLoad as_shares(const HandLoad& load, const Limits& limits) noexcept;

}  // namespace knurl
