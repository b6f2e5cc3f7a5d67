#pragma once
// Shared by the tests of friction: laws by name, and a tip with friction.

#include <gtest/gtest.h>

#include <knurl/reps/friction.hpp>

#include "random_planes.hpp"

namespace knurl::test {

using Vector = Eigen::Vector3d;

inline constexpr Limits free_limits{};
inline constexpr Snag snags{
    .k_kinetic = 0.4, .k_stick = 800, .d_snap = 1e-3, .d_mean = 5e-3, .d_spread = 2e-3};
inline constexpr Snag paper_snags{.k_kinetic = 0.4,
                                  .k_stick = 800,
                                  .d_snap = 1e-3,
                                  .d_mean = 5e-3,
                                  .d_spread = 2e-3,
                                  .law = SnagLaw::paper};

inline FrictionLaw coulomb(double static_, double dynamic, double stiffness = 1000) {
    return friction_law({.static_ = static_, .dynamic = dynamic}, {}, stiffness, free_limits);
}
inline FrictionLaw snag_law(const Snag& snag) {
    return friction_law({}, snag, 1000, free_limits);
}

inline Rubbing rubbing_at(const Vector& position, double normal_force = 1) {
    Rubbing rubbing;
    rubbing.position = position;
    rubbing.normal_force = normal_force;
    return rubbing;
}

/// A tip with one friction law, on a floor unless stated otherwise.
struct Tip {
    FrictionLaw law;
    Limits limits = free_limits;
    Tangent tangent = {};
    FrictionState state = {};

    Vector go(const Vector& position, double normal_force = 1, double dt = 1e-3) {
        return friction_force(law, state, tangent, rubbing_at(position, normal_force), limits, dt);
    }
    double go(double x, double normal_force = 1, double dt = 1e-3) {
        return go(Vector(x, 0, 0), normal_force, dt).x();
    }
};

}  // namespace knurl::test
