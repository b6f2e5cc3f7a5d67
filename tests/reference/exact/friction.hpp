#pragma once
// Friction by its definitions: elastic Coulomb, the passive snag, the paper's snag, viscous. Follows one tip
// along a path, and returns the force in each step.

#include <cstdint>

#include "real.hpp"

namespace exact {

struct Law {
    enum class Kind { coulomb, snag, paper } kind = Kind::coulomb;
    Real stiffness = 0;             // N/m of the anchor's spring; the paper's: 1/m, per normal force
    Real static_ = 0, dynamic = 0;  // per normal force
    Real viscous = 0;               // N s/m
    Real d_snap = 0, d_mean = 0, d_spread = 0;  // m
    std::uint64_t seed = 1;                     // of the distances between snags
    Real max_stiffness = INFINITY;              // N/m
    Real resolution = 0;                        // m, of the encoders
};

/// Where the tip can slide: perpendicular to `normal`, or in a corner along `line`.
struct Sliding {
    V normal, line;
    bool corner = false;
    V along(const V& v) const { return corner ? dot(v, line) * line : v - dot(v, normal) * normal; }
};

class Friction {
  public:
    /// The force (N) on a tip at x that presses with `normal_force`. dt = 0 leaves the state unchanged.
    V step(const Law& law, const Sliding& surface, const V& x, const V& velocity, const V& carried,
           Real normal_force, Real dt);

  private:
    struct State {
        bool held = false, sliding = false;
        V anchor, snag;
        Real farthest = 0, next = 0;  // m; `next`: from the last snag to the one that catches the tip
        std::uint64_t draws = 0;
    };
    static void draw_next(State& s, const Law& law);
    static V act(State& s, const Law& law, const Sliding& surface, const V& x, Real normal_force);
    State state_;
};

}  // namespace exact
