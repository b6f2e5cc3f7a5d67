#pragma once
// Sphere, capsule, cylinder and torus, solid and hollow, by their distances: as long as the nearest surface
// counts, and not that by which the probe came in.

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
    /// The tangent planes at once that hold a probe of that radius: the first is the nearest.
    std::vector<Foot> step(const Solid& solid, const V& probe, Real radius);
    Real doubt = INFINITY;  // m, by how little the last step's decisions were made
    bool deep = false;      // the last step came beyond half way to its core, or may have passed there

  private:
    Foot nearest(const Foot& foot, Real limit);
    Foot ring(const Solid& s, Real rho, Real z, Real reach, const V& out, const V& axis);
    V last_;
    Real step_ = 0, last_z_ = 0;  // m
    bool met_ = false;
};

}  // namespace exact
