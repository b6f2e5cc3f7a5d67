// Tests the reference itself, against closed forms.

#include <exact/god_object.hpp>
#include <gtest/gtest.h>

#include "generators.hpp"
#include "paths.hpp"
#include "spoiled.hpp"

namespace {

using namespace knurl::test;
using exact::distance;
using exact::GodObject;
using exact::Real;
using exact::Surface;
using exact::to_exact;
using exact::V;

Surface surface_of(const MadeMesh& s) {
    return Surface(s.vertices, s.triangles);
}

/// The nearest free point of the corner between a floor z = 0 and a wall x = 0.
V clamped(const V& hand) {
    return {std::max<Real>(hand.x, 0), hand.y, std::max<Real>(hand.z, 0)};
}

TEST(ExactSurface, ClosestPointLiesOnWhatItSays) {
    const Surface s = surface_of(icosphere(0));
    Rng rng(1);
    for (int i = 0; i < 20000; ++i) {
        const int f = static_cast<int>(below(rng, s.faces()));
        const V p{between(rng, -.2, .2), between(rng, -.2, .2), between(rng, -.2, .2)};
        const exact::Nearest3 at = s.nearest(f, p);
        // No other point of the face is nearer (Kuhn and Tucker: the vector to p points away from all
        // corners).
        for (int c = 0; c < 3; ++c) ASSERT_LT(dot(p - at.point, s.corner(f, c) - at.point), 1e-19L);
        EXPECT_LT(std::fabs(dot(s.normal(f), at.point - s.corner(f, 0))), 1e-19L);
    }
}

TEST(ExactSurface, WindingTellsInsideFromOutside) {
    const Surface sphere = surface_of(icosphere(3)), hollow = surface_of(hollow_sphere(3));
    EXPECT_TRUE(sphere.closed());
    EXPECT_NEAR(static_cast<double>(sphere.winding({0.01L, 0.02L, 0.03L})), 1, 1e-9);
    EXPECT_NEAR(static_cast<double>(sphere.winding({0.1L, 0.1L, 0})), 0, 1e-9);
    EXPECT_NEAR(static_cast<double>(hollow.winding({0.01L, 0.02L, 0.03L})), 0, 1e-9);
    EXPECT_NEAR(static_cast<double>(hollow.winding({0.097L, 0, 0})), 1, 1e-9);
}

TEST(ExactSurface, GridFindsWhatAllFacesHave) {
    Rng rng(2);
    for (const MadeMesh& shape : clean_shapes(7)) {
        const Surface s = surface_of(shape);
        int hits = 0;
        for (int i = 0; i < 100; ++i) {
            const double far = i % 2 != 0 ? 1 : 0.01;  // long ones through all of it, short ones near it
            const V on = shape.at(static_cast<std::uint32_t>(below(rng, shape.vertices.size())));
            const V u{between(rng, -.1, .1), between(rng, -.1, .1), between(rng, -.1, .1)};
            const V a = on + far * u, b = on - 0.7L * far * u;
            const exact::Crossing one = s.sweep(a, b, 0), all = s.sweep_all(a, b, 0);
            ASSERT_EQ(one.t, all.t) << shape.name;  // two faces may share the point
            if (i % 10 == 0) {
                ASSERT_EQ(s.nearest_face_near(a), s.nearest_face(a)) << shape.name;
            }
            hits += all.face >= 0;
        }
        EXPECT_GT(hits, 30) << shape.name;
    }
}

TEST(ExactGodObject, OnAFloorItIsBelowNothing) {
    const MadeMesh shape = plane_grid();
    const Surface s = surface_of(shape);
    Hands hands(shape, 3);
    int touched = 0;
    for (int path = 0; path < 20; ++path) {
        GodObject god(s);
        for (const auto& p : path % 2 != 0 ? hands.stroke() : hands.poke()) {
            const V hand = to_exact(p);
            const bool touches = god.step(hand);
            if (hand.z != 0) {
                ASSERT_EQ(touches, hand.z < 0);
            }
            const V known{hand.x, hand.y, std::max<Real>(hand.z, 0)};
            ASSERT_LT(distance(god.at(), known), 1e-18L);
            touched += touches;
        }
    }
    EXPECT_GT(touched, 1000);
}

TEST(ExactGodObject, InTheCornerOfABoxFromInside) {
    MadeMesh shape = cube(8, 0.2);
    for (auto& t : shape.triangles) std::swap(t[1], t[2]);
    const Surface s = surface_of(shape);
    Rng rng(4);
    GodObject god(s);
    god.step({0, 0, 0});
    V hand;
    for (int i = 0; i < 20000; ++i) {
        hand += V{between(rng, -.002, .002), between(rng, -.002, .002), between(rng, -.002, .002)};
        hand = V{std::clamp<Real>(hand.x, -.11L, .11L), std::clamp<Real>(hand.y, -.11L, .11L),
                 std::clamp<Real>(hand.z, -.11L, .11L)};
        const Real wall = 0.1;
        const V known{std::clamp(hand.x, -wall, wall), std::clamp(hand.y, -wall, wall),
                      std::clamp(hand.z, -wall, wall)};
        ASSERT_EQ(god.step(hand), distance(hand, known) > 0) << i;
        ASSERT_LT(distance(god.at(), known), 1e-17L) << i;
    }
    EXPECT_EQ(god.unsettled(), 0);
}

TEST(ExactGodObject, AroundABoxNoFaceIsChangedButOverItsEdge) {
    // Inside a box the proxy is at the nearest point of the holding face. It changes to another face only
    // over the edge between both, so not as long as the hand stays within the face's prism.
    const MadeMesh shape = cube(8, 0.2);
    const Surface s = surface_of(shape);
    GodObject god(s);
    god.step({0.11L, 0, 0});
    for (int i = 1; i < 1900; ++i) {
        const V hand{0.1L - 0.0001L * i, 0.02L * std::sin(0.01L * i), 0.03L};
        ASSERT_TRUE(god.step(hand));
        ASSERT_LT(distance(god.at(), V{0.1L, hand.y, hand.z}), 1e-17L);  // even when another face is nearer
    }
    // Over the edge: beyond the end of the top, the side becomes nearer.
    GodObject edge(s);
    edge.step({0.098L, 0.03L, 0.101L});
    EXPECT_TRUE(edge.step({0.098L, 0.03L, 0.095L}));
    EXPECT_LT(distance(edge.at(), V{0.098L, 0.03L, 0.1L}), 1e-17L);
    EXPECT_FALSE(edge.step({0.101L, 0.03L, 0.095L}));
    EXPECT_TRUE(edge.step({0.098L, 0.03L, 0.095L}));
    EXPECT_LT(distance(edge.at(), V{0.1L, 0.03L, 0.095L}), 1e-17L);
}

TEST(ExactGodObject, NoFaceOfASphereIsNearer) {
    const MadeMesh shape = icosphere(4);
    const Surface s = surface_of(shape);
    Hands hands(shape, 5);
    for (int path = 0; path < 20; ++path) {
        GodObject god(s);
        int i = 0;
        for (const auto& p : hands.stroke()) {
            const V hand = to_exact(p);
            const bool touches = god.step(hand);
            if (++i % 10 != 0) continue;
            ASSERT_EQ(touches, s.winding(hand) > 0.5L);
            if (!touches) continue;
            // The body is convex, so every path inside follows the nearest point, apart from its small
            // ridges.
            ASSERT_LT(s.gain(god.at(), hand, 1e-13L), 1e-17L);
            ASSERT_LT(std::fabs(distance(god.at(), hand) - (0.1L - exact::length(hand))), 4e-4L);
        }
    }
}

TEST(ExactGodObject, HoldsAtTheFirstOfTwoSheetsBackToBack) {
    const MadeMesh shape = two_sided_sheet();
    const Surface s = surface_of(shape);
    EXPECT_EQ(s.open_edges(), 0U);
    for (const Real side : {1, -1}) {
        GodObject god(s);
        god.step({0, 0, side * 0.001L});
        for (int i = 0; i < 100; ++i) {
            const V hand{0.0001L * i, 0.00003L * i, -side * 0.0001L * i};
            EXPECT_TRUE(god.step(hand) || i == 0);
            ASSERT_LT(distance(god.at(), V{hand.x, hand.y, 0}), 1e-17L);
        }
    }
}

TEST(ExactGodObject, AFinOnAFloorStopsItFromItsFrontAlone) {
    const Surface s = surface_of(three_sheets());
    GodObject god(s);
    god.step({0.02L, 0.003L, 0.001L});
    for (int i = 0; i < 400; ++i) {
        const V hand{0.02L - 0.0001L * i, 0.003L, -0.001L};
        god.step(hand);
        ASSERT_LT(distance(god.at(), clamped(hand)), 1e-17L) << i;
    }
    GodObject other(s);
    other.step({-0.02L, 0.003L, 0.001L});
    for (int i = 0; i < 400; ++i) {
        const V hand{-0.02L + 0.0001L * i, 0.003L, -0.001L};
        ASSERT_TRUE(other.step(hand));
        ASSERT_LT(distance(other.at(), V{hand.x, hand.y, 0}), 1e-17L) << i;
    }
}

TEST(ExactGodObject, SlipsOffARim) {
    for (const MadeMesh& shape : {plane_grid(), two_sided_sheet()}) {
        const Surface s = surface_of(shape);
        for (const V& way : {V{1, 0, 0}, V{0.6L, -0.8L, 0}, V{1, 1, 0}, V{0, 1, 0}}) {
            GodObject god(s);
            god.step({0.00035L, 0.00011L, 0.001L});
            for (int i = 0; i < 300; ++i) {
                const V hand = V{0.00035L, 0.00011L, -0.001L} + 0.0001L * i * way;
                const bool over = std::max(std::fabs(hand.x), std::fabs(hand.y)) < 0.02L;
                ASSERT_EQ(god.step(hand), over) << shape.name << " " << i;
                ASSERT_LT(distance(god.at(), over ? V{hand.x, hand.y, 0} : hand), 1e-17L);
            }
        }
    }
}

TEST(ExactGodObject, GainSeesAPlaceThatIsNotTheNearest) {
    const Surface s = surface_of(plane_grid());
    const V hand{0.001L, 0, -0.002L};
    EXPECT_LT(s.gain({0.001L, 0, 0}, hand, 1e-9L), 1e-18L);
    EXPECT_GT(s.gain({0.0013L, 0, 0}, hand, 1e-9L), 1e-6L);
    EXPECT_GT(s.gain_in_sight({0.0093L, 0, 0}, {0, 0, 1}, hand, 1e-9L), 1e-3L);
}

}  // namespace
