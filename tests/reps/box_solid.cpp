// A solid box holds a hand by the face through which the hand came.

#include <gtest/gtest.h>

#include "random_boxes.hpp"

using namespace knurl;
using namespace knurl::test;

namespace box_solid_tests {
namespace {
constexpr std::uint64_t seed = 4711;
}  // namespace

TEST(SolidBox, PokedThroughItsMiddleAndOutAtTheBackItStillPushesBack) {
    for (const double half : {0.02, 0.001, 0.0}) {
        Box box = brick();
        box.half_size.z = half;
        Touchable solid(box);
        for (double z = 0.01; z > -0.1; z -= 0.0007) {  // down through top, middle and bottom
            const Contact felt = solid.at({0.001, 0.002, half + z});
            ASSERT_NEAR(felt.height, z, 1e-15);
            ASSERT_EQ(felt.normal, Vector(0, 0, 1));
        }
        EXPECT_NEAR(solid.at({0.001, 0.002, half + 0.001}).height, 0.001, 1e-15);
        EXPECT_NEAR(solid.at({0.001, 0.002, half - 0.02}).height, -0.02, 1e-15);  // and in a single cycle
    }
}

TEST(SolidBox, AStepThatEndsFartherAwayThanItIsLargeHasLedPastIt) {
    Touchable solid(brick());
    const double ball = to_eigen(brick().half_size).norm();
    solid.at({0, 0, 5});
    EXPECT_GT(solid.at({0, 0, -1.01 * ball}).height, 0);
    solid.at({0, 0, 5});
    EXPECT_LT(solid.at({0, 0, -0.99 * ball}).height, -ball) << "held by the face that it passed";
}

TEST(SolidBox, SlidOffItsEdgeWhilePressedItLetsGoOnceAndForGood) {
    for (const double depth : {5e-4, 2e-3, 0.03}) {
        for (const double radius : {0.0, 1e-3}) {
            Touchable solid(brick());
            double largest_jump = 0;
            Vector last(0, 0, 0);
            for (double x = 0.01; x < 0.025; x += 1e-5) {
                const double z = x < 0.0101 ? 0.041 : 0.04 - depth;
                const Vector force = force_of(solid.at({x, 0.001, z}, radius));
                if (x > 0.0102) largest_jump = std::max(largest_jump, (force - last).norm());
                if (x > 0.0102 && x < 0.02 - 1e-9) {
                    ASSERT_NEAR((force - Vector(0, 0, 1000 * (depth + radius))).norm(), 0, 1e-9) << x;
                }
                if (x > 0.02 + 1e-9) {
                    ASSERT_EQ(force.norm(), 0) << x;
                }
                last = force;
            }
            EXPECT_NEAR(largest_jump, 1000 * (depth + radius), 1e-9);  // only the force that pressed
        }
    }
}

TEST(SolidBox, SlidOffItsCornerWhilePressedItLetsGo) {
    Touchable solid(brick());
    for (double s = -0.01; s < 0.003; s += 1e-5) {
        const Contact felt = solid.at({0.02 + s, 0.03 + s, s < -0.0099 ? 0.041 : 0.038});
        if (s > -0.0098 && s < -1e-9) {
            ASSERT_NEAR(felt.height, -0.002, 1e-15);
            ASSERT_EQ(felt.normal, Vector(0, 0, 1));
        }
        if (s > 1e-9) {
            ASSERT_GT(felt.height, 0);
        }
    }
}

TEST(SolidBox, SeenFirstInsideTheNearestFaceHoldsIt) {
    EXPECT_EQ(Touchable(brick()).at({0.019, 0, 0.01}).normal, Vector(1, 0, 0));
    EXPECT_EQ(Touchable(brick()).at({0, -0.028, 0.01}).normal, Vector(0, -1, 0));
    EXPECT_NEAR(Touchable(brick()).at({0, -0.028, 0.01}).height, -0.002, 1e-15);
    Touchable solid(brick());
    solid.at({0, 0, 0.039});
    EXPECT_EQ(solid.at({0.019, 0, 0.01}).normal, Vector(0, 0, 1));  // and continues to hold it
}

TEST(SolidBox, ABallThatPressesByLessThanItsRadiusRollsOverEdgesAndCornersWithoutAJump) {
    constexpr double radius = 4e-3, path = 1e-5;
    Rng rng(seed);
    for (int round = 0; round < 100; ++round) {
        const Box box = random_box(rng, 0.02, 0.1);
        const Vector half = to_eigen(box.half_size);
        Touchable solid(box);
        Vector y = half + Vector(0.01, 0.01, 0.01), goal = y;
        Vector last = force_of(solid.at(in_world(box, y), radius));
        for (int i = 0; i < 3'000; ++i) {
            if ((goal - y).norm() < path) goal = any_in(rng, half + Vector(0.005, 0.005, 0.005), 1);
            Vector to = y + path * (goal - y).normalized();
            // On the surface at a depth of at most half the radius.
            const Vector x = to.cwiseMin(half).cwiseMax(-half);
            if ((to - x).norm() < radius / 2) {
                if ((y - y.cwiseMin(half).cwiseMax(-half)).norm() < radius / 2 + path) goal = y;
                to = x + (y - y.cwiseMin(half).cwiseMax(-half)).normalized() * radius / 2;
                if ((to - y).norm() > 2 * path) {
                    goal = y;
                    continue;
                }
            }
            const double moved = (to - y).norm();
            y = to;
            const Vector force = force_of(solid.at(in_world(box, y), radius));
            ASSERT_LE((force - last).norm(), 1000 * moved * (1 + 1e-3) + 1e-10)
                << seed << " " << round << " " << i;
            last = force;
        }
    }
}

TEST(SolidBox, ABallThatSlipsOffFeelsNothingUntilItIsClearOrEntersAgain) {
    const double r = 0.003;
    for (const bool again : {false, true}) {
        Touchable solid(brick());
        solid.at({0.019, 0, 0.041}, r);
        EXPECT_NEAR(solid.at({0.019, 0, 0.039}, r).height, -0.004, 1e-15);
        EXPECT_EQ(solid.at({0.021, 0, 0.039}, r).height, infinity);
        if (again) {
            EXPECT_NEAR(solid.at({0.019, 0, 0.039}, r).height, -0.004, 1e-15);
            EXPECT_EQ(solid.at({0.019, 0, 0.039}, r).normal, Vector(1, 0, 0));
        } else {
            EXPECT_NEAR(solid.at({0.024, 0, 0.039}, r).height, 0.001, 1e-15);
            EXPECT_NEAR(solid.at({0.022, 0, 0.039}, r).height, -0.001, 1e-15);
        }
    }
}

TEST(SolidBox, NoPathThroughItGivesBackMoreThanItTook) {
    Rng rng(seed);
    constexpr double small = 2e-6;  // m
    for (int round = 0; round < 60; ++round) {
        const Box box = random_box(rng, 0.006, 0.05);
        const double radius = round % 2 ? 0.002 : 0;
        Touchable solid(box);
        const Vector start(0.012, 0.003, 0.011);
        Vector y = start;
        solid.at(in_world(box, y), radius);
        double sum = 0, path = 0;
        for (int i = 0; i < 12; ++i) {
            const Vector to =
                i < 11 ? any_in(rng, to_eigen(box.half_size) + Vector(0.004, 0.004, 0.004), 1) : start;
            const int steps = std::max(1, static_cast<int>((to - y).norm() / small));
            const Vector by = (to - y) / steps;
            const Vector way = to_eigen(box.orientation).normalized() * by;
            path += (to - y).norm();
            for (int s = 0; s < steps; ++s) {
                y += by;
                sum -= force_of(solid.at(in_world(box, y), radius)).dot(way);
            }
        }
        ASSERT_GE(sum, -1000 * small * path) << "seed " << seed << " round " << round;
    }
}

}  // namespace box_solid_tests
