// The forces of springs and constant forces from `knurl eval`, against closed forms in long double.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "eval_table.hpp"

namespace knurl::test {
namespace {

using Real = long double;

TEST(EvalSpring, PullsTowardsItsAnchorWithDampingAlongIt) {
    const auto result = eval("[[spring]]\nanchor = [0.03, 0, 0.04]\nstiffness = 200\ndamping = 3\n",
                             "t,x,y,z\n0,0,0,0\n0.1,0.01,0.02,-0.03\n");
    for (const Row& row : result.rows) {
        const Real v[3] = {0.1L, 0.2L, -0.3L};
        const Real d[3] = {0.03L - row.x[0], -static_cast<Real>(row.x[1]), 0.04L - row.x[2]};
        const Real square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        const Real along = (v[0] * d[0] + v[1] * d[1] + v[2] * d[2]) / square;
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_NEAR(row.f[a], static_cast<double>(200 * d[a] - 3 * along * d[a]), 1e-11) << row.t;
            EXPECT_EQ(row.torque[a], 0);
        }
    }
}

TEST(EvalSpring, HasARestLengthAroundWhichItIsSmooth) {
    // F = k (1 - L0/sqrt(l^2 + e^2)) d with e = min(1 mm, L0/20).
    const auto result = eval("[[spring]]\nstiffness = 500\nrest_length = 0.01\n", press(0.03, -0.02, 0.5));
    for (const Row& row : result.rows) {
        const Real d = -static_cast<Real>(row.x[2]), e = 0.01L / 20;
        EXPECT_NEAR(row.f[2], static_cast<double>(500 * (1 - 0.01L / std::sqrt(d * d + e * e)) * d), 1e-11)
            << row.t;
    }
}

TEST(EvalSpring, OffTheProbesMiddleItTurnsTheHand) {
    const auto result =
        eval("[[spring]]\nanchor = [0, 0, 0.05]\nattach = [0.01, 0, 0]\nstiffness = 100\n", rest_at(0, 0.01));
    for (const Row& row : result.rows) {
        EXPECT_NEAR(row.f[0], -1, 1e-12);
        EXPECT_NEAR(row.f[2], 5, 1e-12);
        EXPECT_NEAR(row.torque[1], -0.05, 1e-14);  // (0.01 ex) x (-1, 0, 5)
    }
}

TEST(EvalSpring, AnUpdateMovesItsEndAndItsRestLengthLinearly) {
    for (const auto& [more, time] :
         {std::pair("", 0.2), {"duration = 0.05\n", 0.05}, {"duration = 0\n", 0.0}}) {
        const auto result = eval(
            "[[spring]]\nid = 's'\nanchor = [0.01, 0, 0]\nstiffness = 100\n"
            "[[spring]]\nid = 's'\nat = 0.03\nanchor = [0.05, 0, 0.02]\n" +
                std::string(more),
            rest_at(0, 0.4));
        for (std::size_t i = 0; i < result.rows.size(); ++i) {
            const double n = static_cast<double>(i) - 29;  // cycles of the motion; the first is at 0.03 s
            const double share = n <= 0 ? 0 : time > 0 ? std::min(1.0, n * 1e-3 / time) : 1;
            EXPECT_NEAR(result.rows[i].f[0], 1 + 4 * share, 1e-11) << more << "cycle " << i;
            EXPECT_NEAR(result.rows[i].f[2], 2 * share, 1e-11) << more << "cycle " << i;
        }
    }
}

TEST(EvalConstantForce, IsTheSameEverywhereAndFadesWhenItChanges) {
    const auto result = eval(
        "[[constant_force]]\nid = 1\nforce = [1, -2, 3]\ntorque = [0.1, 0.2, -0.3]\n"
        "[[constant_force]]\nid = 1\nat = 0.01\nforce = [0, 0, 0]\nrecovery = 0.02\n"
        "[[constant_force]]\nid = 1\nat = 0.05\nremove = true\n",
        press(0.1, -0.1, 0.1));
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        const Row& row = result.rows[i];
        const auto faded = [&](std::size_t from, double cycles) {
            return i < from ? 1 : std::max(0.0, 1 - static_cast<double>(i - from + 1) / cycles);
        };
        EXPECT_NEAR(row.f[0], faded(10, 20), 1e-13) << i;
        EXPECT_NEAR(row.f[1], -2 * faded(10, 20), 1e-13) << i;
        EXPECT_NEAR(row.f[2], 3 * faded(10, 20), 1e-13) << i;
        EXPECT_NEAR(row.torque[1], 0.2 * faded(50, 20), 1e-13)
            << "removal fades over the recovery it had: " << i;
    }
}

