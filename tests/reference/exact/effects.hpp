#pragma once
// Effects in closed form: forces and torques on one point of the hand.

#include "real.hpp"

namespace exact {

struct Twist {
    V force, torque;  // N, N m about the probe
};

/// The probe that an effect acts on.
struct Tip {
    V position;
    Turn orientation;
    V velocity, turning;  // m/s, rad/s
};

/// What a device allows; infinite stiffness: there is no device.
struct Device {
    Real stiffness = INFINITY, torsion = INFINITY;  // N/m, N m/rad
    Real mass = 0, lag = 0, period = 1e-3L;         // kg, s, s
    bool known() const { return std::isfinite(stiffness); }
    /// N s/m: m / (4 (T + tau + tau_f)), or 10 where the mass is not known.
    Real damping() const;
    Real angular_damping() const;
};

struct Spring {
    V anchor, attach;
    Real rest_length = 0, stiffness = 0, damping = 0;
};
/// F = k (1 - L0 / sqrt(l^2 + e^2)) d - b (v.u) u at the attached point, e = max(min(1 mm, L0 / 20), L0 k /
/// k_max); the torque scaled down where k |r| |a - p| exceeds the device's torsion.
Twist spring(const Spring& s, const Tip& tip, const Device& device);

/// A square matrix of up to six rows.
struct Matrix {
    int size = 3;
    Real at[6][6] = {};
};
/// The same with the eigenvalues of its symmetric part brought within [low, high] (Jacobi's rotations).
Matrix clamped(const Matrix& m, Real low, Real high);

/// A function of a length r at an edge, with its slope: the share of the energy that is left (1 up to `core`
/// of the edge, from there a smoothstep to 0), or the continuation of r^2 or r beyond a rim.
struct Edge {
    Real value, slope;
};
Edge faded(Real r, Real core, Real edge);
Edge held_square(Real r, Real edge);
Edge held_length(Real r, Real edge);

struct Taylor {
    V origin, force, torque;
    Turn orientation;
    Matrix jacobian;  // 3 x 3, or 6 x 6 with torque and rotation
    Real radius = 0, angle = 1;
    bool hold = false;
    // How far the device permits the edge: the core's share of the reach, and the size of the field.
    Real core = 0.8L;
    Real size = 0;  // the root of the sum of squares of the jacobian after that
};
Twist taylor(const Taylor& t, const Tip& tip, const Device& device);

struct Magnet {
    V position;
    Real radius = 0, stiffness = 0, max_force = 0, max_distance = 0, damping = 0;
};
V magnet(const Magnet& m, const Tip& tip, const Device& device);

enum class Held { point, line, plane };
V constraint(Held shape, const V& origin, const V& direction, Real stiffness, Real damping, const Tip& tip);

}  // namespace exact
