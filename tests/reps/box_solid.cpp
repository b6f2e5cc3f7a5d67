// A solid box holds a hand by the face through which the hand came.

#include <gtest/gtest.h>

#include "random_boxes.hpp"

using namespace knurl;
using namespace knurl::test;

namespace box_solid_tests {
namespace {
constexpr std::uint64_t seed = 4711;
}  // namespace

TEST(SolidBox, OutsideTheDistanceIsThatOfABoxWithRoundedEdges) {
    Rng rng(seed);
    const int rounds = long_form() ? 1'000'000 : 40'000;
    for (int round = 0; round < rounds; ++round) {
        const double size = scale(rng, 1e-6, 10), far = between(rng, 0, 3) ? 0.1 : 1e6;
        const Box box = random_box(rng, size, far);
        const ExactBox exactly(box);
        const Vector p = exactly.world(scale(rng, 0.1, 10) * size * direction(rng));
        const double radius = between(rng, 0, 1) ? uniform(rng, 0, size) : 0;
        const Vec y = exactly.seen(p);
        const Vec out = y - y.cwiseMin(exactly.half).cwiseMax(-exactly.half);
        if (out.norm() < 1e-12 * far) continue;
        const Contact felt = Touchable(box).at(p, radius);
        const double largest = std::max({far, size, p.norm()});
        ASSERT_NEAR(static_cast<double>(out.norm() - radius - felt.height), 0, 1e-12 * largest)
            << seed << " " << round;
        ASSERT_LE((exact(felt.normal) * out.norm() - exactly.axes * out).norm(), 1e-12 * largest)
            << seed << " " << round;
        ASSERT_NEAR(felt.normal.norm(), 1, 1e-15);
    }
}

TEST(SolidBox, IsEnteredByTheFaceThatThePathPassesAndHoldsByItHoweverDeep) {
    Rng rng(seed);
    const int rounds = long_form() ? 400'000 : 20'000;
    int held = 0;
    for (int round = 0; round < rounds; ++round) {
        const double size = scale(rng, 1e-4, 10);
        const Box box = random_box(rng, size, 0.1);
        const ExactBox exactly(box);
        const Vector half = to_eigen(box.half_size);
        Touchable solid(box);
        Vec last = exactly.seen(exactly.world(scale(rng, 1, 100) * 2 * size * direction(rng)));
        solid.at(exactly.world(last.cast<double>()));
        int axis = -1, sign = 0;
        for (int i = 0; i < 20; ++i) {
            const Vector p = exactly.world(
                between(rng, 0, 1)
                    ? any_in(rng, half, 1.5)
                    : Vector(any_in(rng, half, 1) + scale(rng, 1e-3, 10) * size * direction(rng)));
            const Vec y = exactly.seen(p);
            Real margin = INFINITY;
            const auto holds = [&] {
                bool inside = true;
                for (int j = 0; j < 3; ++j) {
                    const Real in =
                        j == axis ? exactly.half[j] - sign * y[j] : exactly.half[j] - std::abs(y[j]);
                    margin = std::min(margin, std::abs(in));
                    inside = inside && in > 0;
                }
                return inside;
            };
            if (axis >= 0) {
                if (!holds()) axis = -1;
            } else {
                const ExactBox::Hit hit = exactly.entry(last, y);
                const Real past = y.norm() - exactly.half.norm();  // then the path has led past the box
                margin = std::min(hit.margin, std::abs(past));
                axis = past > 0 ? -1 : hit.axis, sign = hit.sign;
                if (axis >= 0 && !holds()) axis = -1;
            }
            last = y;
            if (margin < 1e-12 * std::max(0.2, p.norm())) break;  // too close to decide
            const Contact felt = solid.at(p);
            const std::string where = "seed " + std::to_string(seed) + " round " + std::to_string(round) +
                                      " cycle " + std::to_string(i);
            ASSERT_EQ(solid.state.face == 0, axis < 0) << where;
            if (axis < 0) {
                ASSERT_GE(felt.height, 0) << where;
                continue;
            }
            ++held;
            ASSERT_NEAR(static_cast<double>(sign * y[axis] - exactly.half[axis] - felt.height), 0,
                        1e-12 * std::max(0.2, p.norm()))
                << where;
            ASSERT_LE((exact(felt.normal) - sign * exactly.axes.col(axis)).norm(), 1e-12) << where;
        }
    }
    EXPECT_GT(held, rounds);
}

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
        const ExactBox exactly(box);
        const Vector half = to_eigen(box.half_size);
        Touchable solid(box);
        Vector y = half + Vector(0.01, 0.01, 0.01), goal = y;
        Vector last = force_of(solid.at(exactly.world(y), radius));
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
            const Vector force = force_of(solid.at(exactly.world(y), radius));
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
        const ExactBox exactly(box);
        const double radius = round % 2 ? 0.002 : 0;
        Touchable solid(box);
        const Vector start(0.012, 0.003, 0.011);
        Vector y = start;
        solid.at(exactly.world(y), radius);
        double sum = 0, path = 0;
        for (int i = 0; i < 12; ++i) {
            const Vector to =
                i < 11 ? any_in(rng, to_eigen(box.half_size) + Vector(0.004, 0.004, 0.004), 1) : start;
            const int steps = std::max(1, static_cast<int>((to - y).norm() / small));
            const Vector by = (to - y) / steps;
            const Vector in_world = exactly.world(by) - exactly.world(Vector::Zero());
            path += (to - y).norm();
            for (int s = 0; s < steps; ++s) {
                y += by;
                sum -= force_of(solid.at(exactly.world(y), radius)).dot(in_world);
            }
        }
        ASSERT_GE(sum, -1000 * small * path) << "seed " << seed << " round " << round;
    }
}

}  // namespace box_solid_tests
