// The tangential stage in a whole scene: friction on the joint contact, in corners, through changes; planes
// whose forces are summed; moving planes; the braking pulse.

#include <functional>

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

/// Moves the hand in a straight line, a step each cycle, and returns the last wrench.
Wrench stroke(Scene& scene, const Vector& from, const Vector& to, int cycles) {
    Wrench last;
    for (int i = 1; i <= cycles; ++i) {
        const Vector p = from + (to - from) * (static_cast<double>(i) / cycles);
        last = scene.evaluate(at(p, (to - from) / (cycles * dt)), dt);
    }
    return last;
}

const Plane floor_with(Friction friction) {
    return {.normal = {0, 0, 1}, .stiffness = 1000, .friction = friction};
}

}  // namespace

TEST(Tangential, AVertexHoldsWithoutFriction) {
    Scene scene = make_scene();
    for (std::uint32_t i = 0; i < 3; ++i) {
        Vec3 n{};
        (&n.x)[i] = 1;
        ASSERT_TRUE(scene.add({i, 1}, Plane{.normal = n, .stiffness = 1000, .friction = {.dynamic = 0.5}}));
    }
    scene.settle();
    const Vector deep(-0.001, -0.002, -0.003);
    const Wrench w = stroke(scene, deep, deep + Vector(0.0005, 0, 0), 100);
    EXPECT_NEAR((w.force - Vector(0.5, 2, 3)).norm(), 0, 1e-9);
}

TEST(Tangential, SlidingIntoACornerMakesNoJump) {
    // The second plane removes a direction; the force along it decays over 10 ms: at most a tenth of it in 1
    // ms.
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000, .friction = {.dynamic = 1}}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {-1, 0, 0}, .offset = -0.02, .stiffness = 1000}));
    scene.settle();
    Vector last = Vector::Zero();
    for (int i = 0; i < 400; ++i) {
        const Vector p(1e-4 * i, 0, -0.002);
        const Vector force = scene.evaluate(at(p, {0.1, 0, 0}), dt).force;
        if (i > 50) {
            EXPECT_LE((force - last).norm(), 1000 * 1e-4 + 0.2 + 1e-9) << i;
        }
        last = force;
    }
}

TEST(Tangential, FrictionThatChangesIsCrossFadedLikeEverythingElse) {
    constexpr double time = 0.02;
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, floor_with({.dynamic = 0.8})));
    scene.settle();
    Vector last = stroke(scene, {0, 0, -0.002}, {0.02, 0, -0.002}, 200).force;
    Plane ice = floor_with({.dynamic = 0.1});
    ice.recovery = time;
    ASSERT_TRUE(scene.update({0, 1}, ice));
    for (int i = 1; i <= 40; ++i) {
        const Vector force = scene.evaluate(at({0.02 + 1e-4 * i, 0, -0.002}, {0.1, 0, 0}), dt).force;
        EXPECT_LE((force - last).norm(), (0.8 - 0.1) * 2 * dt / time + 1e-9) << i;
        last = force;
    }
    EXPECT_NEAR(last.x(), -0.2, 1e-9);
}

TEST(Tangential, RemovingARubbingSurfaceFadesItsFrictionToo) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, floor_with({.dynamic = 0.8})));
    scene.settle();
    Vector last = stroke(scene, {0, 0, -0.002}, {0.02, 0, -0.002}, 200).force;
    ASSERT_TRUE(scene.remove({0, 1}));
    const double whole = last.norm();
    for (int i = 1; i <= 20; ++i) {
        const Vector force = scene.evaluate(at({0.02 + 1e-4 * i, 0, -0.002}, {0.1, 0, 0}), dt).force;
        EXPECT_LE((force - last).norm(), whole * dt / 0.01 + 1e-9) << i;
        last = force;
    }
    EXPECT_EQ(last.norm(), 0.0);
}

TEST(Tangential, ADistantTouchStartsWithoutAnAnchorOfTheLastOne) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, floor_with({.static_ = 2, .dynamic = 1})));
    scene.settle();
    stroke(scene, {0, 0, -0.002}, {0.001, 0, -0.002}, 20);
    scene.evaluate(at({0.001, 0, 0.01}), dt);
    EXPECT_NEAR(scene.evaluate(at({0.5, 0, -0.002}), dt).force.x(), 0.0, 1e-12);
}

