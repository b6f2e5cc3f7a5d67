// Springs: their middle, anchors that move, fades. tests/reference/springs.cpp compares them with their formula.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

constexpr RepresentationId id{0, 1};

}  // namespace

TEST(Spring, HasNoJumpAtLengthZeroAndIsNowhereStifferThanAllowed) {
    // Without the rounding the force jumps by 2 k L0 = 60 N as the probe passes the anchor.
    const Limits limits{.max_stiffness = 2000};
    for (const double k : {20.0, 200.0, 1500.0, 2000.0}) {
        Spring::State state;
        const Spring spring = prepared(Spring{.rest_length = 0.05, .stiffness = k}, limits);
        adopt(spring, nullptr, state, {});
        constexpr double step = 1e-6;
        // Pushing out from the middle: at most k (L0 / e - 1), e the larger of 1 mm and L0 k / k_max.
        const double largest = std::min(limits.max_stiffness, k * (0.05 / 1e-3));
        Vector last = evaluate(spring, state, at({-0.003, 1e-7, 0}), dt).force;
        for (double x = -0.003 + step; x < 0.003; x += step) {
            const Vector force = evaluate(spring, state, at({x, 1e-7, 0}), dt).force;
            ASSERT_LE((force - last).norm(), largest * step * (1 + 1e-6)) << "k " << k << " x " << x;
            last = force;
        }
    }
}

TEST(Spring, AtItsAnchorItIsSilent) {
    Spring::State state;
    const Spring spring = prepared(Spring{.stiffness = 100, .damping = 3}, Limits{});
    adopt(spring, nullptr, state, {});
    const Wrench w = evaluate(spring, state, at({0, 0, 0}, {1, 2, 3}), dt);
    EXPECT_EQ(w.force.norm(), 0.0);
}

TEST(Spring, ARestLengthOfNextToNothingIsNone) {
    for (const double rest : {1e-300, 1e-200, 1e-160, 1e-100, 1e-20}) {
        Spring::State state;
        const Spring spring = prepared(Spring{.rest_length = rest, .stiffness = 100}, Limits{});
        adopt(spring, nullptr, state, {});
        EXPECT_EQ(evaluate(spring, state, at({0, 0, 0}), dt).force.norm(), 0.0) << rest;
        EXPECT_NEAR(evaluate(spring, state, at({0, 0, -0.01}), dt).force.z(), 1, 1e-12) << rest;
    }
}

TEST(Spring, StiffnessFadesWhileTheAnchorMoves) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(id, Spring{.anchor = {0.1, 0, 0}, .stiffness = 100, .duration = 0.02}));
    settled(scene, {});
    ASSERT_TRUE(scene.update(id, Spring{.anchor = {0.2, 0, 0}, .stiffness = 300, .duration = 0.02}));
    for (int i = 1; i <= 25; ++i) {
        const double s = std::min(1.0, i / 20.0);
        EXPECT_NEAR(scene.evaluate({}, dt).force.x(), (100 + 200 * s) * (0.1 + 0.1 * s), 1e-11)
            << "cycle " << i;
    }
}

TEST(Spring, AnAnchorThatMovesOnDuringTheFadeInDoesNotRestartIt) {
    Scene scene = make_scene();
    Spring spring{.anchor = {0.1, 0, 0}, .stiffness = 100, .duration = 0.02};
    ASSERT_TRUE(scene.add(id, spring));
    for (int i = 1; i <= 10; ++i) EXPECT_NEAR(scene.evaluate({}, dt).force.x(), 10 * i / 20.0, 1e-12);
    spring.anchor.y = 0.1;
    ASSERT_TRUE(scene.update(id, spring));
    for (int i = 1; i <= 25; ++i) {
        const Vector force = scene.evaluate({}, dt).force;
        EXPECT_NEAR(force.x(), 10 * std::min(1.0, 0.5 + i / 20.0), 1e-12);
        EXPECT_NEAR(force.y(), 10 * std::min(1.0, 0.5 + i / 20.0) * std::min(1.0, i / 20.0), 1e-12);
    }
}

TEST(Spring, ItsStiffnessIsClampedAndItsOwnerTold) {
    Scene scene = make_scene({.max_stiffness = 150});
    ASSERT_TRUE(scene.add(id, Spring{.anchor = {0.01, 0, 0}, .stiffness = 1000}));
    EXPECT_NEAR(settled(scene, {}).force.x(), 1.5, 1e-12);
    Feedback feedback[1];
    ASSERT_EQ(scene.feedback(feedback), 1u);
    EXPECT_EQ(feedback[0].stiffness, 150);
    EXPECT_TRUE(feedback[0].flags & Feedback::stiffness_clamped);
    EXPECT_NEAR(feedback[0].wrench.force.x(), 1.5, 1e-12) << "the reaction that a simulation needs";
}
