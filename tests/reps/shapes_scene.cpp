// A mesh as a surface among others: what the scene does with the point that holds the hand.

#include <cmath>
#include <memory>

#include <generators.hpp>
#include <gtest/gtest.h>

#include <knurl/geometry/mesh.hpp>

#include "count_allocations.hpp"
#include "scene_tools.hpp"

namespace shapes_scene_tests {
namespace {

using knurl::AssetMaterial;
using knurl::Feedback;
using knurl::Mesh;
using knurl::Plane;
using knurl::Probe;
using knurl::Quat;
using knurl::Scene;
using knurl::Shading;
using knurl::Triangles;
using knurl::Vec3;
using knurl::Wrench;
using knurl::test::dt;
using Vector = Eigen::Vector3d;

std::unique_ptr<Mesh> mesh_of(const knurl::test::MadeMesh& shape, std::vector<std::uint8_t> materials = {}) {
    return std::make_unique<Mesh>(
        Triangles{.vertices = shape.vertices, .triangles = shape.triangles, .materials = materials},
        knurl::MeshBuild{.exact = true});
}

Probe at(const Vector& p, double radius = 0) {
    Probe probe = knurl::test::at(p);
    probe.radius = radius;
    return probe;
}

/// A cube of 0.1 m about the origin, as asset 1, and a hand that comes down onto its top.
struct OnACube : testing::Test {
    std::unique_ptr<Mesh> cube = mesh_of(knurl::test::cube(8));
    Scene scene = knurl::test::make_scene();
    static constexpr knurl::RepresentationId id{0, 1};
    knurl::Shape shape{.asset = 1, .stiffness = 500, .recovery = 0.01};

    OnACube() { scene.set_asset(1, cube.get()); }
    /// From 10 mm above `to`, at 0.1 m/s.
    Wrench come_down(const Vector& to) {
        Wrench felt;
        for (int i = 100; i >= 0; --i) felt = scene.evaluate(at(to + Vector(0, 0, 1e-4 * i)), dt);
        return felt;
    }
    Wrench stay(const Vector& where, int cycles) {
        Wrench felt;
        for (int i = 0; i < cycles; ++i) felt = scene.evaluate(at(where), dt);
        return felt;
    }
};

void expect_near(const Vector& got, const Vector& wanted, double within) {
    EXPECT_LE((got - wanted).norm(), within) << got.transpose() << " instead of " << wanted.transpose();
}

}  // namespace

TEST_F(OnACube, TheHandIsHeldByTheSurfaceThatItCameTo) {
    ASSERT_TRUE(scene.add(id, shape));
    expect_near(come_down({0.01, 0.02, 0.048}).force, {0, 0, 500 * 0.002}, 1e-12);
    // Far beyond the middle of the solid: its top still holds it.
    expect_near(come_down({0.01, 0.02, -0.03}).force, {0, 0, 500 * 0.08}, 1e-11);
    EXPECT_NEAR(scene.contact_point().z(), 0.05, 1e-12);
}

TEST_F(OnACube, AHandThatIsInsideWhenItComesIsNotPushedOut) {
    stay({0, 0, 0.045}, 10);
    ASSERT_TRUE(scene.add(id, shape));
    expect_near(stay({0, 0, 0.045}, 50).force, Vector::Zero(), 0);
    stay({0, 0, 0.055}, 1);
    expect_near(come_down({0, 0, 0.048}).force, {0, 0, 1}, 1e-12);
}

TEST_F(OnACube, OutOfReachItIsNotEvenEvaluated) {
    ASSERT_TRUE(scene.add(id, shape));
    stay({0, 0, 0.3}, 20);
    EXPECT_EQ(scene.evaluated(), 0u);
    // ... and still acts when the hand arrives, at 10 m/s.
    scene.evaluate(at({0, 0, 0.1}), dt);
    scene.evaluate(at({0, 0, 0.06}), dt);
    expect_near(scene.evaluate(at({0, 0, 0.0495}), dt).force, {0, 0, 0.25}, 1e-12);
}

TEST_F(OnACube, ItSharesACornerWithAPlane) {
    ASSERT_TRUE(scene.add(id, shape));
    // A wall across the top: free where x >= 0.
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {1, 0, 0}, .offset = 0, .stiffness = 500}));
    stay({0.01, 0, 0.06}, 30);
    come_down({0.01, 0, 0.048});
    expect_near(stay({-0.003, 0, 0.048}, 2).force, {500 * 0.003, 0, 500 * 0.002}, 1e-11);
}

