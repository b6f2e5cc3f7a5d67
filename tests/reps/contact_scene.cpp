// The force of a scene of planes. tests/reference/planes.cpp compares it with the reference for any planes.

#include <gtest/gtest.h>

#include "shape_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

void build(Scene& scene, const std::vector<Plane>& walls) {
    for (std::uint32_t i = 0; i < walls.size(); ++i) ASSERT_TRUE(scene.add({i, 1}, walls[i]));
    scene.settle();
}

std::vector<Plane> random_walls(Rng& rng, int count) {
    const PlaneSet set = corner(rng, count, 0.01);
    std::vector<Plane> walls;
    for (std::uint32_t i = 0; i < set.size(); ++i)
        walls.push_back(
            {.normal = to_plain(set.normal(i)), .offset = set.c[i], .stiffness = 200.0 * between(rng, 1, 8)});
    return walls;
}

}  // namespace

TEST(ContactScene, OnePlaneIsASpringAlongItsNormal) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 2}, .offset = 0.02, .stiffness = 800}));
    // the normal's length divides the offset: z = 0.01
    const Wrench in = settled(scene, at({0.1, 0.2, 0.009}));
    EXPECT_NEAR(in.force.z(), 0.8, 1e-12);
    EXPECT_EQ(in.force.head<2>().norm(), 0.0);
    EXPECT_NEAR(scene.contact_point().z(), 0.01, 1e-15);
    const Wrench out = scene.evaluate(at({0.1, 0.2, 0.011}), dt);
    EXPECT_EQ(out.force.norm(), 0.0);
    EXPECT_EQ(scene.contact_point().z(), 0.011) << "out of contact it is the probe itself";
}

TEST(ContactScene, NoDirectionIsStifferThanTheStiffestPlane) {
    const std::uint64_t seed = 32;
    Rng rng(seed);
    for (int round = 0; round < 300; ++round) {
        std::vector<Plane> walls = random_walls(rng, between(rng, 1, 9));
        if (round % 5 == 0) walls.insert(walls.end(), 5, walls[0]);  // copies
        double largest = 0;
        for (const Plane& wall : walls) largest = std::max(largest, wall.stiffness);
        Scene scene = make_scene();
        build(scene, walls);
        for (int i = 0; i < 200; ++i) {
            const Vector p = 0.01 * direction(rng), step = 1e-5 * direction(rng);
            const Vector change = scene.evaluate(at(p + step), dt).force - scene.evaluate(at(p), dt).force;
            ASSERT_LE(change.norm(), largest * (1 + 1e-6) * step.norm() + 1e-12)
                << "seed " << seed << " round " << round;
        }
    }
}

TEST(ContactScene, TheMicrometreScaleAThousandKilometresAway) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .offset = 1e6, .stiffness = 1000}));
    const double p = 1e6 - 1e-6;
    EXPECT_EQ(settled(scene, at({3e5, -2e5, p})).force.z(), 1000 * (1e6 - p))
        << "no more error than the coordinates'";
}

TEST(ContactScene, DampingActsAlongTheForceAndNeverPulls) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000, .damping = 5}));
    EXPECT_NEAR(settled(scene, at({0, 0, -0.001}, {1, 1, -0.1})).force.z(), 1.5, 1e-12);
    EXPECT_EQ(scene.evaluate(at({0, 0, -0.001}, {1, 1, -0.1}), dt).force.x(), 0.0);
    EXPECT_NEAR(scene.evaluate(at({0, 0, -0.001}, {0, 0, 0.1}), dt).force.z(), 0.5, 1e-12);
    EXPECT_EQ(scene.evaluate(at({0, 0, -0.001}, {0, 0, 1.0}), dt).force.norm(), 0.0)
        << "leaving fast: no stickiness";
    EXPECT_EQ(scene.evaluate(at({0, 0, 0.001}, {0, 0, -1.0}), dt).force.norm(), 0.0) << "not before contact";
}

