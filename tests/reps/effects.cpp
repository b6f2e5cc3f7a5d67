// Effects are summed, and each fades separately.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

TEST(ConstantForce, FadesInOverItsRecoveryAndOutAgain) {
    Scene scene = make_scene();
    ASSERT_TRUE(
        scene.add({0, 1}, ConstantForce{.force = {1, 2, 3}, .torque = {0, 0, 0.1}, .recovery = 0.01}));
    for (int i = 1; i <= 13; ++i) {
        const double s = std::min(1.0, i / 10.0);
        const Wrench w = scene.evaluate({}, dt);
        EXPECT_LE((w.force - s * Vector(1, 2, 3)).norm(), 1e-14);
        EXPECT_NEAR(w.torque.z(), s * 0.1, 1e-15);
    }
    ASSERT_TRUE(scene.remove({0, 1}));
    for (int i = 1; i <= 13; ++i) {
        EXPECT_LE((scene.evaluate({}, dt).force - std::max(0.0, 1 - i / 10.0) * Vector(1, 2, 3)).norm(),
                  1e-14);
    }
    EXPECT_EQ(scene.evaluated(), 0u);
}

TEST(ConstantForce, ZeroRecoveryIsAtOnce) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, ConstantForce{.force = {1, 0, 0}, .recovery = 0}));
    EXPECT_EQ(scene.evaluate({}, dt).force.x(), 1);
    ASSERT_TRUE(scene.update({0, 1}, ConstantForce{.force = {-1, 0, 0}, .recovery = 0}));
    EXPECT_EQ(scene.evaluate({}, dt).force.x(), -1);
    ASSERT_TRUE(scene.remove({0, 1}));
    EXPECT_EQ(scene.evaluate({}, dt).force.x(), 0);
}

TEST(ConstantForce, AutomaticRecoveryIsThePolicys) {
    Scene scene = make_scene({}, {.automatic = 0.005});
    ASSERT_TRUE(scene.add({0, 1}, ConstantForce{.force = {1, 0, 0}}));
    EXPECT_NEAR(scene.evaluate({}, dt).force.x(), 0.2, 1e-15);
}

TEST(ConstantForce, AnOvertakenFadeGoesOnFromThePresentWrench) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, ConstantForce{.force = {10, 0, 0}, .recovery = 0.01}));
    for (int i = 0; i < 5; ++i) scene.evaluate({}, dt);  // at 5 N
    ASSERT_TRUE(scene.update({0, 1}, ConstantForce{.force = {0, 10, 0}, .recovery = 0.01}));
    for (int i = 1; i <= 12; ++i) {
        const double s = std::min(1.0, i / 10.0);
        EXPECT_LE((scene.evaluate({}, dt).force - Vector((1 - s) * 5, s * 10, 0)).norm(), 1e-13)
            << "cycle " << i;
    }
}

TEST(ConstantForce, RemovedInTheMiddleOfItsFadeItGoesBackFromThere) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, ConstantForce{.force = {10, 0, 0}, .recovery = 0.01}));
    for (int i = 0; i < 4; ++i) scene.evaluate({}, dt);
    ASSERT_TRUE(scene.remove({0, 1}));
    ASSERT_TRUE(scene.add({0, 2}, ConstantForce{.force = {0, 2, 0}, .recovery = 0.01}));
    for (int i = 1; i <= 12; ++i) {
        const double s = std::min(1.0, i / 10.0);
        EXPECT_LE((scene.evaluate({}, dt).force - Vector((1 - s) * 4, s * 2, 0)).norm(), 1e-13)
            << "cycle " << i;
    }
}

TEST(Effects, AddUpAndEachIsClampedByItself) {
    Scene scene = make_scene({.max_force = 5, .max_torque = 0.2});
    ASSERT_TRUE(scene.add({0, 1}, ConstantForce{.force = {30, 40, 0}, .torque = {0, 0, 3}}));
    ASSERT_TRUE(scene.add({1, 1}, ConstantForce{.force = {0, 0, 1}}));
    ASSERT_TRUE(scene.add({2, 1}, Spring{.anchor = {0, 0, 0.02}, .stiffness = 100}));
    const Wrench w = settled(scene, {});
    EXPECT_LE((w.force - Vector(3, 4, 3)).norm(), 1e-12) << "5 N in its own direction, 1 N, 2 N";
    EXPECT_NEAR(w.torque.z(), 0.2, 1e-15);
}

TEST(Effects, ALimitThatIsNoSensibleNumberAllowsNothing) {
    for (const double nonsense : {-5.0, std::nan(""), 0.0}) {
        Scene scene = make_scene({.max_force = nonsense, .max_torque = nonsense});
        ASSERT_TRUE(scene.add({0, 1}, ConstantForce{.force = {1, 0, 0}, .torque = {1, 0, 0}}));
        const Wrench w = settled(scene, {});
        EXPECT_EQ(w.force.norm(), 0.0);
        EXPECT_EQ(w.torque.norm(), 0.0);
    }
}

TEST(Effects, AddToTheContacts) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000}));
    ASSERT_TRUE(scene.add({1, 1}, ConstantForce{.force = {0, 0, -0.5}}));
    EXPECT_NEAR(settled(scene, at({0, 0, -0.001})).force.z(), 0.5, 1e-12);
}

TEST(Effects, ManySpringsInRandomOrderOfComingAndGoingSumAsIfCountedAnew) {
    Rng rng(61);
    Scene scene = make_scene();
    std::array<bool, 64> present{};
    std::array<std::uint32_t, 64> generation{};
    std::array<double, 64> pull{};
    for (int i = 0; i < 3000; ++i) {
        const auto slot = static_cast<std::uint32_t>(between(rng, 0, 63));
        if (present[slot]) {
            ASSERT_TRUE(scene.remove({slot, generation[slot]}));
        } else {
            pull[slot] = uniform(rng, -0.1, 0.1);
            const RepresentationId id{slot, ++generation[slot]};
            if (slot % 2) {
                ASSERT_TRUE(
                    scene.add(id, Spring{.anchor = {pull[slot], 0, 0}, .stiffness = 100, .duration = 0}));
            } else {
                ASSERT_TRUE(scene.add(id, ConstantForce{.force = {100 * pull[slot], 0, 0}, .recovery = 0}));
            }
        }
        present[slot] = !present[slot];
        double want = 0;
        std::uint32_t count = 0;
        for (std::size_t k = 0; k < 64; ++k) {
            want += present[k] ? 100 * pull[k] : 0;
            count += present[k];
        }
        ASSERT_NEAR(scene.evaluate({}, dt).force.x(), want, 1e-11) << "change " << i;
        ASSERT_EQ(scene.evaluated(), count);
        ASSERT_EQ(scene.size(), count);
    }
}
