// A surface that holds in silence stands still, and its force follows: the velocity in its friction, damping
// and texture fades out, and returns when the application does.

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <generators.hpp>
#include <gtest/gtest.h>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace held_velocity_tests {
namespace {

constexpr double k = 500;                  // N/m
constexpr double gone = 0.1, back = 0.05;  // s, in which the velocity fades out and returns
constexpr double depth = 0.001;            // m, of a hand at the origin
const Vector hand(0, 0, 0);

const Mesh& cube() {  // 8 cm
    static const auto mesh = [] {
        const MadeMesh made = knurl::test::cube(4, 0.08);
        return std::make_unique<Mesh>(
            Triangles{.vertices = made.vertices, .triangles = made.triangles, .materials = {}}, MeshBuild{});
    }();
    return *mesh;
}
const HeightField& plain() {  // 8 cm, flat
    static const HeightField field(
        std::vector<float>(9 * 9, 0.0f),
        {.columns = 9, .rows = 9, .dx = 0.01, .dy = 0.01, .corner = {-0.04, -0.04, 0}});
    return field;
}

/// A surface with its top at `top`, moving with `velocity`.
struct Named {
    std::string name;
    std::function<Verdict(Scene&, const Vec3& top, const Vec3& velocity, const AddOptions&)> add;
};

/// `put(params, top)` puts it there.
template <class R, class Put>
Named named(std::string name, const R& params, Put put) {
    const auto at = [=](const Vec3& top, const Vec3& velocity) {
        R there = params;
        put(there, top);
        there.velocity = velocity;
        there.stiffness = k;
        there.damping = 8;
        there.friction.viscous = 3;
        return there;
    };
    return {std::move(name),
            [=](Scene& scene, const Vec3& top, const Vec3& velocity, const AddOptions& options) {
                return scene.add({0, 1}, at(top, velocity), options);
            }};
}

Vec3 below(const Vec3& top, double way) {
    return {top.x, top.y, top.z - way};
}

std::vector<Named> all_kinds() {
    const auto offset = [](auto& params, const Vec3& top) { params.offset = top.z; };
    const auto centre = [](double way) {
        return [=](auto& params, const Vec3& top) { params.center = below(top, way); };
    };
    const auto position = [](double way) {
        return [=](Shape& shape, const Vec3& top) { shape.position = below(top, way); };
    };
    Polygon square;
    square.vertices = {.at = {{-0.04, -0.04, 0}, {0.04, -0.04, 0}, {0.04, 0.04, 0}, {-0.04, 0.04, 0}},
                       .count = 4};
    return {
        named("plane", Plane{}, offset),
        named("plane by sum", Plane{.combine = PlaneCombine::sum}, offset),
        named("plane that recovers", Plane{.recovery = 0, .update = PlaneUpdate::paper}, offset),
        named("cap", Cap{.curvature = -20}, [](Cap& cap, const Vec3& top) { cap.foot = top; }),
        named("half plane", HalfPlane{},
              [](HalfPlane& half, const Vec3& top) { half.offset = top.z, half.edge_offset = top.x + 0.04; }),
        named("polygon", square,
              [](Polygon& polygon, const Vec3& top) {
                  for (Vec3& corner : polygon.vertices.at)
                      corner = {corner.x + top.x, corner.y + top.y, corner.z + top.z};
              }),
        named("box", Box{.half_size = {0.04, 0.04, 0.04}}, centre(0.04)),
        named("sphere", Sphere{.radius = 0.04}, centre(0.04)),
        named("capsule", Capsule{.axis = {1, 0, 0}, .half_length = 0.02, .radius = 0.04}, centre(0.04)),
        named("cylinder", Cylinder{.radius = 0.04, .half_length = 0.04}, centre(0.04)),
        named("torus", Torus{.radius = 0.06, .tube = 0.02},
              [](Torus& ring, const Vec3& top) {
                  ring.center = {top.x + 0.06, top.y, top.z - 0.02};
              }),
        named("mesh", Shape{.asset = 1}, position(0.04)),
        named("height field", Shape{.asset = 2}, position(0)),
    };
}

Scene scene_of(const Named& kind, const Vec3& top, const Vec3& velocity, OnSilence policy = OnSilence::hold) {
    Scene scene = make_scene();
    scene.set_asset(1, &cube());
    scene.set_asset(2, &plain());
    const Verdict verdict = kind.add(scene, top, velocity, {.on_silence = policy});
    EXPECT_TRUE(verdict) << kind.name;
    return scene;
}

/// A moving surface under a hand at rest, which came from above.
struct Moving {
    Scene scene;
    Vec3 top, velocity;
    double moved = 0, silent = 0;  // s

