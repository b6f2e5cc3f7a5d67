// A surface that holds in silence stays where it is, and still tracks the hand. For a surface that stands
// still, the silence changes nothing.

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <generators.hpp>
#include <gtest/gtest.h>

#include <knurl/geometry/mesh.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace held_in_silence_tests {
namespace {

constexpr double k = 500;  // N/m

std::unique_ptr<Mesh> mesh_of(const MadeMesh& shape) {
    return std::make_unique<Mesh>(
        Triangles{.vertices = shape.vertices, .triangles = shape.triangles, .materials = {}},
        MeshBuild{.exact = true});
}

const Mesh& sheet() {  // 4 cm, felt from both sides
    static const std::unique_ptr<Mesh> mesh = mesh_of(two_sided_sheet());
    return *mesh;
}
const Mesh& cube() {  // 4 cm
    static const std::unique_ptr<Mesh> mesh = mesh_of(knurl::test::cube(4, 0.04));
    return *mesh;
}

struct Named {
    std::string name;
    std::function<bool(Scene&)> add;
};
template <class R>
Named named(std::string name, const R& surface) {
    return {std::move(name), [=](Scene& scene) {
                return bool(scene.add({0, 1}, surface, {.on_silence = OnSilence::hold}));
            }};
}

Polygon square(Sides sides) {
    Polygon polygon{.stiffness = k, .sides = sides};
    polygon.vertices = {.at = {{-0.02, -0.02, 0}, {0.02, -0.02, 0}, {0.02, 0.02, 0}, {-0.02, 0.02, 0}},
                        .count = 4};
    return polygon;
}

/// In z = 0, up to x = 20 mm, two-sided.
const std::vector<Named>& plates() {
    static const std::vector<Named> all{
        named("mesh", Shape{.asset = 1, .stiffness = k}),
        named("half plane", HalfPlane{.edge_offset = 0.02, .stiffness = k, .sides = Sides::both}),
        named("polygon", square(Sides::both)),
        named("box", Box{.half_size = {0.02, 0.02, 0}, .stiffness = k}),
    };
    return all;
}

/// Solids about the origin and pieces, 4 cm large.
std::vector<Named> all_kinds() {
    std::vector<Named> all = plates();
    const auto add = [&](const char* name, const auto& surface) { all.push_back(named(name, surface)); };
    add("cube as a mesh", Shape{.asset = 2, .stiffness = k});
    add("box", Box{.half_size = {0.02, 0.015, 0.01}, .stiffness = k});
    add("hollow box", Box{.half_size = {0.02, 0.015, 0.01}, .side = Side::inside, .stiffness = k});
    add("polygon from the front", square(Sides::front));
    add("half plane from the front", HalfPlane{.stiffness = k});
    add("sphere", Sphere{.radius = 0.02, .stiffness = k});
    add("capsule", Capsule{.axis = {1, 0, 0}, .half_length = 0.01, .radius = 0.01, .stiffness = k});
    add("cylinder", Cylinder{.radius = 0.02, .half_length = 0.01, .stiffness = k});
    add("torus", Torus{.radius = 0.02, .tube = 0.01, .stiffness = k});
    add("plane", Plane{.stiffness = k});
    add("plane that recovers", Plane{.stiffness = k, .update = PlaneUpdate::paper});
    add("cap", Cap{.curvature = -20, .stiffness = k});
    return all;
}

Scene scene_of(const Named& surface) {
    Scene scene = make_scene();
    scene.set_asset(1, &sheet());
    scene.set_asset(2, &cube());
    EXPECT_TRUE(surface.add(scene)) << surface.name;
    return scene;
}

/// The same surface twice, both at rest: one scene falls silent.
struct Twins {
    Scene silent, twin;
    int cycles = 0, fell = 0;
    Vector hand;

