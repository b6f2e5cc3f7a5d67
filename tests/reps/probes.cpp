// Several probes on one hand: each has its own surfaces. tests/reference has the torque of any probes, on planes and
// with springs.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

TEST(Probes, EachTouchesItsOwnSurfacesOnly) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.place_probe(0, {.offset = {0.03, 0, 0}}));
    ASSERT_TRUE(scene.place_probe(1, {.offset = {-0.03, 0, 0}}));
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000}, {.probe = 0}));
    ASSERT_TRUE(
        scene.add({1, 1}, Plane{.normal = {0, 0, 1}, .offset = 0.001, .stiffness = 500}, {.probe = 1}));
    const Wrench w = settled(scene, at({0, 0, -0.001}));
    EXPECT_NEAR(w.force.z(), 1 + 1, 1e-12);
    EXPECT_NEAR(w.torque.y(), -0.03 * 1 + 0.03 * 1, 1e-15) << "equal forces at equal arms balance";
    Feedback feedback[2];
    ASSERT_EQ(scene.feedback(feedback), 2u);
    EXPECT_NEAR(feedback[0].wrench.torque.y(), -0.03, 1e-15);
    EXPECT_NEAR(feedback[1].wrench.torque.y(), 0.03, 1e-15);
    EXPECT_NEAR(scene.contact_point().x(), 0.03, 1e-15) << "of probe 0";
}

TEST(Probes, ARadiusMeetsTheSurfaceEarlierAndTheContactPointLiesOnTheSurface) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = 0.004}));
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000}));
    EXPECT_NEAR(settled(scene, at({0.01, 0, 0.003})).force.z(), 1, 1e-12);
    EXPECT_LE((scene.contact_point() - Vector(0.01, 0, 0)).norm(), 1e-15);
}

TEST(Probes, PlacingOneBeforeAnythingIsFeltDelaysNothing) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.place_probe(0, {.offset = {0, 0, -0.001}}));
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000, .recovery = 0}));
    ASSERT_TRUE(scene.add({1, 1}, ConstantForce{.force = {0, 0, 1}, .recovery = 0}));
    EXPECT_NEAR(scene.evaluate({}, dt).force.z(), 2, 1e-12);
}

TEST(Probes, OnesThatDoNotExistAreRefused) {
    Scene scene({.representations = 4, .probes = 2}, {});
    EXPECT_EQ(scene.place_probe(2, {}).code, Verdict::Code::no_such_probe);
    EXPECT_EQ(scene.place_probe(0, {.offset = {std::nan(""), 0, 0}}).code, Verdict::Code::not_finite);
    EXPECT_EQ(scene.place_probe(0, {.offset = {}, .radius = -1}).code, Verdict::Code::out_of_range);
    EXPECT_EQ(scene.add({0, 1}, Plane{.stiffness = 1}, {.probe = 2}).code, Verdict::Code::no_such_probe);
    EXPECT_EQ(scene.size(), 0u);
}

TEST(Probes, OneThatGrowsWhereNothingWasNearTouchesWhatItReaches) {
    for (const double gap : {0.003, 0.01, 0.1}) {
        Scene scene = make_scene();
        const Sphere ball{.center = {0, 0, -0.05 - gap}, .radius = 0.05, .stiffness = 1000};
        ASSERT_TRUE(scene.add({0, 1}, ball, {}));
        EXPECT_EQ(settled(scene, at({0, 0, 0})).force.norm(), 0.0);
        ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = gap + 1e-3}));
        double before = 0;
        for (int i = 0; i < 1000; ++i) {
            const double force = scene.evaluate(at({0, 0, 0}), dt).force.z();
            ASSERT_LE(std::abs(force - before), 0.1 + 1e-9) << "a fade of 10 ms, " << gap;
            before = force;
        }
        EXPECT_NEAR(scene.evaluate(at({0, 0, 0}), dt).force.z(), 1.0, 1e-9) << gap;
    }
}
