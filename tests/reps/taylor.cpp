// Taylor fields of force, and of force and torque. tests/reference/fields.cpp compares them with their series.

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <knurl/reps/taylor.hpp>
#include <knurl/reps/taylor6.hpp>

#include "effect_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

const Limits device{.max_stiffness = 2000, .max_torsion = 0.5};

Mat3 random_matrix(Rng& rng, double size) {
    Mat3 m;
    for (double& entry : m.at) entry = uniform(rng, -size, size);
    return m;
}

template <class Matrix>
auto symmetric(const Matrix& m) {
    return Matrix(0.5 * (m + m.transpose()));
}

// The same clamp by another algorithm in long double.
template <int N>
Eigen::Matrix<Real, N, N> clamped_reference(const Eigen::Matrix<double, N, N>& j, Real low, Real high) {
    using Matrix = Eigen::Matrix<Real, N, N>;
    const Matrix wide = j.template cast<Real>();
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric(wide));
    const Matrix& q = solver.eigenvectors();
    return Real(0.5) * (wide - wide.transpose()) +
           q * solver.eigenvalues().cwiseMax(low).cwiseMin(high).asDiagonal() * q.transpose();
}

}  // namespace

TEST(Taylor, OfAnInverseSquareFieldIsThirtyTimesNearerThanAConstantForceAtOneMillimetre) {
    // 1 N at 20 mm: F = c r / |r|^3, dF/dr = c (1 - 3 u u^T) / |r|^3.
    const Vector r0(0, 0, 0.02);
    const double c = 0.02 * 0.02;
    const auto force = [&](const Vector& r) { return Vector(c * r / std::pow(r.norm(), 3)); };
    const Vector u = r0.normalized();
    const Eigen::Matrix3d j =
        c / std::pow(r0.norm(), 3) * (Eigen::Matrix3d::Identity() - 3 * u * u.transpose());
    const Taylor field{.origin = to_plain(r0), .force = to_plain(force(r0)), .jacobian = to_mat3(j)};
    const double constant_errs[] = {0.11, 0.23, 0.78}, field_errs[] = {0.008, 0.034, 0.28};
    int i = 0;
    for (const double step : {1e-3, 2e-3, 5e-3}) {
        const Vector p = r0 - step * u;
        EXPECT_NEAR((force(r0) - force(p)).norm(), constant_errs[i], 0.006) << step;
        EXPECT_NEAR((felt(field, at(p)).force - force(p)).norm(), field_errs[i], 0.003) << step;
        ++i;
    }
}

TEST(Taylor, FadesToNothingWithoutAStepAndStaysThere) {
    const Taylor field{.force = {0, 0, 2}, .jacobian = {{-50, 0, 0, 0, -50, 0, 0, 0, -50}}, .radius = 0.01};
    EXPECT_NEAR(felt(field, at({0, 0, 0.0079})).force.z(), 2 - 50 * 0.0079, 1e-12)
        << "up to 0.8 of it unchanged";
    EXPECT_EQ(felt(field, at({0, 0, 0.01})).force.norm(), 0.0);
    EXPECT_EQ(felt(field, at({3, -4, 1e12})).force.norm(), 0.0);
    constexpr double step = 1e-7;
    Vector last = felt(field, at({0, 0, 0})).force;
    for (double z = step; z < 0.011; z += step) {
        const Vector force = felt(field, at({0, 0, z})).force;
        // s (F) + s' V: |F| <= 2.5 N, |V| <= 0.023 J; s' <= 7.5 / R, s'' <= 150 / R^2
        ASSERT_LE((force - last).norm(), (50 + 2 * 7.5 * 2.5 / 0.01 + 150 * 0.023 / 1e-4) * step) << z;
        last = force;
    }
}

