#pragma once
// Friction models from the literature: the force (N) on a tip that moves by dx (m) in a time dt (s) along a
// surface, pressed on with the normal force n (N). In three dimensions, as in the cycle.

#include <cmath>

#include <Eigen/Core>

namespace knurl::error {

/// Their common parameters, per N of normal force.
struct FrictionFigures {
    double static_ = 0.8, dynamic = 0.4;  // 1
    double stiffness = 800;               // 1/m, sigma_0
    double damping = 2;                   // s/m, sigma_1
    double stribeck = 0.01;               // m/s
};

/// z <- e^(-|dx|/g) z + g (1 - e^(-|dx|/g)) dx/|dx|: the exact solution of dz = dx - |dx| z / g for a
/// straight dx.
inline void bristle(Eigen::Vector3d& z, const Eigen::Vector3d& dx, double g) {
    const double way = dx.norm();
    if (!(way > 0)) return;
    const double left = std::exp(-way / g);
    z = left * z + (g * (1 - left) / way) * dx;
}

/// Dahl 1968.
struct Dahl {
    FrictionFigures f;
    Eigen::Vector3d z = Eigen::Vector3d::Zero();  // m

    Eigen::Vector3d operator()(const Eigen::Vector3d& dx, double n, double) {
        bristle(z, dx, f.dynamic / f.stiffness);
        return -n * f.stiffness * z;
    }
};

/// Canudas de Wit et al. 1995 (LuGre).
struct LuGre {
    FrictionFigures f;
    bool exact = true;                            // else explicit Euler
    Eigen::Vector3d z = Eigen::Vector3d::Zero();  // m

    Eigen::Vector3d operator()(const Eigen::Vector3d& dx, double n, double dt) {
        const double speed = dx.norm() / dt, ratio = speed / f.stribeck;
        const double g = (f.dynamic + (f.static_ - f.dynamic) * std::exp(-ratio * ratio)) / f.stiffness;
        const Eigen::Vector3d before = z;
        if (exact)
            bristle(z, dx, g);
        else
            z += dx - (speed * dt / g) * z;
        return -n * (f.stiffness * z + f.damping / dt * (z - before));
    }
};

/// Coulomb friction against the velocity (Adachi et al., VRAIS 95), smoothed as on every device (first order
/// 100 Hz).
struct VelocityCoulomb {
    FrictionFigures f;
    Eigen::Vector3d v = Eigen::Vector3d::Zero();  // m/s

    Eigen::Vector3d operator()(const Eigen::Vector3d& dx, double n, double dt) {
        const double share = dt / (dt + 1 / (2 * M_PI * 100));
        v += share * (dx / dt - v);
        const double speed = v.norm();
        return speed > 1e-4 ? Eigen::Vector3d(-n * f.dynamic / speed * v)
                            : Eigen::Vector3d(Eigen::Vector3d::Zero());
    }
};

}  // namespace knurl::error
