// Stamper's delta, compared with its inverse in long double, whose closed form shares nothing with the
// forward solution, and with derivatives of that inverse.

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include <knurl/drivers/delta.hpp>

#include "../refusal.hpp"

namespace knurl::drivers {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Real = long double;
using Vector = Eigen::Matrix<Real, 3, 1>;

/// A number with its rate of change: exact derivatives.
struct Moving {
    Real value = 0, rate = 0;
};
Moving operator+(Moving a, Moving b) {
    return {a.value + b.value, a.rate + b.rate};
}
Moving operator-(Moving a, Moving b) {
    return {a.value - b.value, a.rate - b.rate};
}
Moving operator*(Moving a, Moving b) {
    return {a.value * b.value, a.rate * b.value + a.value * b.rate};
}
Moving operator/(Moving a, Moving b) {
    return {a.value / b.value, (a.rate * b.value - a.value * b.rate) / (b.value * b.value)};
}
Moving sqrt(Moving a) {
    return {std::sqrt(a.value), a.rate / (2 * std::sqrt(a.value))};
}
Moving acos(Moving a) {
    return {std::acos(a.value), -a.rate / std::sqrt(1 - a.value * a.value)};
}
Moving atan2(Moving y, Moving x) {
    return {std::atan2(y.value, x.value),
            (x.value * y.rate - y.value * x.rate) / (x.value * x.value + y.value * y.value)};
}
Moving fixed(double value) {
    return {value, 0};
}

/// The crank's angle for a platform at p that moves with v, by the law of cosines; NaN out of reach.
Moving crank(const DeltaTable& t, std::size_t leg, const Vector& p, const Vector& v) {
    const Real c = std::cos(static_cast<Real>(t.leg[leg])), s = std::sin(static_cast<Real>(t.leg[leg]));
    const Moving x{p[0], v[0]}, y{p[1], v[1]}, w{p[2], v[2]}, cosine{c, 0}, sine{s, 0};
    const Moving u = x * cosine + y * sine - fixed(t.r) + fixed(t.c);
    const Moving across = y * cosine - x * sine - fixed(t.s) + fixed(t.f);
    const Moving a = fixed(t.a);
    const Moving length = fixed(t.d) + fixed(t.e) + sqrt(fixed(t.b) * fixed(t.b) - across * across);
    const Moving away = u * u + w * w;
    return atan2(w, u) - acos((away + a * a - length * length) / (fixed(2) * a * sqrt(away)));
}

std::array<double, 3> cranks(const DeltaTable& t, const Vector3d& p) {
    std::array<double, 3> q;
    for (std::size_t i = 0; i < 3; ++i) {
        q[i] = static_cast<double>(crank(t, i, p.cast<Real>(), Vector::Zero()).value);
    }
    return q;
}

struct Random {
    std::mt19937_64 engine;
    double operator()(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine);
    }
    Vector3d vector(double size) {
        return Vector3d::NullaryExpr([&] { return (*this)(-size, size); });
    }
    Vector3d in_ball(double radius) {
        for (;;) {
            const Vector3d p = vector(radius);
            if (p.norm() <= radius) {
                return p;
            }
        }
    }
};

/// The Falcon's workspace: a cube of 0.1 m is stated by its maker, all of this ball is in reach.
Vector3d in_workspace(Random& random) {
    return Vector3d(0, 0, falcon_centre) + random.in_ball(0.055);
}

TEST(Delta, ForwardOfInverseIsThePositionOverTheWholeWorkspace) {
    constexpr std::uint64_t seed = 11;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    const DeltaTable table = falcon_delta();
    const Delta delta(table);
    double worst = 0;
    for (int trial = 0; trial < 100'000; ++trial) {
        const Vector3d p = in_workspace(random);
        const std::array<double, 3> q = cranks(table, p);
        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(delta.forward(q, pose, jacobian)) << p.transpose();
        worst = std::max(worst, (pose.position - p).norm());
        std::array<double, 3> back{};
        ASSERT_TRUE(delta.inverse(p, back));
        for (std::size_t i = 0; i < 3; ++i) {
            ASSERT_NEAR(back[i], q[i], 1e-13);
        }
    }
    EXPECT_LT(worst, 1e-9) << "the goal";
    EXPECT_LT(worst, 1e-14) << "what double allows";
}