TEST(Taylor, MayHoldTheForceOfItsRim) {
    const Taylor field{.force = {0, 0, 2},
                       .jacobian = {{-50, 0, 0, 0, -50, 0, 0, 0, -50}},
                       .radius = 0.01,
                       .edge = TaylorEdge::hold};
    for (const double r : {0.01, 0.02, 5.0, 1e12}) {
        const Vector force = felt(field, at({r, 0, 0})).force;
        EXPECT_NEAR((force - Vector(-0.5, 0, 2)).norm(), 0, 1e-12) << r;
    }
}

TEST(Taylor, OnADeviceNoDirectionRestoresOrPushesAwayMoreThanIsStable) {
    const std::uint64_t seed = 302;
    Rng rng(seed);
    for (int i = 0; i < 3000; ++i) {
        // what is held restores with up to a third of hand_stiffness more beyond its rim
        const double size = scale(rng, 1, 1e9), low = 2000 - hand_stiffness / 3;
        Taylor field{.jacobian = random_matrix(rng, size), .edge = TaylorEdge::hold};
        if (between(rng, 0, 3) == 0)  // repeated eigenvalues
            field.jacobian =
                to_mat3(Eigen::Matrix3d(uniform(rng, -size, size) * Eigen::Matrix3d::Identity()));
        const Taylor got = prepared(field, device);
        const Eigen::Matrix3d before = to_eigen(field.jacobian), after = to_eigen(got.jacobian);
        const auto want = clamped_reference<3>(before, -low, hand_stiffness);
        ASSERT_LE((after.cast<Real>() - want).norm(), 1e-12L * std::max(2000.0, before.norm()))
            << "seed " << seed << " case " << i;
        double least = 0;
        for (int k = 0; k < 20; ++k) {
            const Vector u = direction(rng);
            const double along = u.dot(symmetric(after) * u);
            ASSERT_GE(along, -low - 1e-12 * size);
            ASSERT_LE(along, hand_stiffness + 1e-12 * size);
            least = std::min(least, along);
        }
        ASSERT_GE(got.stiffness * (1 + 1e-9) + 1e-12 * size, -least);
        ASSERT_LE(got.stiffness, 2000);
        const Taylor again = prepared(got, device);
        ASSERT_LE((to_eigen(again.jacobian) - after).norm(), 1e-12 * size) << "once is enough";
    }
}

TEST(Taylor, WhatIsWithinTheBoundsOrOnNoDeviceIsUntouchedToTheBit) {
    Rng rng(303);
    for (int i = 0; i < 1000; ++i) {
        const Mat3 small = random_matrix(rng, 16), any = random_matrix(rng, 1e6);
        EXPECT_EQ(prepared(Taylor{.jacobian = small}, device).jacobian, small);
        EXPECT_EQ(prepared(Taylor{.jacobian = any}, Limits{}).jacobian, any);
    }
}

TEST(Taylor, ReturnsTheWorkOfALoopUnlessItHasACurl) {
    const std::uint64_t seed = 304;
    Rng rng(seed);
    for (int i = 0; i < 40; ++i) {
        const Mat3 any = random_matrix(rng, 200);
        const Taylor straight{.force = {1, 2, 3}, .jacobian = to_mat3(symmetric(to_eigen(any)))};
        const Taylor curled{.force = {1, 2, 3}, .jacobian = any};
        const Vector n = direction(rng), a = n.unitOrthogonal(), b = n.cross(a),
                     centre = 0.01 * direction(rng);
        constexpr double r = 0.02;
        const auto circle = [&](double s) {
            return Vector(centre + r * (std::cos(2 * M_PI * s) * a + std::sin(2 * M_PI * s) * b));
        };
        EXPECT_NEAR(work_of_loop(straight, circle), 0, 1e-10) << "seed " << seed << " case " << i;
        const Eigen::Matrix3d j = to_eigen(any);
        const Vector curl(j(2, 1) - j(1, 2), j(0, 2) - j(2, 0), j(1, 0) - j(0, 1));
        const double work = work_of_loop(curled, circle);
        EXPECT_NEAR(work / (M_PI * r * r * curl.dot(n)), 1, 1e-6) << "seed " << seed << " case " << i;
    }
}