    Moving(const Named& kind, const Vec3& from, const Vec3& speed)
        : scene(scene_of(kind, from, speed)), top(from), velocity(speed) {
        scene.evaluate(at({hand.x(), hand.y(), from.z + 0.002}), dt);
        for (int i = 0; i < 100; ++i) feel(false);
        scene.settle();
    }
    Vector feel(bool silence) {
        silent = silence ? silent + dt : 0;
        if (!silence) moved += dt;
        scene.set_silence(silent);
        return scene.evaluate(at(hand), dt).force;
    }
    Vec3 there() const {
        return {top.x + moved * velocity.x, top.y + moved * velocity.y, top.z + moved * velocity.z};
    }
};

/// The same one, at rest there.
Vector at_rest(const Named& kind, const Vec3& top) {
    Scene scene = scene_of(kind, top, {});
    scene.evaluate(at({hand.x(), hand.y(), top.z + 0.002}), dt);
    Vector force = Vector::Zero();
    for (int i = 0; i < 200; ++i) force = scene.evaluate(at(hand), dt).force;
    return force;
}

}  // namespace

// Along it and against it: viscous friction and damping.
TEST(HeldVelocity, OfWhatStandsStillInASilenceTheHandFeelsNoMotionAndOnTheWayThereNoStep) {
    const Vec3 velocity{0.05, 0, 0.01};
    for (const Named& kind : all_kinds()) {
        SCOPED_TRACE(kind.name);
        Moving moving(kind, {-0.005, 0, depth - 0.001}, velocity);
        const Vector before = moving.feel(false), stands = at_rest(kind, moving.there());
        const Vector share = stands - before;
        ASSERT_GT(std::abs(share.x()), 0.1) << "N: it rubs";
        ASSERT_GT(std::abs(share.z()), 0.05) << "N: it is damped";
        // By |F_new - F_old| dt / T in each cycle.
        for (int i = 1; i <= 100; ++i)
            ASSERT_LE((moving.feel(true) - (before + i * dt / gone * share)).norm(), 1e-9) << i;
        for (int i = 0; i < 50; ++i) ASSERT_LE((moving.feel(true) - stands).norm(), 1e-9) << i;
        // The application returns: the surface moves on from there, and its velocity returns gradually.
        Vector last = stands;
        for (int i = 1; i <= 50; ++i) {
            const Vector force = moving.feel(false), rests = at_rest(kind, moving.there());
            ASSERT_LE((force - last).norm(), share.norm() * 1.1 * dt / back + k * 0.06 * dt) << i;
            if (i == 25) {
                EXPECT_NEAR((force - rests).x(), -share.x() / 2, 0.1 * std::abs(share.x()));
            }
            last = force;
        }
        EXPECT_NEAR((last - at_rest(kind, moving.there())).x(), -share.x(), 0.05 * std::abs(share.x()));
    }
}

// A disc under the hand: the velocity at the place of contact counts, not the disc's own.
TEST(HeldVelocity, WhatTurnsComesToRestToo) {
    Shape disc{
        .asset = 1, .position = {0.02, 0, -0.04 + depth}, .angular_velocity = {0, 0, 3}, .stiffness = k};
    disc.friction.viscous = 3;
    Scene scene = make_scene();
    scene.set_asset(1, &cube());
    ASSERT_TRUE(scene.add({0, 1}, disc, {.on_silence = OnSilence::hold}));
    scene.evaluate(at({0, 0, 0.002}), dt);
    for (int i = 0; i < 50; ++i) scene.evaluate(at(hand), dt);
    const Vector before = scene.evaluate(at(hand), dt).force;
    EXPECT_NEAR(before.y(), -3 * 3 * 0.02, 1e-6);
    for (int i = 1; i <= 150; ++i) {
        scene.set_silence(i * dt);
        ASSERT_NEAR(scene.evaluate(at(hand), dt).force.y(), std::max(0.0, 1 - i * dt / gone) * before.y(),
                    1e-9)
            << i;
    }
}

