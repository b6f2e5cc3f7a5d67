#pragma once
// One simulated stroke: the scene of reps/ and the client's prediction, on a device and a hand of a few
// equations.

#include "judge.hpp"

namespace stability {

/// 8 s with the surface's stiffness in N/m. Stops early once one of `criteria` is broken, unless `measure`.
/// The seed changes what no application controls: where on the surface and on the encoders' grid the stroke
/// begins, and when the application reads first. Equal arguments give equal bits.
Figures stroke(const Conditions& conditions, double stiffness, unsigned seed, unsigned criteria,
               bool measure = false);

/// The values of a seed, each 0 to 1.
struct Chance {
    double place, phase, grid_x, grid_z, drop;
    explicit Chance(unsigned seed);
};

}  // namespace stability
