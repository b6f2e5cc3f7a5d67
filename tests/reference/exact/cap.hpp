#pragma once
// The rimmed cap as a signed distance: arcs of circles up to the rim, tangents beyond.

#include "real.hpp"

namespace exact {

/// What a surface answers to a point: the tangent plane's normal, towards free space, and the height over it.
struct Foot {
    V normal;
    Real height = 0;  // m
    Real clear = 1;   // m, from the nearest place without a normal (centre, axis)
};

struct Cap {
    V foot, normal;
    Real curvature = 0, curvature2 = 0;  // 1/m, positive: hollow
    V axis;                              // of any length, of `curvature`; 0 0 0: one curvature
    Real rim = 0;                        // sine
};
/// `radius` (m) of the probe: it feels no hollow tighter than 1 / (2 radius).
Foot cap(const Cap& c, const V& probe, Real radius);

}  // namespace exact