TEST(Delta, JacobianIsTheDerivativeAndConservesWork) {
    constexpr std::uint64_t seed = 12;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    const DeltaTable table = falcon_delta();
    const Delta delta(table);
    for (int trial = 0; trial < 5'000; ++trial) {
        const Vector3d p = in_workspace(random);
        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(delta.forward(cranks(table, p), pose, jacobian));
        EXPECT_TRUE(jacobian.bottomRows<3>().isZero(0)) << "the platform never turns";
        EXPECT_TRUE(jacobian.rightCols<5>().isZero(0));

        // Central differences of the inverse in long double: d(theta)/d(position), the Jacobian's inverse.
        constexpr Real h = 1e-6L;
        Eigen::Matrix<Real, 3, 3> inverse;
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            for (std::size_t leg = 0; leg < 3; ++leg) {
                Vector ahead = p.cast<Real>(), behind = ahead;
                ahead[axis] += h;
                behind[axis] -= h;
                inverse(static_cast<Eigen::Index>(leg), axis) =
                    (crank(table, leg, ahead, Vector::Zero()).value -
                     crank(table, leg, behind, Vector::Zero()).value) /
                    (2 * h);
            }
        }
        const Matrix3d one = (jacobian.topLeftCorner<3, 3>().cast<Real>() * inverse).cast<double>();
        EXPECT_LT((one - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-7) << p.transpose();

        // tau q' = F v, with the joints' rates from the inverse's exact derivative.
        const Vector3d force = random.vector(5), velocity = random.vector(1);
        const Vector3d tau = jacobian.topLeftCorner<3, 3>().transpose() * force;
        Real motors = 0;
        for (std::size_t leg = 0; leg < 3; ++leg) {
            motors += static_cast<Real>(tau[static_cast<Eigen::Index>(leg)]) *
                      crank(table, leg, p.cast<Real>(), velocity.cast<Real>()).rate;
        }
        const Real tip = force.cast<Real>().dot(velocity.cast<Real>());
        EXPECT_NEAR(static_cast<double>(motors - tip), 0, 1e-12) << p.transpose();
    }
}

TEST(Delta, OneCountOfTheFalconsEncodersIsTwentyToSixtyFiveMicrometres) {
    const Delta delta(falcon_delta());
    Random random{std::mt19937_64(13)};
    double least = 1, greatest = 0;
    for (int trial = 0; trial < 2'000; ++trial) {
        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(delta.forward(
            cranks(falcon_delta(), Vector3d(0, 0, falcon_centre) + random.in_ball(0.04)), pose, jacobian));
        for (Eigen::Index leg = 0; leg < 3; ++leg) {
            const double count = falcon_radians_per_count * jacobian.col(leg).head<3>().norm();
            least = std::min(least, count);
            greatest = std::max(greatest, count);
        }
    }
    EXPECT_NEAR(falcon_radians_per_count * 180 / std::numbers::pi, 0.036435, 1e-6) << "published, in degrees";
    EXPECT_GT(least, 20e-6);
    EXPECT_LT(greatest, 65e-6);
}

TEST(Delta, ThreeSpheresAreWithinThreeMillimetresAndExactWithoutBars) {
    constexpr std::uint64_t seed = 14;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    const DeltaTable falcon = falcon_delta();
    DeltaTable ideal = falcon;
    ideal.b += ideal.d + ideal.e;
    ideal.d = ideal.e = 0;  // the tori are spheres
    for (int trial = 0; trial < 10'000; ++trial) {
        const Vector3d p = Vector3d(0, 0, falcon_centre) + random.in_ball(0.05);
        const Delta delta(falcon), sphere(ideal);
        EXPECT_LT((delta.three_spheres(delta.cranks(cranks(falcon, p))) - p).norm(), 3.1e-3);
        EXPECT_LT((sphere.three_spheres(sphere.cranks(cranks(ideal, p))) - p).norm(), 1e-14);
    }
}

TEST(Delta, StepsAreBoundedAndFourAreTheWorstInTheWorkspace) {
    constexpr std::uint64_t seed = 15;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    const DeltaTable table = falcon_delta();
    const Delta delta(table);
    int most = 0;
    for (int trial = 0; trial < 20'000; ++trial) {
        const Delta::Cranks ends = delta.cranks(cranks(table, in_workspace(random)));
        Vector3d position = delta.three_spheres(ends), change(1, 1, 1);
        Matrix3d jacobian;
        int steps = 0;
        for (; steps < Delta::most_steps && !(change.norm() < Delta::enough * 0.125); ++steps) {
            ASSERT_TRUE(delta.step(ends, position, change, jacobian));
            position += change;
        }
        most = std::max(most, steps);
    }
    EXPECT_LE(most, 4);
}