/// The force at each row of a straight press through z, of a scene with one effect.
template <class Want>
void expect_forces(const std::string& scene, double z0, double z1, Want want) {
    const auto result = eval(scene, press(z0, z1, 0.1));
    const double v = (z1 - z0) / 0.1;
    for (const Row& row : result.rows) {
        const std::array<double, 3> force = want(row.x[2], v, row.t);
        for (std::size_t a = 0; a < 3; ++a)
            EXPECT_NEAR(row.f[a], force[a], 1e-11) << scene << row.t << " s, " << a;
    }
}

TEST(EvalField, IsItsSeriesWithinItsRadius) {
    expect_forces(
        "[[taylor]]\norigin = [0, 0, 0.01]\nforce = [1, 0, -1]\njacobian = [[0, 0, 20], [0, 0, 0], [0, 0, "
        "-300]]\n",
        0.03, -0.02, [](double z, double, double) {
            return std::array{1 + 20 * (z - 0.01), 0.0, -1 - 300 * (z - 0.01)};
        });
    expect_forces(
        "[[taylor6]]\nforce = [0, 0, 3]\nradius = 0.01\nedge = 'hold'\njacobian = ["
        "0, 0, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0,  0, 0, -100, 0, 0, 0,"
        "0, 0, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0]\n",
        0.03, -0.03, [](double z, double, double) {
            return std::array{0.0, 0.0, 3 - 100 * std::clamp(z, -0.01, 0.01)};
        });
}

TEST(EvalViscosity, IsAgainstTheMotion) {
    expect_forces("[[viscosity]]\ndamping = 5\n", 0.03, -0.02, [](double, double v, double) {
        return std::array{0.0, 0.0, -5 * v};
    });
}

TEST(EvalGravity, IsAWeight) {
    expect_forces("[[gravity]]\nmass = 0.25\n", 0.03, -0.02, [](double, double, double) {
        return std::array{0.0, 0.0, -0.25 * 9.81};
    });
}

TEST(EvalMagnet, DrawsNearAndLetsGoFar) {
    expect_forces("[[magnet]]\nstiffness = 200\nmax_force = 2\nmax_distance = 0.03\n", 0.04, -0.04,
                  [](double z, double, double) {
                      const double x = std::abs(z);
                      const double f = x < 0.01 ? 200 * x : x < 0.03 ? 2 * (0.03 - x) / 0.02 : 0;
                      return std::array{0.0, 0.0, z > 0 ? -f : f};
                  });
}

TEST(EvalConstraint, HoldsToItsLine) {
    expect_forces(
        "[[constraint]]\nshape = 'line'\norigin = [0.01, 0, 0]\ndirection = [1, 0, 1]\nstiffness = "
        "300\ndamping = 2\n",
        0.03, -0.02, [](double z, double v, double) {
            // Across (1, 0, 1): half the difference of x and z.
            const double across = 300 * (-0.01 - z) / 2 - 2 * v / 2;
            return std::array{-across, 0.0, across};
        });
}

TEST(EvalVibration, IsASineOfTheServosTime) {
    expect_forces("[[vibration]]\namplitude = 0.5\nfrequency = 40\n", 0.03, -0.02,
                  [](double, double, double t) {
                      const double cycles = std::round(t * 1000) + 1;  // the first cycle counts as a step
                      return std::array{0.0, 0.0, 0.5 * std::sin(2 * M_PI * 40 * 1e-3 * cycles)};
                  });
}

TEST(EvalScene, AnEmptySceneIsFelt) {
    const auto result = eval("", press(0.01, -0.01, 0.1));
    ASSERT_EQ(result.rows.size(), 101u);
    for (const Row& row : result.rows) {
        EXPECT_EQ(row.f, (std::array<double, 3>{}));
        EXPECT_EQ(row.p, row.x) << "nothing is touched: p is the probe";
    }
}

TEST(EvalScene, WhatActsOnOneProbeAddsUp) {
    const auto result = eval(
        "[[plane]]\nstiffness = 1000\n[[constant_force]]\nforce = [0, 0, -5]\n"
        "[[spring]]\nanchor = [0, 0.1, -0.002]\nstiffness = 10\n",
        rest_at(-0.002, 0.01));
    for (const Row& row : result.rows) {
        EXPECT_NEAR(row.f[2], 2 - 5, 1e-12);
        EXPECT_NEAR(row.f[1], 1, 1e-12);
    }
}

}  // namespace
}  // namespace knurl::test