TEST(Tangential, AMovingTableIsFeltBetweenUpdatesAndCarriesTheHand) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(
        {0, 1},
        Plane{.velocity = {0.1, 0, 0.01}, .stiffness = 1000, .friction = {.static_ = 1, .dynamic = 0.5}}));
    scene.settle();
    // In the cycle that adopts it the table is at the stated place, then it moves.
    EXPECT_NEAR(scene.evaluate(at({0, 0, -0.001}), dt).force.z(), 1.0, 1e-12);
    Wrench w;
    for (int i = 0; i < 100; ++i) w = scene.evaluate(at({0, 0, -0.001}), dt);
    EXPECT_NEAR(w.force.z(), 1.0 + 1000 * 0.1 * 0.01, 1e-9);
    EXPECT_NEAR(w.force.x(), 0.5 * w.force.z(), 1e-9);  // dragged along, sliding
}

TEST(Summed, TheyFadeAndDampAndRubLikeAnyOther) {
    Scene scene = make_scene({.max_force = 8.5});
    ASSERT_TRUE(scene.add(
        {0, 1},
        Plane{.stiffness = 500, .damping = 5, .combine = PlaneCombine::sum, .friction = {.dynamic = 0.5}}));
    const Probe probe = at({0, 0, -0.004}, {0, 0, -0.1});
    double last = 0;
    for (int i = 0; i < 15; ++i) {
        const double force = scene.evaluate(probe, dt).force.z();
        EXPECT_LE(force - last, (2.0 + 0.5) * dt / 0.01 + 1e-9);
        last = force;
    }
    EXPECT_NEAR(last, 2.5, 1e-12);
    const Wrench w = stroke(scene, {0, 0, -0.004}, {0.05, 0, -0.004}, 300);
    EXPECT_NEAR(w.force.x(), -1.0, 1e-9);
    std::array<Feedback, 4> felt;
    ASSERT_EQ(scene.feedback(felt), 1u);
    EXPECT_NEAR((felt[0].wrench.force - w.force).norm(), 0, 1e-9);
    EXPECT_TRUE(felt[0].flags & Feedback::touching);
}

TEST(Braking, APulseTakesTheEntrysMomentumOncePerContact) {
    Scene scene = make_scene({.mass = 0.1});
    ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 1000, .braking = 0.5}));
    scene.settle();
    for (int i = 0; i < 30; ++i) scene.evaluate(at({0, 0, 0.001}, {0, 0, -0.2}), dt);
    double impulse = 0;
    for (int i = 0; i < 20; ++i)
        impulse += scene.evaluate(at({0, 0, -0.001}, {0, 0, -0.2}), dt).force.z() * dt;
    EXPECT_NEAR(impulse - 1.0 * 20 * dt, 0.5 * 0.1 * 0.2, 1e-6);
    // Out for 5 ms and in again: not re-armed. Out for 25 ms: it is.
    for (int i = 0; i < 5; ++i) scene.evaluate(at({0, 0, 0.001}, {0, 0, -0.2}), dt);
    EXPECT_NEAR(scene.evaluate(at({0, 0, -0.001}, {0, 0, -0.2}), dt).force.z(), 1.0, 1e-12);
    for (int i = 0; i < 25; ++i) scene.evaluate(at({0, 0, 0.001}, {0, 0, -0.2}), dt);
    EXPECT_GT(scene.evaluate(at({0, 0, -0.001}, {0, 0, -0.2}), dt).force.z(), 3.0);
}

TEST(Texture, IsTheGradientOfItsRelief) {
    // One plane with a texture is conservative: closed loops, press included, return their work.
    Scene scene = make_scene();
    ASSERT_TRUE(
        scene.add({0, 1}, Plane{.stiffness = 1000, .texture = {.amplitude = 2e-4, .wavelength = 2e-3}}));
    scene.settle();
    double work = 0;
    constexpr int steps = 20000;
    Vector before(0.0015, 0, -0.002);
    Vector last = scene.evaluate(at(before), dt).force;
    for (int i = 1; i <= steps; ++i) {
        const double phase = 2 * M_PI * i / steps;
        const Vector p(0.0015 * std::cos(phase), 0.001 * std::sin(phase), -0.002 + 0.001 * std::sin(phase));
        const Vector force = scene.evaluate(at(p), dt).force;
        work += 0.5 * (force + last).dot(p - before);
        before = p;
        last = force;
    }
    EXPECT_NEAR(work, 0, 1e-8);
}

