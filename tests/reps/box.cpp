// box: solid as six polygons, thin as one, moving; hollow. tests/reference/pieces.cpp compares it with the
// reference on random paths.

#include <cstring>

#include <gtest/gtest.h>

#include <knurl/reps/polygon.hpp>

#include "random_boxes.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {
constexpr std::uint64_t seed = 4711;
}  // namespace

TEST(SolidBox, IsFeltAsItsSixFacesAreOnStrokesInAndOut) {
    Rng rng(seed);
    int strokes = 0;
    for (int round = 0; round < 3'000; ++round) {
        Box box = random_box(rng, 0.03, 0.1);
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
                    face.vertices.at[k] = to_plain(in_world(box, corner));
                }
                faces.emplace_back(face);
            }
        }
        Touchable solid(box);
        const double radius = between(rng, 0, 1) ? 0.002 : 0;
        // In through one face, roughly within its column but not beyond the opposite face, and out the same
        // way.
        const int axis = between(rng, 0, 2), sign = between(rng, 0, 1) ? 1 : -1;
        for (int i = 0; i < 40; ++i) {
            Vector y = any_in(rng, half - Vector::Constant(radius), 0.99);  // not where edges are
            // First to where that face's ball still reaches, then to the full depth.
            const double in = i % 8 == 4 ? 5e-4 : 1.9 * half[axis];
            const double depth = i % 8 < 4 ? -uniform(rng, 0, 0.02) : uniform(rng, 0, in);
            y[axis] = sign * (half[axis] - depth);
            const Vector p = in_world(box, y);
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
    Box turned = box;
    turned.orientation = {0, 0, 0, 1};  // sent anew: it starts again from the stated place
    solid.change(turned);
    ASSERT_NEAR(solid.at({0, 0, 0.05}).height, 0.01, 1e-14);
    Touchable sent(brick());
    sent.at(p);
    Box higher = brick();
    higher.center = {0, 0, 0.06};  // the hand is nearer to its bottom, but came from above
    sent.change(higher);
    EXPECT_NEAR(sent.at(p).height, -0.05, 1e-15);
    EXPECT_EQ(sent.at(p).normal, Vector(0, 0, 1));
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

TEST(HollowBox, WhereThereIsRoomForOneContactItsNearestWallHolds) {
    Rng rng(seed);
    for (int round = 0; round < 1'000; ++round) {
        Box box = random_box(rng, 0.02, 0.1);
        box.side = Side::inside;
        Touchable hollow(box);
        const Vector p = in_world(box, any_in(rng, to_eigen(box.half_size), 2));
        std::array<Contact, 3> wall;
        ASSERT_EQ(contacts(hollow.params, hollow.state, probe_at(p), step, wall), 3u);
        const double nearest = std::min({wall[0].height, wall[1].height, wall[2].height});
        ASSERT_EQ(hollow.at(p).height, nearest) << "seed " << seed << " round " << round;
    }
}

TEST(HollowBox, AProbeTooThickForItIsPulledToItsMiddleWithoutAStep) {
    Box box = brick();
    box.side = Side::inside;
    Touchable hollow(box);
    for (double x = -0.01; x < 0.01; x += 1e-4) {
        EXPECT_NEAR(force_of(hollow.at({x, 0, 0}, 0.025)).x(), -1000 * x, 1e-9);
    }
}

TEST(HollowBox, HoldsHoweverFarOutsideAndHasNoBound) {
    Box box = brick();
    box.side = Side::inside;
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
        box.side = between(rng, 0, 1) ? Side::outside : Side::inside;
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