TEST_F(OnACube, ItIsFeltWhereItsPoseSays) {
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.4, Vector(1, 2, 3).normalized()));
    const Vector place(0.3, -0.2, 0.1);
    shape.position = knurl::to_plain(place);
    shape.orientation = {2 * turned.w(), 2 * turned.x(), 2 * turned.y(), 2 * turned.z()};
    ASSERT_TRUE(scene.add(id, shape));
    const Vector up = turned * Vector::UnitZ();
    const auto over = [&](double height) -> Vector {
        return place + turned * Vector(0.01, 0.02, 0.05 + height);
    };
    for (int i = 100; i >= -20; --i) scene.evaluate(at(over(1e-4 * i)), dt);
    expect_near(scene.evaluate(at(over(-0.002)), dt).force, 500 * 0.002 * up, 1e-11);
}

// 2 mm up and down at 1 to 20 Hz under a still hand: the force is within 1 % of the closed form.
TEST_F(OnACube, OneThatMovesUnderAStillHandIsNeverLost) {
    for (const double frequency : {1.0, 5.0, 20.0}) {
        Scene fresh = knurl::test::make_scene();
        fresh.set_asset(1, cube.get());
        shape.recovery = 0;
        double phase = 0;
        const auto lift = [&](double t) { return 0.002 * std::sin(2 * M_PI * frequency * t); };
        shape.position = {0, 0, lift(phase)};
        ASSERT_TRUE(fresh.add(id, shape));
        const Vector still(0.01, 0.02, 0.05 - 0.003);
        for (int i = 100; i > 0; --i) fresh.evaluate(at(still + Vector(0, 0, 1e-4 * i)), dt);
        double worst = 0;
        for (int cycle = 0; cycle < 2000; ++cycle) {
            const double t = cycle * dt, rate = 2 * M_PI * frequency;
            // Sent fifty times a period, with the velocity of that moment.
            const int every = static_cast<int>(1000 / (50 * frequency));
            if (cycle % every == 0) {
                shape.position = {0, 0, lift(t)};
                shape.velocity = {0, 0, 0.002 * rate * std::cos(rate * t)};
                ASSERT_TRUE(fresh.update(id, shape));
            }
            const Vector force = fresh.evaluate(at(still), dt).force;
            const double since = cycle % every * dt, from = t - since;
            const double there = lift(from) + since * 0.002 * rate * std::cos(rate * from);
            worst = std::max(worst, std::abs(force.z() / (500 * (0.003 + there)) - 1));
            ASSERT_GT(force.z(), 0) << frequency << " Hz, cycle " << cycle;
        }
        EXPECT_LT(worst, 0.01) << frequency << " Hz";
    }
}

TEST_F(OnACube, TurningOnItCarriesTheHandsFriction) {
    shape.friction = {.dynamic = 0.5};
    shape.angular_velocity = {0, 0, 2};
    ASSERT_TRUE(scene.add(id, shape));
    come_down({0.03, 0, 0.048});
    const Vector rubbed = stay({0.03, 0, 0.048}, 400).force;
    // The material under the hand moves towards +y, and so does what it drags along, up to the cone.
    EXPECT_NEAR(rubbed.y(), 0.5 * 500 * 0.002, 1e-3);
    EXPECT_NEAR(rubbed.z(), 1, 1e-9);
}

TEST_F(OnACube, ANewPoseIsNoJump) {
    ASSERT_TRUE(scene.add(id, shape));
    const Vector before = come_down({0, 0, 0.048}).force;
    shape.position = {0, 0, 0.004};
    shape.recovery = 0.02;
    ASSERT_TRUE(scene.update(id, shape));
    Vector last = before;
    const double change = 500 * 0.004;
    for (int i = 0; i < 20; ++i) {
        const Vector now = scene.evaluate(at({0, 0, 0.048}), dt).force;
        EXPECT_LE((now - last).norm(), change * dt / 0.02 * (1 + 1e-9)) << i;
        last = now;
    }
    expect_near(last, {0, 0, 500 * 0.006}, 1e-9);
}

