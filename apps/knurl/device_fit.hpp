#pragma once
// Mass, damping, dry friction and delay of a tip along one axis, from a motion and the force that made it.

#include <vector>

namespace knurl::cli {

/// A motion along one axis. The force of a sample acts from its time to that of the next.
struct Motion1 {
    double period = 1e-3;          // s
    std::vector<double> position;  // m
    std::vector<double> force;     // N, as ordered
};

struct Fit {
    double mass = 0;      // kg
    double damping = 0;   // N s/m
    double friction = 0;  // N, dry
    double lag = 0;       // s, from the order to the force
    double residual = 0;  // m kg, rms: of the twice integrated balance of forces
    double moved = 0;     // m, between the outermost places
};

/// Fits m x'' + b x' + c sign(x') + g = F(t - lag), integrated twice, so that no position is differentiated: linear in
/// m, b, c, the constant force and the two constants of integration; the delay is searched for.
Fit fit(const Motion1& motion);

}  // namespace knurl::cli
