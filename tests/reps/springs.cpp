// Springs against their formula in long double; anchors and rest lengths that move.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

using Real = long double;
using RealVector = Eigen::Matrix<Real, 3, 1>;

struct Reference {
    RealVector force, torque;
    Real size;  // N, the largest product that enters
};

// F = k (1 - L0 / sqrt(l^2 + e^2)) d - b (v.u) u at the attached point, torque (R b) x F.
Reference reference(const Spring& spring, const Probe& probe, Real max_stiffness) {
    const auto vector = [](const Vec3& v) { return RealVector(v.x, v.y, v.z); };
    const Eigen::Quaternion<Real> q(Real(probe.orientation.w()), Real(probe.orientation.x()),
                                    Real(probe.orientation.y()), Real(probe.orientation.z()));
    const RealVector arm = q.toRotationMatrix() * vector(spring.attach);
    const RealVector d = vector(spring.anchor) - probe.position.cast<Real>() - arm;
    const Real l = d.norm(), rest = spring.rest_length, k = spring.stiffness;
    RealVector force = k * d;
    if (rest > 0) {
        const Real e = std::max(std::min(Real(1e-3), rest / 20), rest * k / max_stiffness);
        force = k * (1 - rest / std::sqrt(l * l + e * e)) * d;
    }
    const RealVector v = probe.velocity.cast<Real>() + probe.angular_velocity.cast<Real>().cross(arm);
    if (l > 0) force -= Real(spring.damping) * v.dot(d / l) * (d / l);
    const Real reach =
        std::max({vector(spring.anchor).norm(), probe.position.cast<Real>().norm(), arm.norm(), rest});
    return {force, arm.cross(force), k * reach + Real(spring.damping) * v.norm()};
}

constexpr RepresentationId id{0, 1};

}  // namespace

TEST(Spring, AgreesWithItsFormulaForRandomParameters) {
    const std::uint64_t seed = 51;
    Rng rng(seed);
    const Limits limits{.max_stiffness = 3000};
    for (int i = 0; i < (long_form() ? 1'000'000 : 50'000); ++i) {
        const double reach = between(rng, 0, 9) ? scale(rng, 1e-6, 1) : 1e6;
        const Spring spring{
            .anchor = to_plain(reach * direction(rng)),
            .attach = between(rng, 0, 1) ? Vec3{} : to_plain(scale(rng, 1e-3, 0.1) * direction(rng)),
            .rest_length = between(rng, 0, 1) ? 0 : scale(rng, 1e-4, 0.2),
            .stiffness = scale(rng, 1, 3000),
            .damping = between(rng, 0, 1) ? 0 : scale(rng, 0.1, 10)};
        Probe probe = at(to_eigen(spring.anchor) + scale(rng, 1e-6, 0.3) * direction(rng), direction(rng));
        probe.orientation = Eigen::Quaterniond(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1),
                                               uniform(rng, -1, 1))
                                .normalized();
        probe.angular_velocity = direction(rng);
        const Spring params = prepared(spring, limits);
        Spring::State state;
        adopt(params, nullptr, state, probe);
        const Wrench got = evaluate(params, state, probe, dt);
        const Reference want = reference(spring, probe, 3000);
        ASSERT_LE((got.force.cast<Real>() - want.force).norm(), 1e-12L * want.size)
            << "seed " << seed << " case " << i;
        ASSERT_LE((got.torque.cast<Real>() - want.torque).norm(), 1e-12L * want.size)
            << "seed " << seed << " case " << i;
    }
}

TEST(Spring, PullsAboveItsRestLengthAndPushesBelow) {
    Spring::State state;
    const Spring spring =
        prepared(Spring{.anchor = {0, 0, 0.1}, .rest_length = 0.06, .stiffness = 100}, Limits{});
    adopt(spring, nullptr, state, {});
    EXPECT_NEAR(evaluate(spring, state, at({0, 0, 0}), dt).force.z(), 4, 0.01);
    EXPECT_NEAR(evaluate(spring, state, at({0, 0, 0.08}), dt).force.z(), -4, 0.02);
}

TEST(Spring, HasNoJumpAtLengthZeroAndIsNowhereStifferThanAllowed) {
    // Without the rounding the force jumps by 2 k L0 = 60 N as the probe passes the anchor.
    const Limits limits{.max_stiffness = 2000};
    for (const double k : {20.0, 200.0, 1500.0, 2000.0}) {
        Spring::State state;
        const Spring spring = prepared(Spring{.rest_length = 0.05, .stiffness = k}, limits);
        adopt(spring, nullptr, state, {});
        constexpr double step = 1e-6;
        // Pushing out from the middle: at most k (L0 / e - 1), e the larger of 1 mm and L0 k / k_max.
        const double largest = std::min(limits.max_stiffness, k * (0.05 / 1e-3));
        Vector last = evaluate(spring, state, at({-0.003, 1e-7, 0}), dt).force;
        for (double x = -0.003 + step; x < 0.003; x += step) {
            const Vector force = evaluate(spring, state, at({x, 1e-7, 0}), dt).force;
            ASSERT_LE((force - last).norm(), largest * step * (1 + 1e-6)) << "k " << k << " x " << x;
            last = force;
        }
    }
}

TEST(Spring, AtItsAnchorItIsSilent) {
    Spring::State state;
    const Spring spring = prepared(Spring{.stiffness = 100, .damping = 3}, Limits{});
    adopt(spring, nullptr, state, {});
    const Wrench w = evaluate(spring, state, at({0, 0, 0}, {1, 2, 3}), dt);
    EXPECT_EQ(w.force.norm(), 0.0);
}

