#pragma once
// How stiff and how damped the hand feels a scene at the moment: what each representation adds, summed at the hand.

#include <Eigen/Core>

#include <knurl/reps/limits.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// J, of parts at full strength.
struct PartEnergy {
    double held = 0;   // what the hand can get out of them from here, at most
    double freed = 0;  // what of that a fade has taken away in this cycle, where the hand is

    PartEnergy& operator+=(const PartEnergy& other) noexcept {
        held += other.held;
        freed += other.freed;
        return *this;
    }
};
inline PartEnergy operator*(double scale, const PartEnergy& energy) noexcept {
    return {scale * energy.held, scale * energy.freed};
}

/// Symmetric, translation (m) before rotation (rad), world axes: how a wrench (N, N m) falls off with displacement
/// and with velocity. Where a representation pushes away, its stiffness is negative.
struct HandLoad {
    Matrix6 stiffness = Matrix6::Zero();  // N/m, N/rad, N m/rad
    Matrix6 damping = Matrix6::Zero();    // N s/m, N s/rad, N m s/rad
    PartEnergy energy = {};

    HandLoad& operator+=(const HandLoad& other) noexcept {
        stiffness += other.stiffness;
        damping += other.damping;
        energy += other.energy;
        return *this;
    }
};

inline HandLoad operator*(double scale, const HandLoad& load) noexcept {
    return {scale * load.stiffness, scale * load.damping, scale * load.energy};
}

/// The same in every direction, without rotation.
HandLoad isotropic_load(double stiffness, double damping) noexcept;

/// Of a load that acts at a point of the hand, `arm` (m, world axes) away from the point that is looked at.
HandLoad moved_by(const HandLoad& load, const Eigen::Vector3d& arm) noexcept;

/// N m/rad: what a force (N) that keeps its direction adds where its arm (m) turns with the hand. A pull outwards
/// restores, one inwards gives way.
Eigen::Matrix3d turned_force(const Eigen::Vector3d& arm, const Eigen::Vector3d& force) noexcept;

/// As shares of what the device stands: 1 is k_max (N/m) or kappa_max (N m/rad), and b_max = m / (4 (T + tau +
/// tau_f)) or b_max kappa_max / k_max. Dimensionless, so loads of differently scaled worlds add up. Where kappa_max
/// is not known nothing is said of rotation; where k_max is not known, nothing at all. Energy is the device's (J).
HandLoad as_shares(const HandLoad& load, const Limits& limits) noexcept;

}  // namespace knurl