TEST(Delta, AnyAnglesGiveAPoseOnAllThreeToriOrNone) {
    // Far outside a hand's reach: any answer must close the legs and be finite.
    constexpr std::uint64_t seed = 16;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    const DeltaTable table = falcon_delta();
    const Delta delta(table);
    int poses = 0;
    for (int trial = 0; trial < 20'000; ++trial) {
        const std::array<double, 3> q = {random(-4, 4), random(-4, 4), random(-4, 4)};
        TipPose pose{.position = {7, 7, 7}};
        Jacobian jacobian;
        if (!delta.forward(q, pose, jacobian)) {
            EXPECT_EQ(pose.position, Vector3d(7, 7, 7)) << "no pose: the last one stays";
            continue;
        }
        ++poses;
        ASSERT_TRUE(jacobian.allFinite());
        for (std::size_t i = 0; i < 3; ++i) {
            const double c = std::cos(table.leg[i]), s = std::sin(table.leg[i]);
            const Vector3d& p = pose.position;
            const double u = p.x() * c + p.y() * s - table.r + table.c;
            const double v = p.y() * c - p.x() * s - table.s + table.f;
            const double leg = std::hypot(u - table.a * std::cos(q[i]), p.z() - table.a * std::sin(q[i]));
            EXPECT_NEAR(leg, table.d + table.e + std::sqrt(table.b * table.b - v * v), 1e-12);
        }
    }
    EXPECT_GT(poses, 5'000);
}

TEST(Delta, PosesFollowTheAnglesWithoutAJump) {
    // Slow random walks of the cranks through the workspace: the pose moves by J times their change.
    constexpr std::uint64_t seed = 17;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    const DeltaTable table = falcon_delta();
    const Delta delta(table);
    for (int walk = 0; walk < 50; ++walk) {
        const std::array<double, 3> from = cranks(table, in_workspace(random)),
                                    to = cranks(table, in_workspace(random));
        TipPose pose, before;
        Jacobian jacobian;
        for (int i = 0; i <= 200; ++i) {
            std::array<double, 3> q;
            for (std::size_t k = 0; k < 3; ++k) {
                q[k] = from[k] + (to[k] - from[k]) * i / 200;
            }
            ASSERT_TRUE(delta.forward(q, pose, jacobian));
            const double largest = jacobian.topLeftCorner<3, 3>().norm() * 0.01 * 2;
            if (i > 0) {
                ASSERT_LT((pose.position - before.position).norm(), largest)
                    << "walk " << walk << " at " << i;
            }
            before = pose;
        }
    }
}

TEST(Delta, MovesAndTurnsWithItsBase) {
    DeltaTable table = falcon_delta();
    const Delta own(table);
    table.base.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // its z is the device's x, its y the device's z
    table.base.translation() = Vector3d(-falcon_centre, 0.01, 0);
    const Delta moved(table);
    Random random{std::mt19937_64(18)};
    for (int trial = 0; trial < 100; ++trial) {
        const std::array<double, 3> q = cranks(falcon_delta(), in_workspace(random));
        TipPose here, there;
        Jacobian j, k;
        ASSERT_TRUE(own.forward(q, here, j));
        ASSERT_TRUE(moved.forward(q, there, k));
        EXPECT_LT((there.position - table.base * here.position).norm(), 1e-15);
        EXPECT_LT(((k.topLeftCorner<3, 3>() - table.base.linear() * j.topLeftCorner<3, 3>()).norm()), 1e-15);
        std::array<double, 3> back{};
        ASSERT_TRUE(moved.inverse(there.position, back));
        EXPECT_NEAR(back[1], q[1], 1e-13);
    }
}

TEST(Delta, SaysWhenAPositionIsOutOfReach) {
    const Delta delta(falcon_delta());
    for (const Vector3d& far :
         {Vector3d(0, 0, 0.3), Vector3d(0.2, 0, 0.12), Vector3d(0, 0, 1e9), Vector3d(std::nan(""), 0, 0.1)}) {
        std::array<double, 3> joints = {1, 2, 3};
        EXPECT_FALSE(delta.inverse(far, joints)) << far.transpose();
        EXPECT_EQ(joints, (std::array<double, 3>{1, 2, 3}));
    }
}

TEST(Delta, SaysWhatIsWrongWithATable) {
    const auto refusal = [](const DeltaTable& table) -> std::string {
        return test::refusal_of([&] { Delta delta(table); });
    };
    DeltaTable table = falcon_delta();
    EXPECT_EQ(refusal(table), "accepted");
    table.b = 102.5;
    EXPECT_EQ(refusal(table), "delta: b is 102.500000 m; give a finite length in metres, at most 10");
    table = falcon_delta();
    table.e = std::nan("");
    EXPECT_EQ(refusal(table), "delta: e is nan m; give a finite length in metres, at most 10");
    table = falcon_delta();
    table.a = 0;
    EXPECT_EQ(refusal(table), "delta: crank a and parallelogram b must be longer than 0 m");
    table = falcon_delta();
    table.leg[2] = table.leg[0] + 2 * std::numbers::pi;
    EXPECT_EQ(refusal(table), "delta: two legs stand at the same angle; give three different ones");
}

}  // namespace
}  // namespace knurl::drivers