TEST(Taylor6, WithoutMotionIsItsWrenchAndFarTurnedItIsNothing) {
    Rng rng(306);
    const Taylor6 field{.orientation = to_plain(turn(rng)), .force = {1, 2, 3}, .torque = {0.1, 0.2, 0.3}};
    Probe probe = at({0, 0, 0});
    probe.orientation = to_eigen(field.orientation);
    EXPECT_LE((felt(field, probe).force - Vector(1, 2, 3)).norm(), 1e-14);
    EXPECT_LE((felt(field, probe).torque - Vector(0.1, 0.2, 0.3)).norm(), 1e-14);
    for (const double angle : {0.51, 1.0, M_PI, 5.0}) {
        probe.orientation =
            Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector::UnitX())) * to_eigen(field.orientation);
        EXPECT_EQ(felt(field, probe).torque.norm(), 0.0) << angle;
    }
}

TEST(Taylor6, AnOrientationOfAnyLengthIsTheSame) {
    Taylor6 field{.orientation = {2e8, 0, 0, 3e8}, .torque = {1, 0, 0}, .edge = TaylorEdge::hold};
    field.jacobian.at[35] = -2;
    Taylor6 unit = field;
    unit.orientation = {2 / std::sqrt(13), 0, 0, 3 / std::sqrt(13)};
    EXPECT_LE((felt(field, {}).torque - felt(unit, {}).torque).norm(), 1e-14);
}

TEST(Taylor6, OnADeviceForceAndTorqueAreBoundedTogether) {
    const std::uint64_t seed = 307;
    Rng rng(seed);
    for (int i = 0; i < 1000; ++i) {
        Taylor6 field;
        const double size = scale(rng, 0.01, 1e5);
        for (double& entry : field.jacobian.at) entry = uniform(rng, -size, size);
        const Eigen::Matrix<double, 6, 6> before = to_eigen(field.jacobian),
                                          after = to_eigen(prepared(field, device).jacobian);
        // For any step: no more restored energy than by max_stiffness and max_torsion, and no more released
        // than in proportion.
        for (int k = 0; k < 30; ++k) {
            Eigen::Matrix<double, 6, 1> step;
            step << scale(rng, 1e-3, 1) * direction(rng), scale(rng, 1e-3, 30) * direction(rng);
            const double most = 2000 * step.head<3>().squaredNorm() + 0.5 * step.tail<3>().squaredNorm();
            const double along = step.dot(after * step), slack = 1e-9 * size * step.squaredNorm();
            ASSERT_GE(along, -most - slack) << "seed " << seed << " case " << i;
            ASSERT_LE(along, hand_stiffness / 2000 * most + slack) << "seed " << seed << " case " << i;
        }
        // The curl is scaled only with the whole field.
        const Eigen::Matrix<double, 6, 6> curl = before - before.transpose(),
                                          left = after - after.transpose();
        const double share = left.norm() / curl.norm();
        ASSERT_LE(share, 1 + 1e-9);
        ASSERT_LE((share * curl - left).norm(), 1e-9 * size);
        ASSERT_LE(prepared(field, device).stiffness, 2000);
    }
}

TEST(Taylor6, WhereTheTorsionIsNotKnownOnlyForceByPositionIsBounded) {
    Taylor6 field{.edge = TaylorEdge::hold};
    field.jacobian.at[0] = -5000;
    field.jacobian.at[7] = 400;
    field.jacobian.at[35] = -5000;
    const Mat6 got = prepared(field, {.max_stiffness = 2000}).jacobian;
    EXPECT_NEAR(got.at[0], -2000 + hand_stiffness / 3, 1e-9);
    EXPECT_NEAR(got.at[7], hand_stiffness, 1e-9);
    EXPECT_EQ(got.at[35], -5000);
    EXPECT_EQ(prepared(field, {}).jacobian, field.jacobian) << "no device: no bound";
}
