#pragma once
// The same stroke through the real servo: Servo::step, its batches, supervisor and kinematics, a SimDevice
// with joints, encoders at the joints, a converter of 12 bits, and the simulated hand of drivers/.

#include <string>

#include "judge.hpp"

namespace stability {

/// Uses the conditions' servo, application, surface, stroke and method, grip and push; the device is
/// `profile`'s. Back and forth (conditions.reach > 0), since its workspace requires that.
Figures servo_stroke(const std::string& profile, const Conditions& conditions, double stiffness,
                     unsigned seed, unsigned criteria, bool measure = false);

/// The conditions with the profile's own figures instead of the device's, for the bound.
Conditions with_profile(const std::string& profile, Conditions conditions);

}  // namespace stability