TEST(ContactScene, InACornerTheActivePlanesShareTheirDamping) {
    // A right angle, equally deep in both: the force is along the diagonal, the damping the mean.
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000, .damping = 2}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {1, 0, 0}, .stiffness = 1000, .damping = 6}));
    const Vector m = Vector(1, 0, 1).normalized();
    const Wrench w = settled(scene, at({-0.001, 0, -0.001}, -0.1 * m + Vector(0, 3, 0)));
    EXPECT_LE((w.force - (std::sqrt(2.0) + 0.4) * m).norm(), 1e-12);
}

TEST(ContactScene, TheForceIsClampedWithoutTurning) {
    Scene scene = make_scene({.max_force = 5});
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 3, 4}, .stiffness = 1000}));
    const Vector force = settled(scene, at({0, 0, -1})).force;
    EXPECT_NEAR(force.norm(), 5, 1e-12);
    EXPECT_LE((force.normalized() - Vector(0, 0.6, 0.8)).norm(), 1e-12);
}

TEST(ContactScene, StiffnessIsClampedToTheDeviceAndItsOwnerIsTold) {
    Scene scene = make_scene({.max_stiffness = 600});
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = infinity}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {1, 0, 0}, .stiffness = 500}));
    EXPECT_NEAR(settled(scene, at({1, 0, -0.001})).force.z(), 0.6, 1e-12);
    Feedback feedback[4];
    ASSERT_EQ(scene.feedback(feedback), 2u);
    EXPECT_EQ(feedback[0].stiffness, 600);
    EXPECT_TRUE(feedback[0].flags & Feedback::stiffness_clamped);
    EXPECT_FALSE(feedback[1].flags & Feedback::stiffness_clamped);
    // The device allows less than assumed: a change like any other, cross-faded.
    scene.set_limits({.max_stiffness = 300});
    Vector last = scene.evaluate(at({1, 0, -0.001}), 0).force;
    for (int i = 0; i < 20; ++i) {
        const Vector force = scene.evaluate(at({1, 0, -0.001}), dt).force;
        EXPECT_LE((force - last).norm(), 0.3 * 0.1 + 1e-12);
        last = force;
    }
    EXPECT_NEAR(last.z(), 0.3, 1e-12);
}

TEST(ContactScene, InfiniteStiffnessWithoutADeviceIsAThousand) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = infinity}));
    EXPECT_NEAR(settled(scene, at({0, 0, -0.001})).force.z(), 1, 1e-12);
}

TEST(ContactScene, ZeroStiffnessIsLegalAndFeelsLikeNothing) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 0, .damping = 100}));
    EXPECT_EQ(settled(scene, at({0, 0, -0.01}, {0, 0, -1})).force.norm(), 0.0);
}

TEST(ContactScene, ASoftCeilingDoesNotMoveAHardFloor) {
    // They overlap by 2 mm. The floor alone is feasible: its layer must not give way for the ceiling.
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .offset = 0.001, .stiffness = 2000}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {0, 0, -1}, .offset = 0.001, .stiffness = 200}));
    scene.settle();
    Vector last = Vector::Zero();
    for (int i = 0; i <= 400; ++i) {
        const double z = -0.002 + 1e-5 * i;
        const Vector force = scene.evaluate(at({0, 0, z}), dt).force;
        // Soft layer: both give way by 1 mm and meet at z = 0. Hard layer: the floor alone, at 1 mm.
        EXPECT_NEAR(force.z(), 200 * (0 - z) + 1800 * std::max(0.0, 0.001 - z), 1e-6) << z;
        if (i > 0) {
            EXPECT_LE((force - last).norm(), 2000 * 1e-5 * (1 + 1e-6)) << z;
        }
        last = force;
    }
    Feedback feedback[2];
    ASSERT_EQ(scene.feedback(feedback), 2u);
    EXPECT_TRUE(feedback[0].flags & Feedback::infeasible);
}

