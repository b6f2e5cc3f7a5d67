#pragma once

#include <algorithm>
#include <limits>

namespace knurl {

/// What the device and its rate allow, in world units: plain numbers, so that a representation can clamp
/// without knowing a device. The defaults are "no limit at all" (offline evaluation without a device).
struct Limits {
    /// Largest stiffness k_max (N/m): b / (T/2 + tau) (Colgate and Schenkel 1997), or as measured.
    double max_stiffness = std::numeric_limits<double>::infinity();
    /// Peak force of the device (N).
    double max_force = std::numeric_limits<double>::infinity();
    /// Peak torque of the device (N m).
    double max_torque = std::numeric_limits<double>::infinity();
    /// Largest torsional stiffness (N m/rad): b_rot / (T/2 + tau).
    double max_torsion = std::numeric_limits<double>::infinity();
    /// The device's own damping b (N s/m).
    double damping = 0;
    /// Apparent mass at the tip (kg); 0: not known.
    double mass = 0;
    /// Sum of all delays tau (s): actuator, transport.
    double lag = 0;
    /// Nominal period of the servo (s).
    double period = 1e-3;
    /// Resolution of the encoders at the tip (m); 0: exact.
    double resolution = 3e-5;
    /// Metres of the world that one metre of the device is (1). Lengths that mean the hand (how fast a
    /// surface rises, where a direction is rounded off) are the device's, and are converted by this.
    double metre = 1;
    /// Newtons of the world that one newton of the device is (1); as `metre`.
    double newton = 1;
};

/// Time over which a change reaches the hand if the application states none (s), by the interval between
/// updates (s): 20 % of it, within 2 to 50 ms, but never longer than the interval itself, or the hand would
/// always feel the past.
inline double automatic_fade(double interval) noexcept {
    return std::min(interval, std::clamp(0.2 * interval, 2e-3, 50e-3));
}

}  // namespace knurl
