#pragma once
// The same stroke through the real thing: Servo::step, its batches, supervisor and kinematics, a SimDevice
// with joints, encoders at the joints, a converter of 12 bits, and the simulated hand of drivers/.

#include <string>

#include "judge.hpp"

namespace stability {

/// Of the conditions, those of the servo, application, surface, stroke and method count, and grip and push;
/// the device is `profile`'s. To and fro (conditions.reach > 0), as its workspace asks for.
Figures servo_stroke(const std::string& profile, const Conditions& conditions, double stiffness,
                     unsigned seed, unsigned criteria, bool measure = false);

/// The conditions with the profile's own figures instead of the device's, for the bound.
Conditions with_profile(const std::string& profile, Conditions conditions);

}  // namespace stability