TEST_F(OnACube, AnotherMeshInItsPlaceIsNoJumpEither) {
    const std::unique_ptr<Mesh> ball = mesh_of(knurl::test::icosphere(4, 0.051));
    scene.set_asset(2, ball.get());
    ASSERT_TRUE(scene.add(id, shape));
    const Vector where(0.001, 0.002, 0.048);
    const Vector before = come_down(where).force;
    shape.asset = 2;
    shape.recovery = 0.02;
    ASSERT_TRUE(scene.update(id, shape));
    Vector last = before, end;
    for (int i = 0; i < 40; ++i) {
        end = scene.evaluate(at(where), dt).force;
        EXPECT_LE((end - last).norm(), 0.2) << i;
        last = end;
    }
    // The ball's facets lie at most 0.3 mm within it.
    EXPECT_NEAR(end.norm(), 500 * (0.051 - where.norm()), 500 * 0.0003);
    EXPECT_GT(end.normalized().dot(where.normalized()), 0.99);
}

TEST_F(OnACube, AMaterialHasItsShareOfStiffnessAndFriction) {
    const knurl::test::MadeMesh shape_of = knurl::test::cube(8);
    std::vector<std::uint8_t> materials;
    for (std::size_t i = 0; i < shape_of.triangles.size(); ++i)
        materials.push_back(
            (shape_of.corner(i, 0) + shape_of.corner(i, 1) + shape_of.corner(i, 2)).x > 0 ? 1 : 0);
    const std::unique_ptr<Mesh> halves = mesh_of(shape_of, materials);
    halves->materials = {AssetMaterial{}, {.stiffness = 0.4, .damping = 1, .friction = 0.5}};
    scene.set_asset(3, halves.get());
    shape.asset = 3;
    shape.friction = {.dynamic = 0.5};
    ASSERT_TRUE(scene.add(id, shape));
    const auto drag_from = [&](double x) {
        come_down({x, 0, 0.048});
        Vector felt;
        for (int i = 0; i < 100; ++i) felt = scene.evaluate(at({x, 1e-4 * i, 0.048}), dt).force;
        stay({x, 0.0099, 0.06}, 5);
        return felt;
    };
    const Vector hard = drag_from(-0.02), soft = drag_from(0.02);
    expect_near(hard, {0, -0.5 * 1.0, 1.0}, 1e-9);
    expect_near(soft, {0, -0.25 * 0.4, 0.4}, 1e-9);
}

TEST_F(OnACube, SmoothShadingTurnsTheForceAndDecidesNoContact) {
    const std::unique_ptr<Mesh> coarse = mesh_of(knurl::test::icosphere(2, 0.1));
    scene.set_asset(4, coarse.get());
    shape.asset = 4;
    double flat_off = 0, smooth_off = 0;
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        Scene fresh = knurl::test::make_scene();
        fresh.set_asset(4, coarse.get());
        shape.shading = shading;
        ASSERT_TRUE(fresh.add(id, shape));
        double& off = shading == Shading::flat ? flat_off : smooth_off;
        int touched = 0;
        for (int i = 0; i < 400; ++i) {
            const double angle = i * 0.002;
            const Vector out(std::sin(angle), 0, std::cos(angle));
            const Vector force = fresh.evaluate(at((i == 0 ? 0.11 : 0.095) * out), dt).force;
            if (i == 0) continue;
            ASSERT_GT(force.norm(), 0) << i;
            ++touched;
            off = std::max(off, std::acos(std::min(1.0, force.normalized().dot(out))));
        }
        EXPECT_EQ(touched, 399);
    }
    RecordProperty("flat_degrees", std::to_string(flat_off * 180 / M_PI));
    EXPECT_LT(smooth_off, 0.25 * flat_off) << "rad, from the sphere's own normal";
}

