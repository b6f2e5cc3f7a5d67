// polygon, half_plane and box in a scene: solved together, skipped when out of reach, cross-faded when
// changed.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace pieces_scene_tests {
namespace {

constexpr std::uint64_t seed = 515;

Box random_box(Rng& rng) {
    const Eigen::Quaterniond pose = turn(rng);
    Box box{.center = to_plain(uniform(rng, 0, 0.1) * direction(rng)),
            .orientation = to_plain(pose),
            .half_size = {scale(rng, 1e-3, 0.03), scale(rng, 1e-3, 0.03), scale(rng, 1e-3, 0.03)},
            .stiffness = 1000};
    if (between(rng, 0, 3) == 0) box.half_size.x = 0;
    return box;
}

}  // namespace

TEST(PiecesInAScene, TheCornerOfAHollowBoxIsExact) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Box{.center = {0.01, 0, 0},
                                      .half_size = {0.02, 0.03, 0.04},
                                      .side = Side::inside,
                                      .stiffness = 500}));
    settled(scene, {});
    const Vector force = scene.evaluate(at({0.032, -0.033, 0.044}), dt).force;
    EXPECT_LE((force - 500 * Vector(-0.002, 0.003, -0.004)).norm(), 1e-12);
}

TEST(PiecesInAScene, APlateOnAFloorHoldsTheHandInTheCornerBetweenThem) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 500}));
    // It stands in x = 0, faces +x, and reaches 50 mm below the floor.
    Polygon wall{.stiffness = 500};
    wall.vertices = {.at = {{0, -0.1, -0.05}, {0, 0.1, -0.05}, {0, 0.1, 0.1}, {0, -0.1, 0.1}}, .count = 4};
    ASSERT_TRUE(scene.add({1, 1}, wall));
    settled(scene, at({0.01, 0, 0.01}));
    for (double s = 0.01; s > -0.004; s -= 1e-4) {
        const Vector force = scene.evaluate(at({s, 0, s / 2}), dt).force;
        ASSERT_LE((force - 500 * Vector(std::max(0.0, -s), 0, std::max(0.0, -s / 2))).norm(), 1e-12) << s;
    }
    // Moved along the floor beyond the wall's end, the hand is released.
    EXPECT_EQ(scene.evaluate(at({-0.004, 0.101, 0.01}), dt).force.norm(), 0);
}

TEST(PiecesInAScene, WhatIsSkippedWouldNotHaveBeenFelt) {
    Rng rng(seed);
    const int rounds = long_form() ? 400 : 6;
    long felt_at_all = 0;
    for (int round = 0; round < rounds; ++round) {
        ScenePair pair;
        for (std::uint32_t i = 0; i < 40; ++i) {
            if (i % 2) {
                ASSERT_TRUE(pair.add({i, 1}, random_box(rng)));
            } else {
                Polygon polygon = random_polygon(rng, scale(rng, 3e-3, 0.03), uniform(rng, 0, 0.1));
                polygon.sides = between(rng, 0, 1) ? Sides::both : Sides::front;
                ASSERT_TRUE(pair.add({i, 1}, polygon));
            }
        }
        const double radius = round % 2 ? 0.002 : 0;
        ASSERT_TRUE(pair.place_probe(0, {.offset = {}, .radius = radius}));
        pair.settle();
        // Through free space to anywhere, but back again where a piece is pressed by 1 mm. Deeper than the
        // candidates' margin the proxy may run into pieces that are not evaluated.
        Vector p = 0.1 * direction(rng), goal = p, away = p;
        int felt = 0;
        for (int i = 0; i < 10'000; ++i) {
            if ((goal - p).norm() < 1e-3) goal = uniform(rng, 0, 0.12) * direction(rng);
            p += (goal - p).normalized() * std::min((goal - p).norm(), 0.5e-3);
            const Vector a = pair.skipping.evaluate(at(p), dt).force,
                         b = pair.exhaustive.evaluate(at(p), dt).force;
            ASSERT_LE((a - b).norm(), 1e-9) << "seed " << seed << " round " << round << " cycle " << i;
            felt += a.norm() > 0;
            if (a.norm() == 0) away = p;
            if (a.norm() > 1) goal = away;
        }
        EXPECT_GT(felt, 20);
        felt_at_all += felt;
    }
    // A path that begins in a box, or whose proxy has come around a plate, returns to where it is held.
    EXPECT_LT(felt_at_all, 5'000L * rounds);
}

TEST(PiecesInAScene, ATouchedPieceIsNotLostHoweverDeepTheHandSinksIn) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Polygon{.stiffness = 100}));
    ASSERT_TRUE(scene.add(
        {1, 1}, Box{.center = {0.2, 0, -0.001}, .half_size = {0.05, 0.05, 0.001}, .stiffness = 100}));
    settled(scene, at({0, 0, 0.01}));
    for (const double x : {0.0, 0.2}) {
        scene.evaluate(at({x, 0, 0.01}), dt);
        for (double z = 0.01; z > -1; z -= 0.001) {
            ASSERT_NEAR(scene.evaluate(at({x, 0, z}), dt).force.z(), 100 * std::max(0.0, -z), 1e-9) << z;
        }
        scene.evaluate(at({x, 0.2, -1}), dt);
        scene.evaluate(at({x, 0.2, 0.01}), dt);
    }
}

TEST(PiecesInAScene, AChangeWhileTouchedIsFadedAndTheHoldIsKept) {
    Scene scene = make_scene();
    Polygon plate{.stiffness = 1000, .recovery = 0.01};
    ASSERT_TRUE(scene.add({0, 1}, plate));
    settled(scene, at({0, 0, 0.001}));
    Vector last = scene.evaluate(at({0, 0, -0.002}), dt).force;
    EXPECT_NEAR(last.z(), 2, 1e-12);
    for (std::uint32_t i = 0; i < 4; ++i) plate.vertices.at[i].z = 0.003;  // past the hand, 3 mm up
    ASSERT_TRUE(scene.update({0, 1}, plate));
    for (int i = 0; i < 20; ++i) {
        const Vector force = scene.evaluate(at({0, 0, -0.002}), dt).force;
        EXPECT_LE((force - last).norm(), 3 * 0.1 + 1e-9);
        last = force;
    }
    EXPECT_NEAR(last.z(), 5, 1e-9);
}

}  // namespace pieces_scene_tests