TEST(Texture, FinerThanTwoCountsOfTheEncoderItIsNotFelt) {
    for (const double metre : {1.0, 0.02, 100.0}) {
        const auto sideways = [&](double wavelength) {
            Scene scene = make_scene({.resolution = 3e-5 * metre, .metre = metre});
            const Texture texture{.amplitude = 1e-6 * metre, .wavelength = wavelength * metre};
            EXPECT_TRUE(scene.add({0, 1}, Plane{.stiffness = 1000 / metre, .texture = texture}));
            scene.settle();
            return scene.evaluate(at({0.25 * wavelength * metre, 0, -0.001 * metre}), dt).force.x();
        };
        EXPECT_GT(sideways(6.1e-5), 0.05) << metre;
        EXPECT_EQ(sideways(5.9e-5), 0) << metre;
    }
}

/// The net work (J) of a closed loop around `about` (m) that stays in contact.
double work_of_loop(Scene& scene, const std::function<Vector(double)>& place) {
    constexpr int steps = 4000;
    constexpr double step = 2 * M_PI / steps;
    double work = 0;
    for (int i = 0; i < steps; ++i) {  // of a closed loop, for which equal weights are best
        const Vector way =
            (place((i + 0.5) * step) - place((i - 0.5) * step)) / (2 * std::sin(step / 2)) * step;
        work += scene.evaluate(at(place(i * step)), dt).force.dot(way);
    }
    return work;
}

Texture any_texture(Rng& rng, int pattern) {
    return {.amplitude = 5e-5,
            .wavelength = uniform(rng, 2e-3, 6e-3),
            .direction = to_plain(direction(rng)),
            .origin = to_plain(0.01 * direction(rng)),
            .pattern = static_cast<TexturePattern>(pattern)};
}

TEST(Texture, OnAPlaneThatLeansAgainstItsDirectionItMakesNoWorkEither) {
    const std::uint64_t seed = 64;
    Rng rng(seed);
    double worst = 0;
    for (int run = 0; run < (long_form() ? 300 : 60); ++run) {
        const Vector n = direction(rng), a = n.unitOrthogonal(), b = n.cross(a);
        const double radius = run % 2 ? 0.004 : 0;
        Scene scene = make_scene();
        ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = radius}));
        ASSERT_TRUE(scene.add(
            {0, 1},
            Plane{.normal = to_plain(n), .stiffness = 1000, .texture = any_texture(rng, run / 2 % 3)}));
        scene.settle();
        const double work = work_of_loop(scene, [&](double angle) -> Vector {
            return (radius - 1.5e-3 + 1e-3 * std::sin(3 * angle)) * n + 5e-3 * std::cos(angle) * a +
                   3e-3 * std::sin(angle) * b;
        });
        worst = std::max(worst, std::abs(work));
        ASSERT_LE(std::abs(work), 1e-9) << "J; seed " << seed << " run " << run;
    }
    std::printf("most work in a loop on a plane %.2g J\n", worst);
}

TEST(Texture, OnASphereItMakesTheWorkThatTheManualStates) {
    // The slope is that at the foot, which moves farther than a hand deep inside.
    const std::uint64_t seed = 65;
    Rng rng(seed);
    double worst = 0;
    for (int run = 0; run < (long_form() ? 300 : 60); ++run) {
        Scene scene = make_scene();
        ASSERT_TRUE(scene.add(
            {0, 1}, Sphere{.radius = 0.03, .stiffness = 1000, .texture = any_texture(rng, run % 3)}));
        scene.settle();
        const Vector n = direction(rng), a = n.unitOrthogonal(), b = n.cross(a);
        worst = std::max(worst, std::abs(work_of_loop(scene, [&](double angle) -> Vector {
                             const Vector way = n + 0.17 * std::cos(angle) * a + 0.1 * std::sin(angle) * b;
                             return (0.0285 + 1e-3 * std::sin(3 * angle)) * way.normalized();
                         })));
    }
    std::printf("most work in a loop on a sphere %.2g J\n", worst);
    EXPECT_LE(worst, 1.2e-3);
}