TEST_F(OnACube, AFingerIsHeldByItsSkin) {
    ASSERT_TRUE(scene.add(id, shape));
    ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = 0.005}));
    expect_near(come_down({0, 0, 0.054}).force, {0, 0, 500 * 0.001}, 1e-12);
}

TEST_F(OnACube, WhatRefersToAnAssetIsKnownUntilItHasFaded) {
    ASSERT_TRUE(scene.add(id, shape));
    EXPECT_FALSE(scene.refers_to(*cube)) << "nothing is felt yet";
    come_down({0, 0, 0.048});
    EXPECT_TRUE(scene.refers_to(*cube));
    ASSERT_TRUE(scene.remove(id));
    stay({0, 0, 0.048}, 3);
    EXPECT_TRUE(scene.refers_to(*cube)) << "it fades for 10 ms";
    stay({0, 0, 0.048}, 12);
    EXPECT_FALSE(scene.refers_to(*cube));
}

TEST_F(OnACube, WhatWasNeverSentIsNotFelt) {
    shape.asset = 7;
    ASSERT_TRUE(scene.add(id, shape));
    expect_near(come_down({0, 0, 0.02}).force, Vector::Zero(), 0);
}

TEST_F(OnACube, ACycleAllocatesNothing) {
    ASSERT_TRUE(scene.add(id, shape));
    come_down({0.01, 0.02, 0.048});
    const std::size_t before = knurl::test::allocations();
    for (int i = 0; i < 1000; ++i)
        scene.evaluate(
            at({0.04 * std::sin(0.01 * i), 0.04 * std::cos(0.013 * i), 0.05 + 0.004 * std::sin(0.1 * i)}),
            dt);
    EXPECT_EQ(knurl::test::allocations(), before);
}

// The update no longer names the mesh that holds the hand: its force fades as by removal, whatever follows.
TEST_F(OnACube, NoMeshInItsPlaceIsNoJump) {
    for (const std::uint32_t next : {0u, 7u}) {  // none, or one that was never sent
        for (const bool removed : {false, true}) {
            Scene fresh = knurl::test::make_scene();
            fresh.set_asset(1, cube.get());
            shape.asset = 1;
            shape.recovery = 0.02;
            ASSERT_TRUE(fresh.add(id, shape));
            const Vector where(0.01, 0.02, 0.048);
            Vector last;
            for (int i = 100; i >= 0; --i)
                last = fresh.evaluate(at(where + Vector(0, 0, 1e-4 * i)), dt).force;
            expect_near(last, {0, 0, 1}, 1e-12);
            shape.asset = next;
            if (removed) {
                ASSERT_TRUE(fresh.remove(id));
            } else {
                ASSERT_TRUE(fresh.update(id, shape));
            }
            for (int i = 1; i <= 25; ++i) {
                const Vector now = fresh.evaluate(at(where), dt).force;
                expect_near(now, {0, 0, std::max(0.0, 1 - i * dt / 0.02)}, 1e-12);
            }
        }
    }
}

// ... it moves on, and is removed in the middle of the fade.
TEST_F(OnACube, WhatFadesMovesOnThoughItIsNamedNoMore) {
    shape.recovery = 0.02;
    shape.velocity = {0, 0, 0.1};
    ASSERT_TRUE(scene.add(id, shape));
    const Vector where(0.01, 0.02, 0.055);
    Vector last = stay(where, 100).force;  // it rises by 0.1 mm in each but the first: 4.9 mm deep
    expect_near(last, {0, 0, 500 * 0.0049}, 1e-9);
    shape.asset = 0;
    ASSERT_TRUE(scene.update(id, shape));
    for (int i = 1; i < 10; ++i)
        expect_near(stay(where, 1).force, {0, 0, 500 * (0.0049 + i * 1e-4) * (1 - i * dt / 0.02)}, 1e-9);
    ASSERT_TRUE(scene.remove(id));
    last = stay(where, 1).force;
    for (int i = 0; i < 25; ++i) {
        const Vector now = stay(where, 1).force;
        EXPECT_LE((now - last).norm(), 1.6 * dt / 0.02) << i;
        last = now;
    }
    expect_near(last, Vector::Zero(), 0);
}

}  // namespace shapes_scene_tests
