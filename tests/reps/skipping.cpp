// What a scene does not need costs nothing, counted in work, not in time. And nothing allocates in the cycle.

#include <gtest/gtest.h>

#include "count_allocations.hpp"
#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

TEST(Skipping, AnEmptySceneEvaluatesNothing) {
    Scene scene = make_scene();
    EXPECT_EQ(scene.evaluate({}, dt).force.norm(), 0.0);
    EXPECT_EQ(scene.evaluated(), 0u);
}

TEST(Skipping, PlanesOutOfReachAreScannedButNotEvaluated) {
    Scene scene = make_scene();
    for (std::uint32_t i = 0; i < 60; ++i) {
        ASSERT_TRUE(scene.add({i, 1}, Plane{.normal = {0, 0, 1}, .offset = -0.1 - i, .stiffness = 500}));
    }
    settled(scene, {});
    scene.evaluate({}, dt);
    EXPECT_EQ(scene.evaluated(), 0u);
}

TEST(Skipping, WhatWasRemovedIsNoLongerEvaluatedOnceItHasFaded) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Spring{.stiffness = 100, .duration = 0.01}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.stiffness = 100, .recovery = 0.01}));
    settled(scene, at({0, 0, -0.001}));
    EXPECT_EQ(scene.evaluated(), 2u);
    ASSERT_TRUE(scene.remove({0, 1}));
    ASSERT_TRUE(scene.remove({1, 1}));
    scene.evaluate(at({0, 0, -0.001}), dt);
    EXPECT_EQ(scene.evaluated(), 2u) << "while it fades the old is really felt";
    for (int i = 0; i < 10; ++i) scene.evaluate(at({0, 0, -0.001}), dt);
    EXPECT_EQ(scene.evaluated(), 0u);
}

TEST(Skipping, TheOldSetIsEvaluatedOnlyWhileItFades) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 100}));
    settled(scene, at({0, 0, -0.001}));
    EXPECT_EQ(scene.evaluated(), 1u);
    ASSERT_TRUE(scene.update({0, 1}, Plane{.offset = 0.001, .stiffness = 100, .recovery = 0.005}));
    for (int i = 1; i <= 5; ++i) {
        scene.evaluate(at({0, 0, -0.001}), dt);
        EXPECT_EQ(scene.evaluated(), 2u) << i;
    }
    scene.evaluate(at({0, 0, -0.001}), dt);
    EXPECT_EQ(scene.evaluated(), 1u);
}

TEST(Skipping, NothingIsAllocatedAfterConstruction) {
    Rng rng(101);
    Scene scene({.representations = 64, .probes = 4}, {.max_stiffness = 3000, .max_force = 8.5});
    const std::size_t before = allocations();
    std::array<std::uint32_t, 64> generation{};
    std::array<Feedback, 64> feedback;
    for (int i = 0; i < 20'000; ++i) {
        const auto slot = static_cast<std::uint32_t>(between(rng, 0, 63));
        const AddOptions options{.probe = static_cast<std::uint32_t>(between(rng, 0, 3))};
        const RepresentationId id{slot, generation[slot]};
        switch (between(rng, 0, 9)) {
            case 0:
                generation[slot] += static_cast<bool>(
                    scene.add({slot, generation[slot] + 1}, random_params<Plane>(rng, false), options));
                break;
            case 1:
                generation[slot] += static_cast<bool>(
                    scene.add({slot, generation[slot] + 1}, random_params<Spring>(rng, false), options));
                break;
            case 2:
                generation[slot] += static_cast<bool>(scene.add(
                    {slot, generation[slot] + 1}, random_params<ConstantForce>(rng, false), options));
                break;
            case 3:
                (void)scene.update(id, random_params<Plane>(rng, false));
                break;
            case 4:
                (void)scene.update(id, random_params<Spring>(rng, false));
                break;
            case 5:
                (void)scene.remove(id);
                break;
            case 6:
                scene.set_silence(between(rng, 0, 3) ? 0 : 1);
                break;
            case 7:
                (void)scene.place_probe(options.probe, {.offset = {0.01 * between(rng, 0, 3), 0, 0}});
                break;
            case 8:
                (void)scene.feedback(feedback);
                break;
            default:
                scene.set_limits({.max_stiffness = uniform(rng, 100, 3000), .max_force = 8.5});
                break;
        }
        ASSERT_TRUE(finite(scene.evaluate(at(0.005 * direction(rng)), dt)));
    }
    EXPECT_EQ(allocations(), before);
}
