// box: solid (it holds a hand by the face through which that came) and hollow (three walls at once).

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include <knurl/reps/box.hpp>
#include <knurl/reps/contact_solver.hpp>
#include <knurl/reps/polygon.hpp>

#include "piece_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t seed = 4711;

Box random_box(Rng& rng, double size, double far) {
    const Eigen::Quaterniond pose = turn(rng);
    const double length = scale(rng, 1e-3, 1e3);
    Box box{.center = to_plain(far * direction(rng)),
            .orientation = {length * pose.w(), length * pose.x(), length * pose.y(), length * pose.z()},
            .half_size = {size * scale(rng, 0.1, 1), size * scale(rng, 0.1, 1), size * scale(rng, 0.1, 1)}};
    if (between(rng, 0, 4) == 0) box.half_size.z = 0;
    box.stiffness = 1000;
    return box;
}

// 40 x 60 x 80 mm about the origin.
Box brick() {
    Box box{.half_size = {0.02, 0.03, 0.04}};
    box.stiffness = 1000;
    return box;
}

// The box in long double: its frame from the quaternion as it was sent.
struct Exact {
    Eigen::Matrix<Real, 3, 3> axes;
    Vec center, half;

    explicit Exact(const Box& box) : center(exact(box.center)), half(exact(box.half_size)) {
        const Quat q = box.orientation;
        const Eigen::Matrix<Real, 4, 1> u = Eigen::Matrix<Real, 4, 1>(q.w, q.x, q.y, q.z).normalized();
        const Vec v(u[1], u[2], u[3]);
        for (int i = 0; i < 3; ++i) {  // e + 2 w (v x e) + 2 v x (v x e)
            const Vec e = Vec::Unit(i), once = v.cross(e);
            axes.col(i) = e + 2 * u[0] * once + 2 * v.cross(once);
        }
    }
    Vec seen(const Vector& p) const { return axes.transpose() * (exact(p) - center); }
    Vector world(const Vector& y) const { return (center + axes * exact(y)).cast<double>(); }

    struct Hit {
        int axis = -1;
        int sign = 0;
        Real margin = INFINITY;  // m, by which the rest of the decision was clear
    };
    // Which of the six rectangles does the path a -> b pass from outside?
    Hit entry(const Vec& a, const Vec& b) const {
        Hit hit;
        for (int i = 0; i < 3; ++i) {
            for (const int sign : {1, -1}) {
                const Real from = sign * a[i] - half[i], to = sign * b[i] - half[i];
                hit.margin = std::min({hit.margin, std::abs(from), std::abs(to)});
                if (!(from > 0 && to < 0)) continue;
                const Vec at = a + from / (from - to) * (b - a);
                Real inside = INFINITY;
                for (int j = 0; j < 3; ++j) {
                    if (j != i) inside = std::min(inside, half[j] - std::abs(at[j]));
                }
                hit.margin = std::min(hit.margin, std::abs(inside));
                if (inside > 0) hit.axis = i, hit.sign = sign;
            }
        }
        return hit;
    }
};

Vector any_in(Rng& rng, const Vector& half, double times) {
    return {uniform(rng, -times, times) * half.x(), uniform(rng, -times, times) * half.y(),
            uniform(rng, -times, times) * half.z()};
}

}  // namespace

// --- solid
// --------------------------------------------------------------------------------------------------------------

TEST(SolidBox, OutsideTheDistanceIsThatOfABoxWithRoundedEdges) {
    Rng rng(seed);
    const int rounds = long_form() ? 1'000'000 : 40'000;
    for (int round = 0; round < rounds; ++round) {
        const double size = scale(rng, 1e-6, 10), far = between(rng, 0, 3) ? 0.1 : 1e6;
        const Box box = random_box(rng, size, far);
        const Exact exactly(box);
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
        const Exact exactly(box);
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
                const Exact::Hit hit = exactly.entry(last, y);
                margin = hit.margin;
                axis = hit.axis, sign = hit.sign;
                if (axis >= 0 && !holds()) axis = -1;
            }
            last = y;
            if (margin < 1e-12 * std::max(0.2, p.norm())) break;  // too close to tell
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
        EXPECT_NEAR(solid.at({0.001, 0.002, half - 5}).height, -5, 1e-12);  // and in a single cycle
    }
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
            EXPECT_NEAR(largest_jump, 1000 * (depth + radius), 1e-9);  // what pressed, not more
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
    EXPECT_EQ(solid.at({0.019, 0, 0.01}).normal, Vector(0, 0, 1));  // and goes on holding it
}

