// The forces of an application that has fallen silent.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

const Probe probe = at({-0.001, 0, -0.001});

Scene scene_with(OnSilence floor, OnSilence wall, double time = 0.1) {
    Scene scene = make_scene();
    EXPECT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000},
                          {.on_silence = floor, .silence_time = time}));
    EXPECT_TRUE(scene.add({1, 1}, Plane{.normal = {1, 0, 0}, .stiffness = 500},
                          {.on_silence = wall, .silence_time = time}));
    settled(scene, probe);
    return scene;
}

}  // namespace

TEST(Silence, FadesOverATenthOfASecondAndBackOverATwentieth) {
    Scene scene = scene_with(OnSilence::fade, OnSilence::fade);
    const Vector full(0.5, 0, 1);
    for (int i = 1; i <= 120; ++i) {
        scene.set_silence(i * dt);
        EXPECT_LE((scene.evaluate(probe, dt).force - std::max(0.0, 1 - i / 100.0) * full).norm(), 1e-12) << i;
    }
    scene.set_silence(0);
    for (int i = 1; i <= 60; ++i) {
        EXPECT_LE((scene.evaluate(probe, dt).force - std::min(1.0, i / 50.0) * full).norm(), 1e-12) << i;
    }
}

TEST(Silence, HoldChangesNothingToTheBit) {
    Scene silent = scene_with(OnSilence::hold, OnSilence::hold),
          twin = scene_with(OnSilence::hold, OnSilence::hold);
    for (int i = 1; i <= 500; ++i) {
        silent.set_silence(i * dt);
        ASSERT_TRUE(same_bits(silent.evaluate(probe, dt), twin.evaluate(probe, dt)));
    }
}

TEST(Silence, HeldSpringsStayOneSpringToTheBit) {
    Scene silent = make_scene(), twin = make_scene();
    for (std::uint32_t i = 0; i < 10; ++i)
        for (Scene* scene : {&silent, &twin})
            ASSERT_TRUE(scene->add(
                {i, 1}, Spring{.attach = {0.001 * i, 0.1 / (i + 3), 0}, .stiffness = 7.0 / (i + 1)},
                {.on_silence = OnSilence::hold, .feedback = 0}));
    settled(silent, probe);
    settled(twin, probe);
    for (int i = 1; i <= 500; ++i) {
        silent.set_silence(i < 400 ? i * dt : 0);
        const Probe hand = at({0.001 * i, 0, -0.0003 * i});
        ASSERT_TRUE(same_bits(silent.evaluate(hand, dt), twin.evaluate(hand, dt))) << i;
    }
}

/// The effect of a silence stays; a representation added during it starts in full and fades as well.
TEST(Silence, WhatComesDuringItFadesToo) {
    Scene scene = make_scene();
    for (int i = 1; i <= 300; ++i) {
        scene.set_silence(i * dt);
        scene.evaluate(probe, dt);
    }
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000, .recovery = 0}));
    double last = 0;
    for (int i = 301; i <= 401; ++i) {
        scene.set_silence(i * dt);
        last = scene.evaluate(probe, dt).force.z();
        if (i == 302) {
            EXPECT_GT(last, 0.9);
        }
    }
    EXPECT_EQ(last, 0);
    // Shorter than it was: a representation that would have waited is back.
    Scene moves = scene_with(OnSilence::move, OnSilence::move, 0.2);
    for (int i = 1; i <= 400; ++i) {
        moves.set_silence(i * dt);
        last = moves.evaluate(probe, dt).force.z();
    }
    EXPECT_EQ(last, 0);
    for (int i = 1; i <= 60; ++i) {
        moves.set_silence(i * dt);
        last = moves.evaluate(probe, dt).force.z();
    }
    EXPECT_NEAR(last, 1, 1e-11);
}

TEST(Silence, MoveGoesOnForItsTimeAndThenFades) {
    Scene scene = scene_with(OnSilence::move, OnSilence::move, 0.2);
    for (int i = 1; i <= 320; ++i) {
        scene.set_silence(i * dt);
        const double want = i <= 200 ? 1 : std::max(0.0, 1 - (i - 200) / 100.0);
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), want, 1e-11) << i;
    }
}