TEST(Spring, ARestLengthOfNextToNothingIsNone) {
    for (const double rest : {1e-300, 1e-200, 1e-160, 1e-100, 1e-20}) {
        Spring::State state;
        const Spring spring = prepared(Spring{.rest_length = rest, .stiffness = 100}, Limits{});
        adopt(spring, nullptr, state, {});
        EXPECT_EQ(evaluate(spring, state, at({0, 0, 0}), dt).force.norm(), 0.0) << rest;
        EXPECT_NEAR(evaluate(spring, state, at({0, 0, -0.01}), dt).force.z(), 1, 1e-12) << rest;
    }
}

TEST(Spring, ItsAnchorAndRestLengthMoveLinearlyAndArriveExactly) {
    Scene scene = make_scene();
    const Spring first{.anchor = {0.1, 0, 0}, .stiffness = 200, .duration = 0.05};
    Spring second = first;
    second.anchor = {0.1, 0.02, -0.03};
    second.rest_length = 0.04;
    ASSERT_TRUE(scene.add(id, first));
    settled(scene, {});
    ASSERT_TRUE(scene.update(id, second));
    for (int i = 1; i <= 60; ++i) {
        const Real s = std::min(Real(1), Real(i) / 50);
        Spring between_them = first;
        between_them.anchor = {0.1, double(s * 0.02L), double(s * -0.03L)};
        between_them.rest_length = double(s * 0.04L);
        const Reference want = reference(between_them, {}, INFINITY);
        ASSERT_LE((scene.evaluate({}, dt).force.cast<Real>() - want.force).norm(), 1e-11L) << "cycle " << i;
    }
}

TEST(Spring, ANewTargetBeforeTheEndStartsFromThePresentPoint) {
    Scene scene = make_scene();
    Spring spring{.anchor = {0, 0, 0}, .stiffness = 100, .duration = 0.01};
    ASSERT_TRUE(scene.add(id, spring));
    settled(scene, {});
    spring.anchor.x = 0.1;
    ASSERT_TRUE(scene.update(id, spring));
    for (int i = 0; i < 5; ++i) scene.evaluate({}, dt);  // at 0.05
    spring.anchor.x = -0.05;
    ASSERT_TRUE(scene.update(id, spring));
    for (int i = 1; i <= 12; ++i) {
        EXPECT_NEAR(scene.evaluate({}, dt).force.x(), 100 * (0.05 - 0.1 * std::min(1.0, i / 10.0)), 1e-11);
    }
}

TEST(Spring, MovesAtTheSameSpeedAtEveryRate) {
    for (const double step : {1e-4, 5e-4, 1e-3, 3e-3}) {
        Scene scene = make_scene();
        Spring spring{.anchor = {0, 0, 0}, .stiffness = 100, .duration = 0.05};
        ASSERT_TRUE(scene.add(id, spring));
        settled(scene, {});
        spring.anchor.x = 0.1;
        ASSERT_TRUE(scene.update(id, spring));
        double t = 0;
        while (t < 0.06) {
            t += step;
            ASSERT_NEAR(scene.evaluate({}, step).force.x(), 100 * 0.1 * std::min(1.0, t / 0.05), 1e-9)
                << step;
        }
    }
}

TEST(Spring, StiffnessFadesWhileTheAnchorMoves) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(id, Spring{.anchor = {0.1, 0, 0}, .stiffness = 100, .duration = 0.02}));
    settled(scene, {});
    ASSERT_TRUE(scene.update(id, Spring{.anchor = {0.2, 0, 0}, .stiffness = 300, .duration = 0.02}));
    for (int i = 1; i <= 25; ++i) {
        const double s = std::min(1.0, i / 20.0);
        EXPECT_NEAR(scene.evaluate({}, dt).force.x(), (100 + 200 * s) * (0.1 + 0.1 * s), 1e-11)
            << "cycle " << i;
    }
}

TEST(Spring, AnAnchorThatMovesOnDuringTheFadeInDoesNotRestartIt) {
    Scene scene = make_scene();
    Spring spring{.anchor = {0.1, 0, 0}, .stiffness = 100, .duration = 0.02};
    ASSERT_TRUE(scene.add(id, spring));
    for (int i = 1; i <= 10; ++i) EXPECT_NEAR(scene.evaluate({}, dt).force.x(), 10 * i / 20.0, 1e-12);
    spring.anchor.y = 0.1;
    ASSERT_TRUE(scene.update(id, spring));
    for (int i = 1; i <= 25; ++i) {
        const Vector force = scene.evaluate({}, dt).force;
        EXPECT_NEAR(force.x(), 10 * std::min(1.0, 0.5 + i / 20.0), 1e-12);
        EXPECT_NEAR(force.y(), 10 * std::min(1.0, 0.5 + i / 20.0) * std::min(1.0, i / 20.0), 1e-12);
    }
}

TEST(Spring, ItsStiffnessIsClampedAndItsOwnerTold) {
    Scene scene = make_scene({.max_stiffness = 150});
    ASSERT_TRUE(scene.add(id, Spring{.anchor = {0.01, 0, 0}, .stiffness = 1000}));
    EXPECT_NEAR(settled(scene, {}).force.x(), 1.5, 1e-12);
    Feedback feedback[1];
    ASSERT_EQ(scene.feedback(feedback), 1u);
    EXPECT_EQ(feedback[0].stiffness, 150);
    EXPECT_TRUE(feedback[0].flags & Feedback::stiffness_clamped);
    EXPECT_NEAR(feedback[0].wrench.force.x(), 1.5, 1e-12) << "the reaction that a simulation needs";
}
