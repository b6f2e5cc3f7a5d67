// The work of each stage of a scene in a cycle, counted: a stage that a scene does not need does nothing.

#include <gtest/gtest.h>

#include <knurl/reps/curved_contact.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

SceneWork work_at(Scene& scene, const Vector& position) {
    scene.evaluate(at(position), dt);
    return scene.work();
}

}  // namespace

TEST(SceneWork, WhatIsOutOfReachAndHasNotChangedMakesNone) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.offset = -0.1, .stiffness = 500, .friction = {.dynamic = 0.5}}));
    for (std::uint32_t i = 1; i < 30; ++i)
        ASSERT_TRUE(scene.add({i, 1}, Sphere{.center = {0.1 * i, 0, 0}, .stiffness = 500}));
    for (std::uint32_t i = 30; i < 60; ++i)
        ASSERT_TRUE(scene.add({i, 1}, Magnet{.position = {0, 0.3 * i, 0}, .radius = 0.01, .stiffness = 100}));
    settled(scene, {});
    EXPECT_EQ(scene.work().changes, 60u);
    EXPECT_EQ(scene.work().collections, 2u) << "once for the surfaces, once for the effects";
    EXPECT_EQ(work_at(scene, {1e-4, 0, 0}), SceneWork{});
}

TEST(SceneWork, APlaneTakesOneSolutionAndFrictionAlone) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 500}));
    settled(scene, at({0, 0, -1e-3}));
    EXPECT_EQ(work_at(scene, {0, 0, -1e-3}), (SceneWork{.evaluated = 1, .layers = 1}));
    ASSERT_TRUE(scene.update({0, 1}, Plane{.stiffness = 500, .friction = {.dynamic = 0.5}}));
    settled(scene, at({0, 0, -1e-3}));
    EXPECT_EQ(work_at(scene, {0, 0, -1e-3}), (SceneWork{.evaluated = 1, .layers = 1, .tangential = 1}));
}

TEST(SceneWork, EachStiffnessOfASetTakesASolution) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 500}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {1, 0, 1}, .stiffness = 600}));
    ASSERT_TRUE(scene.add({2, 1}, Plane{.normal = {0, 1, 1}, .stiffness = 500}));
    settled(scene, at({0, 0, -1e-3}));
    EXPECT_EQ(work_at(scene, {0, 0, -1e-3}).layers, 2u);
}

TEST(SceneWork, PlanesThatArePutElsewhereKeepTheirSets) {
    Scene scene = make_scene();
    const auto put = [&](double offset) {
        for (std::uint32_t i = 0; i < 20; ++i)
            ASSERT_TRUE(
                scene.update({i, 1}, Plane{.offset = offset - i, .stiffness = 500, .recovery = 0.003}));
        scene.evaluate(at({0, 0, -1e-3}), dt);
        ASSERT_EQ(scene.work().changes, 20u);
    };
    for (std::uint32_t i = 0; i < 20; ++i)
        ASSERT_TRUE(scene.add({i, 1}, Plane{.offset = -1.0 * i, .stiffness = 500, .recovery = 0.003}));
    settled(scene, at({0, 0, -1e-3}));
    put(1e-4);  // the slots' two records become twins
    EXPECT_EQ(scene.work().sets, 2u) << "the new one, and the one that fades out";
    for (int i = 0; i < 5; ++i) scene.evaluate(at({0, 0, -1e-3}), dt);
    put(2e-4);
    EXPECT_EQ(scene.work().sets, 0u) << "edited in place";
}

TEST(SceneWork, OneCurvedSurfaceTakesNoStepAndTwoInAGrooveSome) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Sphere{.center = {-0.009, 0, 0}, .radius = 0.01, .stiffness = 500}));
    settled(scene, at({-0.009, 0, 0.0095}));
    EXPECT_EQ(work_at(scene, {-0.009, 0, 0.0095}).curved_rounds, 0u);
    ASSERT_TRUE(scene.add({1, 1}, Sphere{.center = {0.009, 0, 0}, .radius = 0.01, .stiffness = 500}));
    scene.settle();
    // Down into the groove from above, where the hand was free.
    std::uint32_t rounds = 0;
    for (int i = 0; i < 20; ++i) {
        const SceneWork work = work_at(scene, {0, 0, 0.006 - 2e-4 * i});
        EXPECT_LE(work.curved_rounds, max_curved_rounds * work.layers);
        rounds += work.curved_rounds;
    }
    EXPECT_GT(rounds, 0u);
}

TEST(SceneWork, TheHandThatLeavesWhatWasCollectedMakesItAnew) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Sphere{.center = {0.1, 0, 0}, .radius = 0.01, .stiffness = 500}));
    settled(scene, {});
    std::uint32_t collections = 0;
    for (int i = 0; i < 1000; ++i) collections += work_at(scene, {8e-5 * i, 0, 0}).collections;
    EXPECT_GT(collections, 0u);
    EXPECT_LT(collections, 100u) << "of 1000 cycles in which the hand moved by 80 mm";
}
