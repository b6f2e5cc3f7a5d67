#pragma once
// The force on a probe that touches several surfaces at once. Tries all ways in which up to three tangent
// planes can hold the probe (Karush, Kuhn, Tucker) and in which up to four can contradict each other
// (Farkas), once per stiffness.

#include <span>
#include <vector>

#include "real.hpp"

namespace exact {

/// A surface's tangent plane, seen from the probe at p: x is free where normal . (x - p) >= -height.
struct Touch {
    V normal;         // unit
    Real height = 0;  // m, of the probe's surface
    Real stiffness = 0;
    Real damping = 0;
    V velocity;  // m/s, of the surface
};

/// One way to hold the nearest point: these weights (m) of these planes.
struct Holding {
    std::vector<int> plane;
    std::vector<Real> weight;
};

struct Nearest {
    V dx;                           // m, from the probe to the nearest free point
    std::vector<Holding> holdings;  // all that hold it there, up to rounding
    Real give = 0;                  // m, by which all planes had to give way
    Real sharpness = 1;             // sine of the smallest angle between planes that meet there
    Real residual = 0;              // m, of the conditions: the possible error of the reference itself
};

/// The nearest point that satisfies all planes; if there is none, all of them give way by the smallest amount
/// that leaves one. `rounding` (m): holdings that miss the conditions by no more than that count as well.
Nearest nearest_free(std::span<const Touch> planes, Real rounding = 0);

/// The smallest amount (m) by which all planes must give way to leave a point; negative: there is that much
/// room. -infinity: the planes do not enclose anything.
Real smallest_give(std::span<const Touch> planes);

struct Push {
    V force;                   // N
    Real least = 0, most = 0;  // N, |force| where several holdings damp differently
    Real undamped = 0;         // N, |force| before damping: below rounding x stiffness it has no direction
    V dx;                // m, of the softest layer: from the probe to the nearest point free of all planes
    Real give = 0;       // m, the largest of a layer
    Real sharpness = 1;  // the smallest of a layer
    Real stiffness = 0;  // N/m, of the stiffest plane
};

/// F = sum_j (k_j - k_(j-1)) dx_j, dx_j for the planes of stiffness k_j or more; damped along F, never
/// pulling. `rounding` (m) is that of the heights: where it decides which planes hold, `least` and `most`
/// cover all of them.
Push push(std::span<const Touch> touches, const V& velocity, Real rounding = 0);

/// Planes combined by sum, as in the paper and in VRPN: each gives max(0, k depth - b v.n) n.
V summed(std::span<const Touch> touches, const V& velocity);

}  // namespace exact
