#pragma once

#include <algorithm>
#include <limits>

namespace knurl {

/// What the device and its rate allow, in world units: plain numbers, so that a representation can clamp
/// without knowing a device. The defaults are "no limit at all" (offline evaluation without a device).
struct Limits {
    double max_stiffness = std::numeric_limits<double>::infinity();  // N/m: b / (T/2 + tau), or as measured
    double max_force = std::numeric_limits<double>::infinity();      // N, the device's peak
    double max_torque = std::numeric_limits<double>::infinity();     // N m
    double max_torsion = std::numeric_limits<double>::infinity();    // N m/rad: b_rot / (T/2 + tau)
    double damping = 0;                                              // N s/m, the device's own b
    double mass = 0;                                                 // kg at the tip; 0: not known
    double lag = 0;                                                  // s, everything late: tau
    double period = 1e-3;                                            // s, the servo's nominal dt
    double resolution = 3e-5;                                        // m, the encoders' at the tip; 0: exact
    // The world may be of another size than the device. Lengths and forces that mean the hand (how fast a
    // surface rises, where a direction is rounded off) are the device's, and become the world's by these.
    double metre = 1;   // m of the world that one metre of the device is
    double newton = 1;  // N of the world that one newton of the device is
};

/// Over how long a change reaches the hand where nobody says (s), by the interval between updates: 20 % of
/// it, within 2 to 50 ms; but never longer than the interval itself, or the hand would feel the past for
/// ever.
inline double automatic_fade(double interval) noexcept {
    return std::min(interval, std::clamp(0.2 * interval, 2e-3, 50e-3));
}

}  // namespace knurl
