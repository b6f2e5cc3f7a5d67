// The forces of planes from `knurl eval`, against closed forms in long double.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "eval_table.hpp"

namespace knurl::test {
namespace {

using Real = long double;

constexpr double tolerance = 1e-12;  // of the largest force in the test

TEST(EvalPlane, PressesBackWithStiffnessTimesDepthLessDampingAndNeverPulls) {
    // Down to -5 mm in 0.1 s and up again in 0.05 s: the way up is fast enough for the damping to outweigh
    // the depth.
    const auto result = eval("[[plane]]\nstiffness = 800\ndamping = 10\n",
                             "t,x,y,z\n0,0.01,0.02,0.005\n0.1,0.01,0.02,-0.005\n0.15,0.01,0.02,0.005\n");
    ASSERT_EQ(result.rows.size(), 151u);
    bool outweighed = false;
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        const Row& row = result.rows[i];
        const Real t = static_cast<Real>(i) / 1000;
        EXPECT_EQ(row.t, static_cast<double>(i) / 1000);
        const Real z = t < 0.1L ? 0.005L - 0.1L * t : -0.005L + 0.2L * (t - 0.1L);
        // The speed of the segment that begins at this row; for the last row, of the one that ends there.
        const Real speed = i < 100 ? -0.1L : 0.2L;
        const Real force = z < 0 ? std::max(Real{0}, -800 * z - 10 * speed) : 0;
        outweighed = outweighed || (z < -1e-4L && force == 0);
        // Damping has a step exactly on the surface, where either answer is right.
        if (std::abs(z) > 1e-12L) {
            EXPECT_NEAR(row.f[2], static_cast<double>(force), 1e-11) << "cycle " << i;
        }
        EXPECT_EQ(row.f[0], 0);
        EXPECT_EQ(row.f[1], 0);
        EXPECT_NEAR(row.x[2], static_cast<double>(z), 1e-16);
        EXPECT_NEAR(row.p[2], static_cast<double>(std::max(z, Real{0})), 1e-15)
            << "the contact point, cycle " << i;
        EXPECT_EQ(row.p[0], 0.01);
        EXPECT_EQ(row.p[1], 0.02);
    }
    EXPECT_TRUE(outweighed);
}

TEST(EvalPlane, ANormalThatIsNotUnitDividesTheOffsetToo) {
    const auto result =
        eval("[[plane]]\nnormal = [0, 0, 4]\noffset = 0.008\nstiffness = 500\n", rest_at(0.001, 0.01));
    for (const Row& row : result.rows) EXPECT_NEAR(row.f[2], 0.5, tolerance);
}

TEST(EvalPlane, TwoPlanesOfACornerAreSolvedTogether) {
    // Normals 120 degrees apart; the probe is inside both. The nearest free point lies on the edge.
    const Real c = std::cos(std::numbers::pi_v<Real> / 3), s = std::sin(std::numbers::pi_v<Real> / 3);
    char scene[256];
    std::snprintf(scene, sizeof scene,
                  "[[plane]]\nnormal = [%.17Lg, 0, %.17Lg]\nstiffness = 1000\n"
                  "[[plane]]\nnormal = [%.17Lg, 0, %.17Lg]\nstiffness = 1000\n",
                  s, c, -s, c);
    const auto result = eval(scene, "t,x,y,z\n0,0.001,0.5,-0.004\n0.01,0.001,0.5,-0.004\n");
    for (const Row& row : result.rows) {
        EXPECT_NEAR(row.f[0], -1.0, 1e-11);  // k (x - p), x on the edge x = z = 0
        EXPECT_EQ(row.f[1], 0);
        EXPECT_NEAR(row.f[2], 4.0, 1e-11);
        EXPECT_NEAR(row.p[0], 0, 1e-15);
        EXPECT_NEAR(row.p[2], 0, 1e-15);
        EXPECT_EQ(row.p[1], 0.5);
    }
}

TEST(EvalPlane, AProbeWithARadiusTouchesSooner) {
    const auto result =
        eval("[[probe]]\nradius = 0.003\n[[plane]]\nstiffness = 100\n", rest_at(0.002, 0.005));
    for (const Row& row : result.rows) EXPECT_NEAR(row.f[2], 0.1, tolerance);
}

TEST(EvalPlane, TheContactPointLiesOnTheSurfaceAndWithoutContactOnTheProbe) {
    const auto result = eval("[[probe]]\nradius = 0.003\noffset = [0, 0, 0.01]\n[[plane]]\nstiffness = 100\n",
                             "0,0,0,-0.008\n0.01,0,0,-0.008\n0.011,0,0,0.002\n");
    EXPECT_NEAR(result.rows.front().p[2], 0, 1e-15);
    EXPECT_NEAR(result.rows.back().p[2], 0.012, 1e-15);
}

TEST(EvalPlane, AProbeBesideTheHandTurnsIt) {
    // Probe 1 sits 20 mm along the hand's x; the hand is turned by 90 degrees about z, so 20 mm along the
    // world's y.
    const auto result =
        eval("[[probe]]\n[[probe]]\noffset = [0.02, 0, 0]\n[[plane]]\nprobe = 1\nstiffness = 1000\n",
             "t,x,y,z,qw,qx,qy,qz\n"
             "0,0,0,-0.002,0.70710678118654752,0,0,0.70710678118654752\n"
             "0.01,0,0,-0.002,0.70710678118654752,0,0,0.70710678118654752\n");
    for (const Row& row : result.rows) {
        EXPECT_NEAR(row.f[2], 2, tolerance);
        EXPECT_NEAR(row.torque[0], 0.04, 1e-13);  // r x F = 0.02 ey x 2 ez
        EXPECT_NEAR(row.torque[1], 0, 1e-13);
        EXPECT_NEAR(row.torque[2], 0, 1e-13);
        EXPECT_EQ(row.p[2], -0.002) << "probe 0 touches nothing";
    }
}

TEST(EvalPlane, OrientationIsInterpolatedAlongTheShorterArc) {
    // From no turn to 90 degrees about z (its quaternion negated): half-way, the offset points along the
    // diagonal.
    const auto result = eval("[[probe]]\noffset = [0.02, 0, 0]\n[[plane]]\nstiffness = 1000\n",
                             "t,x,y,z,qw,qx,qy,qz\n0,0,0,-0.001,1,0,0,0\n"
                             "0.2,0,0,-0.001,-0.70710678118654752,0,0,-0.70710678118654752\n");
    const Row& half = result.rows.at(100);
    EXPECT_NEAR(half.torque[0], 0.02 * std::sin(std::numbers::pi / 4), 1e-12);
    EXPECT_NEAR(half.torque[1], -0.02 * std::cos(std::numbers::pi / 4), 1e-12);
}

/// A plane at 0 that rises by 3 mm under a probe at rest at -1 mm, at t = 0.02 s; returns the forces from
/// then on.
std::vector<double> after_update(const std::string& more, const std::vector<std::string>& options = {}) {
    const auto result =
        eval("[[plane]]\nid = 1\nstiffness = 1000\n" +
                 (more.find("update") == std::string::npos ? "" : more.substr(more.find("update"))) +
                 "[[plane]]\nid = 1\nat = 0.02\noffset = 0.003\n" + more,
             rest_at(-0.001, 0.2), options);
    std::vector<double> forces;
    for (const Row& row : result.rows) {
        if (row.t < 0.02) {
            EXPECT_NEAR(row.f[2], 1, tolerance) << "before the update, t = " << row.t;
            continue;
        }
        forces.push_back(row.f[2]);
    }
    return forces;
}

/// The share of a change that acts in its n-th cycle (1 is the first): it starts at once, in equal steps.
double share(std::size_t n, double period, double time) {
    return time > 0 ? std::min(1.0, static_cast<double>(n) * period / time) : 1;
}

TEST(EvalPlane, AnUpdateFadesInTenMillisecondsUnlessItSaysOtherwise) {
    struct Case {
        const char* more;
        double time;  // s
    };
    for (const Case& c : {Case{"", 0.01}, Case{"recovery = 0.05\n", 0.05}, Case{"recovery = 0\n", 0}}) {
        const auto forces = after_update(c.more);
        for (std::size_t i = 0; i < forces.size(); ++i) {
            EXPECT_NEAR(forces[i], 1 + 3 * share(i + 1, 1e-3, c.time), 1e-11) << c.more << " cycle " << i;
        }
    }
}

TEST(EvalPlane, TheTimeOfAFadeDoesNotDependOnTheRate) {
    for (const auto& [rate, period] :
         {std::pair("500", 2e-3), {"2000", 5e-4}, {"3000", 1. / 3000}, {"20000", 5e-5}}) {
        const auto forces = after_update("recovery = 0.06\n", {"--rate", rate});
        for (std::size_t i = 0; i < forces.size(); ++i) {
            EXPECT_NEAR(forces[i], 1 + 3 * share(i + 1, period, 0.06), 1e-10) << rate << " Hz, cycle " << i;
        }
    }
}

TEST(EvalPlane, ThePapersUpdateLowersThePlaneToTheProbeAndRaisesItLinearly) {
    // The force drops to zero and returns over 50 ms, or over the stated time (paper, figure 7).
    for (const auto& [more, time] :
         {std::pair("update = 'paper'\n", 0.05), {"recovery = 0.02\nupdate = 'paper'\n", 0.02}}) {
        const auto forces = after_update(more);
        for (std::size_t i = 0; i < forces.size(); ++i) {
            EXPECT_NEAR(forces[i], 4 * share(i + 1, 1e-3, time), 1e-11) << more << " cycle " << i;
        }
    }
}

TEST(EvalPlane, LastDepthKeepsWhatWasFeltAndRaisesTheRestLinearly) {
    const auto forces = after_update("update = 'last_depth'\n");
    for (std::size_t i = 0; i < forces.size(); ++i) {
        EXPECT_NEAR(forces[i], 1 + 3 * share(i + 1, 1e-3, 0.05), 1e-11) << "cycle " << i;
    }
}

TEST(EvalPlane, RemovingFadesOverTheRecoveryThatItHadOrThatTheRemovalStates) {
    struct Case {
        const char* add;
        const char* remove;
        double time;
    };
    for (const Case& c :
         {Case{"", "", 0.01}, Case{"recovery = 0\n", "", 0}, Case{"", "recovery = 0.04\n", 0.04},
          Case{"recovery = 0.05\n", "recovery = 0\n", 0}}) {
        const auto result = eval("[[plane]]\nid = 'w'\nstiffness = 1000\n" + std::string(c.add) +
                                     "[[plane]]\nid = 'w'\nat = 0.02\nremove = true\n" + c.remove,
                                 rest_at(-0.002, 0.1));
        for (std::size_t i = 0; i < result.rows.size(); ++i) {
            const double left = i < 20 ? 1 : 1 - share(i - 19, 1e-3, c.time);
            EXPECT_NEAR(result.rows[i].f[2], 2 * left, 1e-11) << c.add << c.remove << " cycle " << i;
        }
    }
}

TEST(EvalPlane, ARemovalInTheMiddleOfAFadeChangesNothingBeforeItsTime) {
    const auto result = eval(
        "[[plane]]\nid = 'w'\nstiffness = 100\n"
        "[[plane]]\nid = 'w'\nat = 0.02\nstiffness = 1000\nrecovery = 0.1\n"
        "[[plane]]\nid = 'w'\nat = 0.04\nremove = true\nrecovery = 0\n",
        rest_at(-0.005, 0.06));
    EXPECT_NEAR(result.rows[39].f[2], 0.5 + 20 * 0.001 / 0.1 * 4.5, 1e-11);
    EXPECT_EQ(result.rows[40].f[2], 0);
}

TEST(EvalPlane, AnEntryTakesEffectInTheFirstCycleAtOrAfterItsTime) {
    const auto at = [](const char* time) {
        const auto result =
            eval("[[plane]]\nat = " + std::string(time) + "\nrecovery = 0\nstiffness = 1000\n",
                 rest_at(-0.001, 0.1));
        std::size_t first = 0;
        while (first < result.rows.size() && result.rows[first].f[2] == 0) ++first;
        return first;
    };
    EXPECT_EQ(at("0"), 0u);
    EXPECT_EQ(at("0.03"), 30u);
    EXPECT_EQ(at("0.0301"), 31u);
    EXPECT_EQ(at("0.0309999"), 31u);
    EXPECT_EQ(at("0.099"), 99u);
}

TEST(EvalPlane, EntriesAtZeroAreThereFromTheStartWithoutAFade) {
    const auto result = eval("[[plane]]\nstiffness = 1000\nrecovery = 0.5\n", rest_at(-0.001, 0.01));
    for (const Row& row : result.rows) EXPECT_NEAR(row.f[2], 1, tolerance);
}

TEST(EvalPlane, AllRepresentationsOfAClaimMayComeInOneCycle) {
    std::string scene;
    for (int i = 0; i < 1024; ++i) scene += "[[plane]]\nat = 0.005\nrecovery = 0\nstiffness = 1000\n";
    const auto result = eval(scene, rest_at(-0.001, 0.01));
    for (const Row& row : result.rows) EXPECT_NEAR(row.f[2], row.t < 0.005 ? 0 : 1, tolerance) << row.t;
}

}  // namespace
}  // namespace knurl::test
