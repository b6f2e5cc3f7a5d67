// Curved surfaces in a scene: solved together, moving, sent away, skipped when out of reach (where they overlap:
// tests/reference/culling.cpp).

#include "shape_tools.hpp"

using namespace knurl;
using namespace knurl::test;

TEST(SolidsInAScene, TheCornerOfAHollowCylinderIsExact) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(
        {0, 1}, Cylinder{.radius = 0.03, .half_length = 0.05, .side = Side::inside, .stiffness = 500}));
    settled(scene, {});
    const Vector force = scene.evaluate(at({0.6 * 0.032, -0.8 * 0.032, -0.054}), dt).force;
    EXPECT_LE((force - 500 * Vector(-0.6 * 0.002, 0.8 * 0.002, 0.004)).norm(), 1e-12);
}

TEST(SolidsInAScene, AFingertipThatPlugsARingIsCentredWithoutAJump) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = 0.01}));
    ASSERT_TRUE(scene.add({0, 1}, Torus{.radius = 0.01, .tube = 0.002, .stiffness = 1000}));
    settled(scene, at({0, 0, 0.01}));
    Vector last = scene.evaluate(at({-1e-4, 0, 0.005}), dt).force;
    for (double x = -1e-4; x <= 1e-4; x += 1e-6) {
        const Vector force = scene.evaluate(at({x, 1e-9, 0.005}), dt).force;
        ASSERT_GT(force.z(), 0.5) << "pushed out along the axis";
        ASSERT_NEAR(force.x(), -1000 * x, 0.02) << "as if by a spring to the axis";
        ASSERT_LE((force - last).norm(), 5e-3) << x;
        last = force;
    }
}

TEST(SolidsInAScene, WhatIsSkippedWouldNotHaveBeenFelt) {
    // A hand that jumps and creeps among solids of all kinds, which hold it wherever it goes.
    const std::uint64_t seed = 8201;
    Rng rng(seed);
    for (int round = 0; round < (long_form() ? 200 : 5); ++round) {
        ScenePair pair;
        std::vector<Vector> centers;
        for (std::uint32_t i = 0; i < 60; ++i) {
            centers.push_back(0.05 * Vector(i % 4, i / 4 % 4, i / 16));
            const Vec3 center = to_plain(centers.back()), axis = to_plain(direction(rng));
            const auto add = [&](const auto& solid) { ASSERT_TRUE(pair.add({i, 1}, solid)); };
            const double r = uniform(rng, 0.004, 0.01), k = i % 3 == 0 ? 1000.0 : 500.0;
            if (i % 4 == 0) add(Sphere{.center = center, .radius = r, .stiffness = k});
            if (i % 4 == 1)
                add(Capsule{.center = center, .axis = axis, .half_length = r, .radius = r, .stiffness = k});
            if (i % 4 == 2)
                add(Cylinder{.center = center, .axis = axis, .radius = r, .half_length = r, .stiffness = k});
            if (i % 4 == 3)
                add(Torus{.center = center, .axis = axis, .radius = r, .tube = 0.6 * r, .stiffness = k});
        }
        pair.settle();
        Vector p = Vector::Zero();
        std::uint64_t evaluated = 0;
        int felt = 0;
        for (int i = 0; i < 4000; ++i) {
            const int move = between(rng, 0, 40);
            if (move == 0) p = 0.15 * Vector(uniform(rng, 0, 1), uniform(rng, 0, 1), uniform(rng, 0, 1));
            if (move == 1)  // into a core, but not where the direction is undefined
                p = centers[static_cast<std::size_t>(between(rng, 0, 59))] + 1e-5 * direction(rng);
            if (move > 1) p += 0.0015 * direction(rng);
            const Vector want = pair.exhaustive.evaluate(at(p), dt).force;
            ASSERT_LE((pair.skipping.evaluate(at(p), dt).force - want).norm(), 1e-9)
                << "seed " << seed << " round " << round << " cycle " << i;
            felt += want.norm() > 0;
            evaluated += pair.skipping.evaluated();
        }
        EXPECT_GT(felt, 500);
        EXPECT_LT(evaluated, 4000u * 30) << "not all of them in every cycle";
    }
}

// A solid that holds the hand has no bound, so it is always evaluated; sent away it is out of reach again.
TEST(SolidsInAScene, OneThatIsSentAwayWhileItHoldsTheHandAndBackMeetsItAsIfItHadBeenEvaluatedAllTheTime) {
    ScenePair pair;
    const auto send = [&](double x) {
        EXPECT_TRUE(pair.update(
            {0, 1},
            Box{.center = {x, 0, 0}, .half_size = {0.01, 0.01, 0.01}, .stiffness = 500, .recovery = 0}));
    };
    ASSERT_TRUE(pair.add({0, 1}, Box{}));
    const auto judge = [&](const Vector& hand) {
        const Vector want = pair.exhaustive.evaluate(at(hand), dt).force;
        EXPECT_EQ(pair.skipping.evaluate(at(hand), dt).force, want) << hand.transpose();
        return want;
    };
    send(0);
    judge({0, 0, 0.012});
    EXPECT_NEAR(judge({0, 0, 0.009}).z(), 0.5, 1e-12) << "held";
    send(1);
    judge({0, 0.009, 0.009});
    // any other change makes the scene list the evaluated surfaces anew
    pair.each([](Scene& scene) { ASSERT_TRUE(scene.add({1, 1}, Plane{.offset = -1, .stiffness = 500})); });
    for (int i = 1; i < 5; ++i) judge({0, 0.009 + 0.001 * i, 0.009 - 0.002 * i});
    send(0);
    EXPECT_LT(judge({0.004, 0.008, 0}).x(), 0) << "in the box's eyes the hand came from far on the left";
}

TEST(SolidsInAScene, OneThatMovesUnderTheHandIsFeltBetweenItsUpdates) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Sphere{.radius = 0.02, .velocity = {0, 0, 0.1}, .stiffness = 1000}));
    scene.settle();
    for (int i = 0; i < 50; ++i) {
        const double depth = 0.1 * dt * i - 0.001;
        EXPECT_NEAR(scene.evaluate(at({0, 0, 0.021}), dt).force.z(), 1000 * std::max(0.0, depth), 1e-11) << i;
    }
}
