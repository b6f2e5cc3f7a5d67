// A surface that only gives its distance: all else that a Surface has is derived from it.

#include <cmath>

#include <gtest/gtest.h>

#include <knurl/reps/distance_surface.hpp>
#include <knurl/reps/material.hpp>

#include "scene_tools.hpp"

namespace knurl {

/// An endless cone with axis -z; the outside is free.
struct TestCone {
    Vec3 apex = {};               // m
    double half_angle = 0.5;      // rad, between axis and mantle
    Vec3 velocity = {};           // m/s
    double stiffness = 0;         // N/m
    double damping = 0;           // N s/m
    double recovery = automatic;  // s
    double braking = 0;           // 1
    Friction friction = {};
    Snag snag = {};
    Texture texture = {};

    using State = MovingState;
};

template <>
struct Describe<TestCone> {
    static constexpr std::string_view name = "cone";
    static constexpr auto fields = join_rows(
        std::array{
            vector_row("apex", offsetof(TestCone, apex), "m", "its tip"),
            number_row("half_angle", offsetof(TestCone, half_angle), "rad", "between axis and mantle", 0.01,
                       1.5),
        },
        surface_rows<TestCone>());
};

SurfaceDistance distance(const TestCone& cone, const Eigen::Vector3d& p, double radius) noexcept {
    const Eigen::Vector3d q = p - to_eigen(cone.apex), side(q.x(), q.y(), 0);
    const Eigen::Vector3d out =
        side.norm() > 0 ? Eigen::Vector3d(side / side.norm()) : Eigen::Vector3d::UnitX();
    const double cosine = std::cos(cone.half_angle), sine = std::sin(cone.half_angle);
    const Eigen::Vector3d mantle = cosine * out + sine * Eigen::Vector3d::UnitZ();
    // Above the cone of normals the tip is the nearest point.
    const double along = sine * out.dot(q) - cosine * q.z();
    if (along < 0) return {q.norm() - radius, q.normalized()};
    return {mantle.dot(q) - radius, mantle};
}

}  // namespace knurl

using namespace knurl;
using namespace knurl::test;

static_assert(Surface<TestCone>);

namespace {

const TestCone cone = {.apex = {0.01, -0.02, 0.03},
                       .half_angle = 0.4,
                       .velocity = {0.1, 0.2, -0.3},
                       .stiffness = 500,
                       .damping = 2};

// The following cycle of a surface that was added in the last one.
Contact after(const TestCone& params, MovingState& state, double seconds, const Probe& probe) {
    contact(params, state, probe, dt);
    Contact found;
    for (int i = 0; i < std::lround(seconds / dt); ++i) found = contact(params, state, probe, dt);
    return found;
}

TEST(DistanceSurface, MovesOnAndAnswersItsTangentPlaneAtTheFoot) {
    Rng rng(2614);
    for (int round = 0; round < 1000; ++round) {
        MovingState state;
        adopt(cone, nullptr, state, Probe{});
        Probe probe = at(Vector(0.05 * direction(rng)));
        probe.radius = uniform(rng, 0, 0.01);
        const Contact found = after(cone, state, 0.02, probe);
        TestCone moved = cone;
        moved.apex = to_plain(to_eigen(cone.apex) + 0.02 * to_eigen(cone.velocity));
        const SurfaceDistance want = distance(moved, probe.position, probe.radius);
        EXPECT_NEAR(found.height, want.height, 1e-15);
        EXPECT_LE((found.normal - want.normal).norm(), 1e-12);
        EXPECT_EQ(found.velocity, to_eigen(cone.velocity));
        EXPECT_EQ(found.stiffness, 500);
        // A repeated evaluation within a cycle gives the same answer.
        EXPECT_EQ(contact(cone, state, probe, 0).height, found.height);
    }
}

TEST(DistanceSurface, StartsAnewWhereItIsPutElsewhereAndGoesOnWhereItIsNot) {
    MovingState state;
    adopt(cone, nullptr, state, Probe{});
    after(cone, state, 0.02, Probe{});
    TestCone wider = cone;
    wider.half_angle = 0.5;
    wider.stiffness = 100;
    adopt(wider, &cone, state, Probe{});
    EXPECT_NEAR(state.motion.time, 0.02, 1e-12);
    TestCone elsewhere = wider;
    elsewhere.apex.y += 0.001;
    adopt(elsewhere, &wider, state, Probe{});
    EXPECT_EQ(state.motion.time, 0);
    after(elsewhere, state, 0.02, Probe{});
    TestCone faster = elsewhere;
    faster.velocity.x += 1;
    adopt(faster, &elsewhere, state, Probe{});
    EXPECT_EQ(state.motion.time, 0);
}

TEST(DistanceSurface, IsAsStiffAndDampedAsTheDeviceStands) {
    const Limits limits{.max_stiffness = 300, .mass = 0.1, .lag = 0.5e-3, .period = 1e-3};
    TestCone hard = cone;
    hard.stiffness = std::numeric_limits<double>::infinity();
    hard.damping = hard.friction.viscous = 1e9;
    const TestCone felt = prepared(hard, limits);
    EXPECT_EQ(felt.stiffness, 300);
    EXPECT_LT(felt.damping, 20);
    EXPECT_EQ(felt.friction.viscous, felt.damping);
    EXPECT_EQ(felt.apex, cone.apex);
}

}  // namespace
