#pragma once
// The theory of a wall under a servo.

#include "conditions.hpp"

namespace stability {

/// k < b / (T/2 + tau), N/m: b physical damping, tau everything late. Colgate & Brown (ICRA 1994) for the
/// form.
double bound(const Conditions& conditions);

/// The stiffness (N/m) at which the linear loop (no dry friction, no encoder, always in contact) has an
/// eigenvalue of modulus 1: the same device, hand, filter and actuator as the simulation, as one matrix per
/// cycle.
double eigenvalue_limit(const Conditions& conditions);

}  // namespace stability
