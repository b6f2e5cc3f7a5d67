#pragma once
// Sphere, capsule, cylinder and torus, solid and hollow, by their distances; a solid keeps the normal that it
// had beyond half way to its core.

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

  private:
    template <class Over>
    Foot guarded(const Foot& foot, Real core, Over&& over);
    Foot ring(const Solid& s, Real rho, Real z, Real reach, const V& out, const V& axis);
    V normal_;
    Real clear_ = INFINITY;
    bool deep_ = false, on_seat_ = false;
};

}  // namespace exact