    Twins(const Named& surface, const Vector& start)
        : silent(scene_of(surface)), twin(scene_of(surface)), hand(start) {}
    void fall_silent() { fell = cycles; }
    /// The force there; NaN, and a failure, if the silence makes a difference.
    Vector at_hand(const Vector& p, double radius = 0) {
        hand = p;
        ++cycles;
        silent.set_silence(fell > 0 ? (cycles - fell) * dt : 0);
        Probe probe = at(p);
        probe.radius = radius;
        const Wrench got = silent.evaluate(probe, dt), want = twin.evaluate(probe, dt);
        if (same_bits(got, want)) return got.force;
        ADD_FAILURE() << "cycle " << cycles << ": " << got.force.transpose() << " instead of "
                      << want.force.transpose();
        return Vector::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    /// A tenth of a millimetre per cycle, through all these stops. Returns the largest force on the way (N).
    double go(std::initializer_list<Vector> stops) {
        double most = 0;
        for (const Vector& to : stops) {
            const Vector from = hand;
            const int steps = 1 + static_cast<int>((to - from).norm() / 1e-4);
            for (int i = 1; i <= steps; ++i) {
                const double felt = at_hand(from + static_cast<double>(i) / steps * (to - from)).norm();
                if (!(felt <= most)) most = felt;
                if (std::isnan(most)) return most;
            }
        }
        return most;
    }
};

}  // namespace

TEST(HeldInSilence, AHandThatGoesRoundAnEdgeInFreeAirFeelsNothing) {
    for (const Named& plate : plates()) {
        SCOPED_TRACE(plate.name);
        Twins scenes(plate, {0.01, 0.001, 0.006});
        EXPECT_EQ(scenes.go({{0.01, 0.001, 0.005}}), 0);
        scenes.fall_silent();
        ASSERT_EQ(scenes.go({{0.025, 0.001, 0.005}, {0.025, 0.001, -0.005}, {0.005, 0.001, -0.005}}), 0);
        // There the far side acts, as always.
        EXPECT_EQ(scenes.go({{0.005, 0.001, -0.0001}}), 0);
        scenes.go({{0.005, 0.001, 0.002}});
        EXPECT_LE((scenes.at_hand({0.005, 0.001, 0.002}) - Vector(0, 0, -k * 0.002)).norm(), 1e-12);
    }
}

TEST(HeldInSilence, AHandThatSlidesOverAnEdgeIsLetGo) {
    for (const Named& plate : plates()) {
        SCOPED_TRACE(plate.name);
        Twins scenes(plate, {0.01, 0.001, 0.001});
        scenes.go({{0.01, 0.001, -0.002}});
        EXPECT_LE((scenes.at_hand({0.01, 0.001, -0.002}) - Vector(0, 0, k * 0.002)).norm(), 1e-12);
        scenes.fall_silent();
        EXPECT_NEAR(scenes.go({{0.0199, 0.001, -0.002}}), k * 0.002, 1e-12);
        scenes.go({{0.025, 0.001, -0.002}});
        EXPECT_EQ(scenes.go({{0.026, 0.001, -0.002}, {0.01, 0.001, -0.002}}), 0) << "below it again";
    }
}

// Through the surfaces, in and out of reach, while silences begin and end.
TEST(HeldInSilence, WhatStandsStillIsNotFeltAnyDifferentWhereverTheHandGoes) {
    const std::uint64_t seed = 2134;
    Rng rng(seed);
    for (const Named& surface : all_kinds()) {
        SCOPED_TRACE(surface.name + ", seed " + std::to_string(seed));
        int felt = 0;
        for (int round = 0; round < (long_form() ? 500 : 20); ++round) {
            Twins scenes(surface, uniform(rng, 0, 0.05) * direction(rng));
            const double radius = between(rng, 0, 1) ? uniform(rng, 0, 0.005) : 0;
            for (Scene* scene : {&scenes.silent, &scenes.twin})
                ASSERT_TRUE(scene->place_probe(0, {.offset = {}, .radius = radius}));
            for (int leg = 0; leg < 20; ++leg) {
                if (between(rng, 0, 1))
                    scenes.fall_silent();
                else
                    scenes.fell = 0;
                const double most = scenes.go({uniform(rng, 0, 0.04) * direction(rng)});
                ASSERT_FALSE(std::isnan(most)) << "round " << round;
                felt += most > 0;
            }
        }
        EXPECT_GT(felt, 20);
    }
}

/// `surface` lies 1 mm below a hand at the origin, and rises.
template <class R>
void rises(const std::string& name, R surface) {
    SCOPED_TRACE(name);
    surface.velocity = {0, 0, 0.1};
    surface.stiffness = k;
    Scene scene = scene_of(named(name, surface));
    scene.settle();
    double moved = 0;  // s, without the silence
    for (int cycle = 0; cycle < 200; ++cycle) {
        const bool silent = cycle >= 40 && cycle < 140;
        scene.set_silence(silent ? (cycle - 39) * dt : 0);
        if (cycle > 0 && !silent) moved += dt;
        const double depth = 0.1 * moved - 0.001, force = scene.evaluate(at(Vector::Zero()), dt).force.z();
        ASSERT_NEAR(force, k * std::max(0.0, depth), 1e-9) << cycle;
    }
}

TEST(HeldInSilence, WhatMovesStaysWhereItIsAndGoesOnAfterIt) {
    const Vec3 below = {0, 0, -0.021};
    rises("plane", Plane{.offset = -0.001});
    rises("plane that recovers", Plane{.offset = -0.001, .update = PlaneUpdate::paper});
    rises("cap", Cap{.foot = {0, 0, -0.001}, .curvature = -20});
    rises("half plane", HalfPlane{.offset = -0.001, .edge_offset = 0.02});
    Polygon polygon = square(Sides::front);
    for (Vec3& corner : polygon.vertices.at) corner.z = -0.001;
    rises("polygon", polygon);
    rises("box", Box{.center = below, .half_size = {0.02, 0.02, 0.02}});
    rises("sphere", Sphere{.center = below, .radius = 0.02});
    rises("capsule", Capsule{.center = below, .axis = {1, 0, 0}, .half_length = 0.01, .radius = 0.02});
    rises("cylinder", Cylinder{.center = below, .radius = 0.02, .half_length = 0.02});
    rises("torus", Torus{.center = {0.03, 0, -0.021}, .radius = 0.03, .tube = 0.02});
    rises("mesh", Shape{.asset = 2, .position = below});
}

TEST(HeldInSilence, ATextureStaysWithItsSurface) {
    Scene scene = scene_of(named("plane", Plane{.velocity = {0.01, 0, 0},
                                                .stiffness = k,
                                                .texture = {.amplitude = 1e-4, .wavelength = 0.005}}));
    scene.settle();
    const auto feel = [&](double silence) {
        scene.set_silence(silence);
        return scene.evaluate(at({0, 0, -0.002}), dt).force;
    };
    for (int i = 0; i < 50; ++i) feel(0);
    const Vector last = feel(0), held = feel(dt);
    EXPECT_LE((held - last).norm(), 1e-12);
    for (int i = 2; i < 100; ++i) ASSERT_EQ((feel(i * dt) - held).norm(), 0);
    for (int i = 0; i < 50; ++i) feel(0);
    EXPECT_GT((feel(0) - held).norm(), 1e-3);
}

/// A silence neither stops nor delays a change that was under way when it began.
TEST(HeldInSilence, RecoveriesAndCrossFadesGoOn) {
    for (const PlaneUpdate update : {PlaneUpdate::fade, PlaneUpdate::paper, PlaneUpdate::last_depth}) {
        Plane plane{.stiffness = k, .recovery = 0.05, .update = update};
        Twins scenes(named("plane", plane), {0, 0, -0.001});
        for (Scene* scene : {&scenes.silent, &scenes.twin}) scene->settle();
        EXPECT_NEAR(scenes.at_hand({0, 0, -0.001}).z(), k * 0.001, 1e-12);
        plane.offset = 0.001;
        for (Scene* scene : {&scenes.silent, &scenes.twin}) ASSERT_TRUE(scene->update({0, 1}, plane));
        for (int i = 1; i <= 60; ++i) {
            if (i == 20) scenes.fall_silent();
            const double from = update == PlaneUpdate::paper ? 0 : 0.001, share = i < 50 ? i / 50.0 : 1;
            EXPECT_NEAR(scenes.at_hand({0, 0, -0.001}).z(), k * (from + share * (0.002 - from)), 1e-9) << i;
        }
    }
}

/// Both sets of a fade track the hand.
TEST(HeldInSilence, AFadeThatWasUnderWayLetsGoOverAnEdge) {
    Box box{.half_size = {0.02, 0.02, 0.01}, .stiffness = k, .recovery = 0.3};
    Twins scenes(named("box", box), {0.015, 0, 0.011});
    for (Scene* scene : {&scenes.silent, &scenes.twin}) scene->settle();
    EXPECT_NEAR(scenes.go({{0.015, 0, 0.008}}), k * 0.002, 1e-9);
    box.center.z = 0.001;
    for (Scene* scene : {&scenes.silent, &scenes.twin}) ASSERT_TRUE(scene->update({0, 1}, box));
    scenes.go({{0.016, 0, 0.008}});
    scenes.fall_silent();
    EXPECT_GT(scenes.go({{0.0199, 0, 0.008}}), k * 0.002);
    scenes.go({{0.021, 0, 0.008}});
    EXPECT_EQ(scenes.go({{0.022, 0, 0.008}, {0.022, 0, -0.02}}), 0);
}

}  // namespace held_in_silence_tests