// The hand rests on a belt and is dragged along, at N times the friction against its resistance.
TEST(HeldVelocity, AHandThatRestsOnABeltIsDraggedNoMore) {
    Plane belt{.offset = depth, .velocity = {0.05, 0, 0}, .stiffness = k};
    belt.friction.dynamic = 1;
    for (const OnSilence policy : {OnSilence::hold, OnSilence::move}) {
        Scene scene = make_scene();
        ASSERT_TRUE(scene.add({0, 1}, belt, {.on_silence = policy, .silence_time = 10}));
        Vector at_hand = hand, last = Vector::Zero();
        const auto drag = [&](double silence, int cycles) {
            const double from = at_hand.x();
            for (int i = 1; i <= cycles; ++i) {
                scene.set_silence(silence > 0 ? silence + i * dt : 0);
                last = scene.evaluate(at(at_hand), dt).force;
                at_hand.x() += dt * last.x() / 20;  // N s/m
            }
            return at_hand.x() - from;
        };
        drag(0, 200);
        EXPECT_NEAR(last.x(), 0.5, 1e-6) << "N";
        EXPECT_NEAR(drag(0, 100), 0.0025, 1e-6) << "m";
        drag(1e-9, 300);
        const double way = drag(0.3, 500);
        if (policy == OnSilence::hold) {
            EXPECT_LT(way, 1e-5) << "m";
            EXPECT_LT(std::abs(last.x()), 1e-3) << "N";
        } else {
            EXPECT_NEAR(way, 0.0125, 1e-6) << "whoever moves on drags on";
        }
    }
}

// A texture too fine for its speed appears as the surface stops, gradually as well.
TEST(HeldVelocity, ATextureThatWasTooFastIsFeltWhereItStandsWithoutAStep) {
    Plane plane{.offset = depth, .velocity = {0.1, 0, 0}, .stiffness = k};
    plane.texture = {.amplitude = 2e-6, .wavelength = 2e-4, .direction = {1, 0, 0}, .origin = {5e-5, 0, 0}};
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, plane, {.on_silence = OnSilence::hold}));
    Vector before = Vector::Zero();
    for (int i = 0; i < 50; ++i) before = scene.evaluate(at(hand), dt).force;
    EXPECT_EQ(before.x(), 0);
    std::vector<Vector> felt{before};
    for (int i = 1; i <= 150; ++i) {
        scene.set_silence(i * dt);
        felt.push_back(scene.evaluate(at(hand), dt).force);
    }
    const Vector all = felt.back() - before;
    ASSERT_GT(std::abs(all.x()), 0.02) << "N";
    for (std::size_t i = 1; i < felt.size(); ++i)
        ASSERT_LE((felt[i] - felt[i - 1]).norm(), 1.05 * all.norm() * dt / gone) << i;
}

TEST(HeldVelocity, WhateverTheSilenceNoCycleChangesTheForceByMore) {
    const std::uint64_t seed = 77;
    Rng rng(seed);
    for (const Named& kind : all_kinds()) {
        SCOPED_TRACE(kind.name + ", seed " + std::to_string(seed));
        Moving moving(kind, {-0.005, 0, depth}, {0.05, 0, 0});
        Vector last = moving.feel(false);
        bool silence = false;
        for (int i = 0; i < 200; ++i) {
            if (between(rng, 0, 9) == 0) silence = !silence;
            const Vector force = moving.feel(silence);
            // Damping and viscous friction times velocity, in the shorter time; and what its motion itself
            // does.
            ASSERT_LE((force - last).norm(), (8 + 3) * 0.05 * dt / back + k * 0.05 * dt) << i;
            last = force;
        }
    }
}

}  // namespace held_velocity_tests
