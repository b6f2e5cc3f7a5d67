// Magnets: their zero crossings, their ends, and the values they refuse. tests/reference/fields.cpp compares them
// with their formula.

#include <gtest/gtest.h>

#include <knurl/reps/describe.hpp>
#include <knurl/reps/magnet.hpp>

#include "effect_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

Magnet random_magnet(Rng& rng) {
    Magnet m{.position = to_plain((between(rng, 0, 5) ? 0.1 : 1e6) * direction(rng)),
             .radius = between(rng, 0, 1) ? 0 : scale(rng, 1e-6, 0.1),
             .stiffness = scale(rng, 1, 3000),
             .max_force = scale(rng, 0.01, 10),
             .damping = between(rng, 0, 1) ? 0 : scale(rng, 0.1, 10)};
    m.max_distance = m.max_force / m.stiffness * scale(rng, 1.01, 10);
    return m;
}

std::string refusal(const Magnet& m) {
    const KindInfo kind{.name = "magnet",
                        .fields = Describe<Magnet>::fields,
                        .size = sizeof m,
                        .geometry_bytes = sizeof m,
                        .surface = false,
                        .validate = nullptr,
                        .contradictions = Describe<Magnet>::contradictions};
    return describe(Describe<Magnet>::check(m), &kind, "");
}

}  // namespace

TEST(Magnet, PullsUpToItsStrongestThenLessAndEndsWhereItSays) {
    const Magnet m{.stiffness = 100, .max_force = 2, .max_distance = 0.05};
    EXPECT_NEAR(felt(m, at({0.01, 0, 0})).force.x(), -1, 1e-15);
    EXPECT_NEAR(felt(m, at({0.02, 0, 0})).force.x(), -2, 1e-15);
    EXPECT_NEAR(felt(m, at({0.035, 0, 0})).force.x(), -1, 1e-14);
    EXPECT_EQ(felt(m, at({0.05, 0, 0})).force.norm(), 0.0);
    EXPECT_EQ(felt(m, at({0, 1e12, 0})).force.norm(), 0.0);
}

TEST(Magnet, HasNoStepAnywhereAlsoNotAtItsSurfaceNorAtItsCentre) {
    // Through the middle of a small sphere, whose pull reaches its centre, and past it.
    const Limits limits{.max_stiffness = 2000};
    for (const double radius : {0.0, 0.003, 0.02}) {
        for (const double beside : {0.0, 1e-7, 1e-4}) {
            const Magnet m = prepared(
                Magnet{.radius = radius, .stiffness = 1000, .max_force = 3, .max_distance = 0.01}, limits);
            Magnet::State state;
            constexpr double step = 1e-6;
            Vector last = evaluate(m, state, at({-0.04, beside, 0}), dt).force;
            for (double x = -0.04 + step; x < 0.04; x += step) {
                const Vector force = evaluate(m, state, at({x, beside, 0}), dt).force;
                ASSERT_LE((force - last).norm(), 2000 * step * (1 + 1e-6))
                    << "radius " << radius << " x " << x;
                last = force;
            }
        }
    }
}

TEST(Magnet, WhoseReachEndsBeforeItsStrongestPullIsRefusedWithTheFigures) {
    EXPECT_EQ(refusal({.stiffness = 100, .max_force = 2, .max_distance = 0.015}),
              "magnet.max_distance = 0.015 m is not beyond max_force / stiffness = 0.02 m, where it pulls "
              "most; give "
              "more, or less max_force");
    EXPECT_FALSE(Describe<Magnet>::check({.stiffness = 100, .max_force = 2, .max_distance = 0.02}));
    EXPECT_TRUE(Describe<Magnet>::check({.stiffness = 100, .max_force = 2, .max_distance = 0.0201}));
    EXPECT_TRUE(Describe<Magnet>::check({.stiffness = 0, .max_force = 2, .max_distance = 0}))
        << "it does not pull";
    EXPECT_TRUE(Describe<Magnet>::check({.stiffness = infinity, .max_force = 2, .max_distance = 1e-6}));
}

TEST(Magnet, OnADeviceNeitherSideIsSteeperThanItAllows) {
    Rng rng(333);
    for (int i = 0; i < 3000; ++i) {
        Magnet m = random_magnet(rng);
        m.stiffness = between(rng, 0, 1) ? infinity : scale(rng, 1, 1e9);
        const double k_max = scale(rng, 10, 3000);
        const Magnet got = prepared(m, {.max_stiffness = k_max});
        ASSERT_LE(got.stiffness, k_max);
        const double strongest = got.max_force / got.stiffness;
        ASSERT_LT(strongest, got.max_distance);
        ASSERT_LE(got.max_force / (got.max_distance - strongest), k_max * (1 + 1e-9));
        ASSERT_LE(got.max_force, m.max_force);
    }
}
