// The rimmed cap: the surface that an application fits where the hand is. tests/reference/caps.cpp compares it with
// the reference, within its rim and beyond.

#include <knurl/reps/cap.hpp>

#include "shape_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

Cap random_cap(Rng& rng, double size, bool two) {
    Cap cap{.normal = to_plain(direction(rng)),
            .curvature = (between(rng, 0, 1) ? 1 : -1) * scale(rng, 0.01, 3) / size,
            .rim = uniform(rng, 0.02, 0.5),
            .stiffness = 1000};
    if (two) {
        cap.axis = to_plain(Vector(uniform(rng, 0.1, 10) * direction(rng)));
        cap.curvature2 =
            between(rng, 0, 4) == 0 ? 0 : (between(rng, 0, 1) ? 1 : -1) * scale(rng, 0.01, 3) / size;
    }
    return cap;
}

}  // namespace

TEST(Cap, FollowsTheSurfaceThatItWasFittedToUpToTheFourthOrder) {
    // z = (k1 a^2 + k2 b^2) / 2 along and across the axis: positive curvature rises towards free space.
    Rng rng(4203);
    for (int round = 0; round < 2000; ++round) {
        const double k1 = uniform(rng, -30, 30), k2 = uniform(rng, -30, 30);
        const Vector n = direction(rng), a = n.cross(direction(rng)).normalized(), b = n.cross(a);
        Evaluated<Cap> cap({.normal = to_plain(n),
                            .curvature = k1,
                            .curvature2 = k2,
                            .axis = to_plain(Vector(3 * a + 0.5 * n)),
                            .rim = 0.5});
        const double k = std::max(std::abs(k1), std::abs(k2));
        for (const double d : {1e-4, 1e-3}) {
            const double t = uniform(rng, 0, 2 * M_PI), x = d * std::cos(t), y = d * std::sin(t);
            const Vector p = x * a + y * b + (k1 * x * x + k2 * y * y) / 2 * n;
            EXPECT_LE(std::abs(cap(p).height), 0.5 * k * k * k * d * d * d * d + 1e-18) << "round " << round;
        }
    }
}

TEST(Cap, AtAndBeyondItsCentreItIsStillASurface) {
    Rng rng(4208);
    for (const double k : {50.0, -50.0, 1e9, -1e9}) {
        for (const bool two : {false, true}) {
            Cap params{.normal = {0, 0, 1}, .curvature = k};
            if (two) params.axis = {1, 0, 0}, params.curvature2 = k * 0.5;
            Evaluated<Cap> cap(params);
            const Contact c = cap({0, 0, 1 / k});
            EXPECT_NEAR(c.height, 1 / k, 1e-12 / std::abs(k));
            EXPECT_NEAR(c.normal.z(), 1, 1e-12);
            for (int i = 0; i < 1000; ++i) {
                const Vector p =
                    scale(rng, 1e-20, 1e12) * (i % 3 ? direction(rng) : Vector::Unit(i % 2 ? 2 : 0));
                for (const Vector& q : {p, Vector(-p), Vector(p + Vector(0, 0, 1 / k))}) {
                    const Contact d = cap(q);
                    ASSERT_TRUE(std::isfinite(d.height));
                    ASSERT_NEAR(d.normal.norm(), 1, 1e-12) << q.transpose();
                }
            }
        }
    }
}

TEST(Cap, ItDoesNotMatterWhichCurvatureIsNamedFirst) {
    Rng rng(4209);
    for (int round = 0; round < 500; ++round) {
        Cap one = random_cap(rng, 0.01, true);
        if (round % 5 == 0) one.curvature2 = -one.curvature;  // equally strong
        Cap other = one;
        std::swap(other.curvature, other.curvature2);
        other.axis = to_plain(to_eigen(one.normal).cross(to_eigen(one.axis)));
        const Vector p = 0.01 * direction(rng);
        EXPECT_NEAR(Evaluated<Cap>(one)(p).height, Evaluated<Cap>(other)(p).height, 1e-15);
    }
}

TEST(Cap, EqualCurvaturesNeedNoAxisAndIgnoreIt) {
    Cap plain{.curvature = 30};
    Cap named{.curvature = 30, .curvature2 = 30, .axis = {0, 0, 1}};
    EXPECT_TRUE(Describe<Cap>::check(named));
    const Cap a = prepared(plain, {}), b = prepared(named, {});
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
}

TEST(Cap, RefusesASecondCurvatureWithoutADirection) {
    const auto reason = [](const Cap& cap) {
        const Verdict verdict = Describe<Cap>::check(cap);
        EXPECT_EQ(verdict.code, Verdict::Code::contradiction);
        return std::pair(Describe<Cap>::fields[verdict.field].name,
                         Describe<Cap>::contradictions[verdict.reason]);
    };
    EXPECT_EQ(reason({.curvature = 30, .curvature2 = 5}),
              std::pair(std::string_view("curvature2"),
                        std::string_view("needs an axis; give the tangent direction of curvature")));
    EXPECT_EQ(reason({.curvature = 30, .axis = {0, 0, 2}}),
              std::pair(std::string_view("axis"),
                        std::string_view("is along the normal; give a direction in the tangent plane")));
}

TEST(Cap, AHollowTighterThanTheProbeDoesNotTurnTheNormalRound) {
    Evaluated<Cap> cap({.normal = {0, 0, 1}, .curvature = 1000});  // 1 mm, probed with 8 mm
    for (const double x : {-0.001, -1e-9, 0.0, 1e-9, 0.001}) {
        const Contact c = cap({x, 0, 0.0079}, 0.008);
        EXPECT_LT(c.height, 0);
        EXPECT_NEAR(c.normal.x(), -x / std::hypot(x, 0.016 - 0.0079), 1e-12) << "of 16 mm, not of 1 mm";
    }
}

TEST(Cap, MovesOnWithItsVelocityUntilItIsPlacedAgain) {
    Cap params{.curvature = -20, .velocity = {0, 0, 0.1}};
    Evaluated<Cap> cap(params);
    EXPECT_EQ(cap({0, 0, 0.002}).height, 0.002) << "the cycle that places it";
    EXPECT_EQ(cap({0, 0, 0.002}, 0, 0).height, 0.002);
    for (int i = 1; i <= 10; ++i) {
        const Contact c = cap({0, 0, 0.002});
        EXPECT_NEAR(c.height, 0.002 - 0.1 * dt * i, 1e-15);
        EXPECT_EQ(cap({0, 0, 0.002}, 0, 0).height, c.height) << "no time, no motion";
        EXPECT_EQ(c.velocity, Vector(0, 0, 0.1));
    }
    params.curvature = -30;
    cap.update(params);
    EXPECT_NEAR(cap({0, 0, 0.002}).height, 0.002 - 0.0011, 1e-15) << "still where it was placed";
    params.foot = {0, 0, 0.001};
    cap.update(params);
    EXPECT_NEAR(cap({0, 0, 0.002}).height, 0.001, 1e-15);
}