TEST(Silence, WhatFadesInACornerLeavesWhatHoldsWithoutAJump) {
    Scene scene = scene_with(OnSilence::hold, OnSilence::fade);
    Vector last = scene.evaluate(probe, dt).force;
    for (int i = 1; i <= 120; ++i) {
        scene.set_silence(i * dt);
        const Vector force = scene.evaluate(probe, dt).force;
        EXPECT_NEAR(force.z(), 1, 1e-12);
        EXPECT_NEAR(force.x(), 0.5 * std::max(0.0, 1 - i / 100.0), 1e-12);
        EXPECT_LE((force - last).norm(), 0.5 / 100 + 1e-12);
        last = force;
    }
}

TEST(Silence, EffectsFadeToo) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, ConstantForce{.force = {2, 0, 0}}));
    ASSERT_TRUE(scene.add({1, 1}, ConstantForce{.force = {0, 1, 0}}, {.on_silence = OnSilence::hold}));
    settled(scene, probe);
    for (int i = 1; i <= 110; ++i) {
        scene.set_silence(i * dt);
        const Wrench w = scene.evaluate(probe, dt);
        EXPECT_NEAR(w.force.x(), 2 * std::max(0.0, 1 - i / 100.0), 1e-12);
        EXPECT_NEAR(w.force.y(), 1, 1e-12);
    }
}

TEST(Silence, WhateverItIsToldTheWeightOnlyMovesAtItsRates) {
    Rng rng(91);
    Scene scene = scene_with(OnSilence::fade, OnSilence::move, 0.05);
    Vector last = scene.evaluate(probe, dt).force;
    for (int i = 0; i < 3000; ++i) {
        if (between(rng, 0, 9) == 0) scene.set_silence(between(rng, 0, 1) ? uniform(rng, 0, 10) : 0);
        const Vector force = scene.evaluate(probe, dt).force;
        ASSERT_LE((force - last).norm(), 1.5 * dt / 0.05 + 1e-12) << "cycle " << i;
        last = force;
    }
}

TEST(Silence, ChangesThatWereFadingWhenItFellFadeWithIt) {
    Scene scene = scene_with(OnSilence::fade, OnSilence::fade);
    ASSERT_TRUE(scene.update(
        {0, 1}, Plane{.normal = {0, 0, 1}, .offset = 0.002, .stiffness = 1000, .recovery = 0.05}));
    for (int i = 1; i <= 60; ++i) {
        scene.set_silence(i * dt);
        const double s = std::min(1.0, i / 50.0), w = 1 - i / 100.0;
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), w * (1 + 2 * s), 1e-11) << i;
    }
}

TEST(Silence, IsReportedToTheOwner) {
    Scene scene = scene_with(OnSilence::fade, OnSilence::hold);
    scene.set_silence(0.01);
    scene.evaluate(probe, dt);
    Feedback feedback[2];
    ASSERT_EQ(scene.feedback(feedback), 2u);
    EXPECT_TRUE(feedback[0].flags & Feedback::silent);
}

TEST(Silence, HeldEffectsStandStillAndASpringArrivesWhereItWasTold) {
    Scene scene = make_scene();
    const AddOptions holds{.on_silence = OnSilence::hold};
    ASSERT_TRUE(scene.add({0, 1}, Vibration{.direction = {1, 0, 0}, .amplitude = 2, .frequency = 20}, holds));
    ASSERT_TRUE(scene.add({1, 1}, Spring{.anchor = {0, 0, 0.01}, .stiffness = 100, .duration = 0.1}, holds));
    settled(scene, at({0, 0, 0}));
    for (int i = 0; i < 7; ++i) scene.evaluate(at({0, 0, 0}), dt);
    ASSERT_TRUE(scene.update({1, 1}, Spring{.anchor = {0, 0, 0.03}, .stiffness = 100, .duration = 0.1}));
    for (int i = 0; i < 5; ++i) scene.evaluate(at({0, 0, 0}), dt);
    const double held = 2 * std::sin(2 * M_PI * 20 * 13 * dt);
    for (int i = 1; i <= 200; ++i) {
        scene.set_silence(i * dt);
        const Vector force = scene.evaluate(at({0, 0, 0}), dt).force;
        EXPECT_NEAR(force.x(), held, 1e-12) << i;
        EXPECT_NEAR(force.z(), 1 + 2 * std::min(1.0, (5 + i) / 100.0), 1e-12) << i;
    }
    scene.set_silence(0);
    EXPECT_NEAR(scene.evaluate(at({0, 0, 0}), dt).force.x(), 2 * std::sin(2 * M_PI * 20 * 14 * dt), 1e-12);
}
