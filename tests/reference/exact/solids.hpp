#pragma once
// Sphere, capsule, cylinder and torus, solid and hollow, by their distance functions. Valid as long as the
// nearest surface determines the contact, and not the one by which the probe came in.

#include <vector>

#include "cap.hpp"

namespace exact {

struct Solid {
    enum class Kind { sphere, capsule, cylinder, torus } kind = Kind::sphere;
    V center, axis = {0, 0, 1};
    Real radius = 0, half_length = 0, tube = 0;  // m
    bool hollow = false;
};

class SolidTouch {
  public:
    /// The tangent planes that together hold a probe of that radius; the first is the nearest.
    std::vector<Foot> step(const Solid& solid, const V& probe, Real radius);
    Real doubt = INFINITY;  // m, the smallest margin of the last step's decisions
    bool deep = false;      // the last step came deeper than half way to the core, or may have on its way

  private:
    Foot nearest(const Foot& foot, Real limit);
    Foot ring(const Solid& s, Real rho, Real z, Real reach, const V& out, const V& axis);
    V last_;
    Real step_ = 0, last_z_ = 0;  // m
    bool met_ = false;
};

}  // namespace exact