TEST(SolidBox, ABallThatPressesByLessThanItsRadiusRollsOverEdgesAndCornersWithoutAJump) {
    constexpr double radius = 4e-3, path = 1e-5;
    Rng rng(seed);
    for (int round = 0; round < 100; ++round) {
        const Box box = random_box(rng, 0.02, 0.1);
        const Exact exactly(box);
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
        const Exact exactly(box);
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

TEST(SolidBox, IsFeltAsItsSixFacesAreOnStrokesInAndOut) {
    Rng rng(seed);
    int strokes = 0;
    for (int round = 0; round < 3'000; ++round) {
        Box box = random_box(rng, 0.03, 0.1);
        const Exact exactly(box);
        const Vector half = to_eigen(box.half_size);
        if (half.minCoeff() < 0.003) continue;
        std::vector<Touchable<Polygon>> faces;
        for (int axis = 0; axis < 3; ++axis) {
            for (const int sign : {1, -1}) {
                Polygon face;
                face.stiffness = 1000;
                face.vertices.count = 4;
                const int a = (axis + 1) % 3, b = (axis + 2) % 3;
                for (int k = 0; k < 4; ++k) {
                    Vector corner = half;
                    corner[axis] = sign * half[axis];
                    corner[a] = (k == 0 || k == 3 ? -1 : 1) * half[a];
                    corner[b] = sign * (k < 2 ? -1 : 1) * half[b];
                    face.vertices.at[k] = to_plain(exactly.world(corner));
                }
                faces.emplace_back(face);
            }
        }
        Touchable solid(box);
        const double radius = between(rng, 0, 1) ? 0.002 : 0;
        // In through one face, about in its column but not beyond the opposite face, and out the same way.
        const int axis = between(rng, 0, 2), sign = between(rng, 0, 1) ? 1 : -1;
        for (int i = 0; i < 40; ++i) {
            Vector y = any_in(rng, half - Vector::Constant(radius), 0.99);  // not where edges are
            const double depth = i % 8 < 4 ? -uniform(rng, 0, 0.02) : uniform(rng, 0, 1.9) * half[axis];
            y[axis] = sign * (half[axis] - depth);
            const Vector p = exactly.world(y);
            const Vector whole = force_of(solid.at(p, radius));
            Vector sum(0, 0, 0);
            for (Touchable<Polygon>& face : faces) sum += force_of(face.at(p, radius));
            ASSERT_LE((whole - sum).norm(), 1e-9) << "seed " << seed << " round " << round << " cycle " << i;
            strokes += whole.norm() > 0;
        }
    }
    EXPECT_GT(strokes, 10'000);
}

TEST(SolidBox, WithoutThicknessItIsAPolygonWithTwoSides) {
    Rng rng(seed);
    for (int round = 0; round < 2'000; ++round) {
        Box box = brick();
        box.half_size.z = 0;
        Polygon polygon;
        polygon.vertices = {.at = {{-.02, -.03, 0}, {.02, -.03, 0}, {.02, .03, 0}, {-.02, .03, 0}},
                            .count = 4};
        polygon.sides = Sides::both;
        Touchable thin(box);
        Touchable plate(polygon);
        const double radius = between(rng, 0, 1) ? 0.004 : 0;
        for (int i = 0; i < 30; ++i) {
            const Vector p = any_in(rng, {0.025, 0.035, 0.01}, 1);
            const Contact a = thin.at(p, radius), b = plate.at(p, radius);
            ASSERT_EQ(a.height == infinity, b.height == infinity) << seed << " " << round << " " << i;
            if (a.height == infinity) continue;
            ASSERT_NEAR(a.height, b.height, 1e-15) << seed << " " << round << " " << i;
            ASSERT_LE((a.normal - b.normal).norm(), 1e-12);
        }
    }
}

TEST(SolidBox, OneThatMovesTakesAHandThatRestsAlongAlsoByAnUpdate) {
    Box box = brick();
    box.velocity = {0, 0, 0.5};
    Touchable solid(box);
    const Vector p(0, 0, 0.05);
    for (int i = 0; i < 300; ++i) {
        const Contact felt = solid.at(p);
        ASSERT_NEAR(felt.height, 0.01 - 0.5e-3 * i, 1e-14);
        ASSERT_EQ(felt.velocity, Vector(0, 0, 0.5));
    }
    Touchable sent(brick());
    sent.at(p);
    Box higher = brick();
    higher.center = {0, 0, 0.06};  // the hand is nearer to its bottom, but came from above
    sent.change(higher);
    EXPECT_NEAR(sent.at(p).height, -0.05, 1e-15);
    EXPECT_EQ(sent.at(p).normal, Vector(0, 0, 1));
}

TEST(SolidBox, WithNoTimePassedTheAnswerIsThatOfTheCycleAndNothingAdvances) {
    Rng rng(seed);
    for (int round = 0; round < 3'000; ++round) {
        Box box = random_box(rng, 0.02, 0.1);
        box.velocity = to_plain(direction(rng));
        box.side = between(rng, 0, 3) ? BoxSide::outside : BoxSide::inside;
        const Exact exactly(box);
        Touchable solid(box);
        const double radius = between(rng, 0, 1) ? 0.003 : 0;
        for (int i = 0; i < 20; ++i) {
            const Vector p =
                exactly.world(any_in(rng, to_eigen(box.half_size) + Vector(0.005, 0.005, 0.005), 1.2));
            const auto before = solid.state;
            if (between(rng, 0, 1)) solid.at(p, radius, 0);
            ASSERT_EQ(std::memcmp(&before, &solid.state, sizeof before), 0);
            const Contact first = solid.at(p, radius);
            const auto after = solid.state;
            const Contact again = solid.at(p, radius, 0);
            ASSERT_EQ(std::memcmp(&after, &solid.state, sizeof after), 0);
            ASSERT_EQ(first.height, again.height) << "seed " << seed << " round " << round;
            ASSERT_EQ(first.normal, again.normal);
        }
    }
}

TEST(SolidBox, IsOutOfReachOutsideOfItsBallUnlessItHoldsTheProbe) {
    Rng rng(seed);
    for (int round = 0; round < 5'000; ++round) {
        Touchable solid(random_box(rng, 0.02, 0.1));
        const auto ball = bound(solid.params, solid.state);
        ASSERT_TRUE(ball);
        const double radius = uniform(rng, 0, 0.01);
        const Vector out = ball->center + (ball->radius * (1 + 1e-9) + radius) * direction(rng);
        ASSERT_GT(solid.at(out, radius).height, 0);
        solid.at(ball->center);
        ASSERT_EQ(bound(solid.params, solid.state).has_value(), solid.state.face == 0);
        out_of_reach(solid.params, solid.state);
        ASSERT_TRUE(bound(solid.params, solid.state));
    }
}

// --- hollow
// -------------------------------------------------------------------------------------------------------------

TEST(HollowBox, ItsWallsTogetherHoldTheProbeAtTheNearestPointInside) {
    Rng rng(seed);
    const int rounds = long_form() ? 1'000'000 : 40'000;
    for (int round = 0; round < rounds; ++round) {
        const double size = scale(rng, 1e-6, 10), far = between(rng, 0, 3) ? 0.1 : 1e6;
        Box box = random_box(rng, size, far);
        box.side = BoxSide::inside;
        const Exact exactly(box);
        const double radius = between(rng, 0, 1) ? uniform(rng, 0, 0.5) * size : 0;
        Touchable hollow(box);
        const Vector p = exactly.world(any_in(rng, to_eigen(box.half_size), 2));
        std::array<Contact, 3> wall;
        ASSERT_EQ(contacts(hollow.params, hollow.state, probe_at(p, radius), step, wall), 3u);
        double nx[3], ny[3], nz[3], s[3];
        for (std::size_t i = 0; i < 3; ++i)
            nx[i] = wall[i].normal.x(), ny[i] = wall[i].normal.y(), nz[i] = wall[i].normal.z(),
            s[i] = -wall[i].height;
        ContactSolution solution;
        const ContactPlanes planes{nx, ny, nz, s, 3};
        solve_contact(planes, worst_violation(planes, Vector::Zero()), 0, solution);
        // A box that is too small for the probe is as if it were just large enough.
        const Vec room = (exactly.half.array() - radius).cwiseMax(0), y = exactly.seen(p);
        const Vec nearest = y.cwiseMin(room).cwiseMax(-room);
        ASSERT_LE((exactly.axes * (nearest - y) - exact(solution.dx)).norm(),
                  1e-12 * std::max({far, size, p.norm()}))
            << "seed " << seed << " round " << round;
        const Contact worst = contact(hollow.params, hollow.state, probe_at(p, radius), step);
        ASSERT_EQ(-worst.height, std::max({s[0], s[1], s[2]}));
    }
}

TEST(HollowBox, AProbeTooThickForItIsPulledToItsMiddleWithoutAStep) {
    Box box = brick();
    box.side = BoxSide::inside;
    Touchable hollow(box);
    for (double x = -0.01; x < 0.01; x += 1e-4) {
        EXPECT_NEAR(force_of(hollow.at({x, 0, 0}, 0.025)).x(), -1000 * x, 1e-9);
    }
}

TEST(HollowBox, HoldsHoweverFarOutsideAndHasNoBound) {
    Box box = brick();
    box.side = BoxSide::inside;
    Touchable hollow(box);
    EXPECT_NEAR(hollow.at({5, 0, 0}).height, -4.98, 1e-12);
    EXPECT_EQ(hollow.at({5, 0, 0}).normal, Vector(-1, 0, 0));
    EXPECT_FALSE(bound(hollow.params, hollow.state));
}

TEST(Box, StaysFiniteForAnythingThatIsLegal) {
    Rng rng(seed);
    for (int round = 0; round < 100'000; ++round) {
        Box box = random_box(rng, scale(rng, 1e-300, 1e9), scale(rng, 1e-300, 1e9));
        box.velocity = to_plain(scale(rng, 1e-9, 1e3) * direction(rng));
        box.side = between(rng, 0, 1) ? BoxSide::outside : BoxSide::inside;
        if (between(rng, 0, 3) == 0) box.half_size.x = 0;
        if (between(rng, 0, 3) == 0) box.half_size.y = 0;
        Touchable any(box);
        for (int i = 0; i < 6; ++i) {
            const double radius = between(rng, 0, 1) ? scale(rng, 1e-12, 1e3) : 0;
            const Vector p =
                between(rng, 0, 5) ? Vector(scale(rng, 1e-300, 1e12) * direction(rng)) : to_eigen(box.center);
            std::array<Contact, 3> found;
            const double dt = std::array{0.0, 1e-6, 0.05}[static_cast<std::size_t>(i % 3)];
            const std::uint32_t count = contacts(any.params, any.state, probe_at(p, radius), dt, found);
            for (std::uint32_t c = 0; c < count; ++c) {
                ASSERT_TRUE(found[c].height == infinity || std::isfinite(found[c].height))
                    << "round " << round;
                ASSERT_NEAR(found[c].normal.norm(), 1, 1e-12) << "seed " << seed << " round " << round;
            }
        }
    }
}