TEST(ContactScene, PlanesThatContradictEachOtherOnlyWhileTheyMoveMeetHalfwayMeanwhile) {
    // A floor sinks from 3 mm to 0 under a ceiling at 1 mm: for the first two thirds they overlap.
    Scene scene = make_scene();
    const Plane floor{
        .offset = 0.003, .stiffness = 1000, .recovery = 0.03, .update = PlaneUpdate::last_depth};
    ASSERT_TRUE(scene.add({0, 1}, floor));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {0, 0, -1}, .offset = -0.001, .stiffness = 1000}));
    const Probe probe = at({0, 0, -0.002});
    settled(scene, probe);
    Plane lower = floor;
    lower.offset = 0;
    ASSERT_TRUE(scene.update({0, 1}, lower));
    for (int i = 1; i <= 40; ++i) {
        const double height = 0.003 * std::max(0.0, 1 - i / 30.0);
        const double proxy = height > 0.001 ? (height + 0.001) / 2 : height;
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 1000 * (proxy + 0.002), 1e-6) << "cycle " << i;
        Feedback feedback[2];
        scene.feedback(feedback);
        EXPECT_EQ((feedback[0].flags & Feedback::infeasible) != 0, height > 0.001 + 1e-9) << "cycle " << i;
    }
}

TEST(ContactScene, MoreThanEightStiffnessesAreRoundedDownAndTheOwnerIsTold) {
    Scene scene = make_scene();
    for (std::uint32_t i = 0; i < 12; ++i) {
        const double angle = i * M_PI / 6;
        ASSERT_TRUE(scene.add(
            {i, 1}, Plane{.normal = {std::cos(angle), std::sin(angle), 1}, .stiffness = 100.0 * (1 + i)}));
    }
    settled(scene, at({0, 0, -0.001}));
    Feedback feedback[16];
    ASSERT_EQ(scene.feedback(feedback), 12u);
    int rounded = 0;
    for (std::uint32_t i = 0; i < 12; ++i) {
        const double requested = 100.0 * (1 + feedback[i].id.slot);
        EXPECT_LE(feedback[i].stiffness, requested);
        EXPECT_GT(feedback[i].stiffness, 0.6 * requested);
        EXPECT_EQ((feedback[i].flags & Feedback::stiffness_clamped) != 0, feedback[i].stiffness < requested);
        rounded += feedback[i].stiffness < requested;
    }
    EXPECT_EQ(rounded, 4) << "twelve stiffnesses, eight kept";
}

TEST(ContactScene, TheSharesReportedToTheOwnersAddUpToTheForce) {
    Rng rng(33);
    for (int round = 0; round < 200; ++round) {
        Scene scene = make_scene({.max_force = 6});
        build(scene, random_walls(rng, 6));
        const Wrench w = scene.evaluate(at(0.008 * direction(rng)), dt);
        Feedback feedback[8];
        const std::size_t n = scene.feedback(feedback);
        Vector sum = Vector::Zero();
        for (std::size_t i = 0; i < n; ++i) {
            sum += feedback[i].wrench.force;
            EXPECT_EQ((feedback[i].flags & Feedback::touching) != 0, feedback[i].wrench.force.norm() > 0);
        }
        ASSERT_LE((sum - w.force).norm(), 1e-9 * (1 + w.force.norm()));
    }
}

TEST(ContactScene, DampingOnlyTakesFromAHandThatGoesRound) {
    Rng rng(79);
    for (int round = 0; round < 20; ++round) {
        Scene scene = make_scene();
        for (std::uint32_t i = 0; i < 4; ++i) {
            ASSERT_TRUE(scene.add(
                {i, 1},
                Plane{.normal = to_plain(direction(rng)), .stiffness = 500.0 + 300 * i, .damping = 3}));
        }
        scene.settle();
        const SmallLoop loop(rng, 0.003 * direction(rng), 0.002);
        const double sum = work_along(loop, 20'000, [&](const Vector& p, const Vector& way) {
            return Vector(scene.evaluate(at(p, way / 1e-5), dt).force);
        });
        EXPECT_LE(sum, 1e-8) << "the hand must not gain; round " << round;
    }
}
