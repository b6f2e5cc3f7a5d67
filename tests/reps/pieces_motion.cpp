// polygon and half_plane in motion, with updates, and with a probe that has a radius.

#include <cstring>

#include <gtest/gtest.h>

#include "random_pieces.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

// The hand's net work along a path in small steps (N m): the part that it does not get back is lost.
template <class R>
double work(Touchable<R>& piece, Vector& p, const Vector& to, double radius) {
    const int steps = std::max(1, static_cast<int>((to - p).norm() / 2e-6));
    const Vector by = (to - p) / steps;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        p += by;
        sum -= force_of(piece.at(p, radius)).dot(by);
    }
    return sum;
}

template <class R>
struct PiecesInMotion : testing::Test {
    static constexpr std::uint64_t seed = 20261;
    Rng rng{seed};
};
TYPED_TEST_SUITE(PiecesInMotion, PieceKinds);

}  // namespace

TEST(PieceInMotion, OneThatMovesTakesAHandThatRestsAlong) {
    Polygon raw = square();
    raw.velocity = {0, 0, 0.5};
    Touchable piece(raw);
    const Vector p(0.001, 0.002, 0.01);
    for (int i = 0; i < 100; ++i) {
        const Contact felt = piece.at(p);
        // in its first cycle it is at the stated place
        EXPECT_NEAR(felt.height, 0.01 - 0.5e-3 * i, 1e-15);
        EXPECT_EQ(felt.velocity, Vector(0, 0, 0.5));
    }
    EXPECT_EQ(piece.state.touched, 1);
}

TEST(PieceInMotion, AnUpdateThatCarriesOneThroughTheHandTakesItAlong) {
    for (const bool turned : {false, true}) {
        Polygon raw = square(turned ? Sides::both : Sides::front), beyond = raw, aside = raw;
        for (std::uint32_t i = 0; i < 4; ++i) {
            beyond.vertices.at[i].z += 0.02;
            aside.vertices.at[i].x += 0.1;
            aside.vertices.at[i].z += 0.02;
        }
        if (turned)
            std::swap(beyond.vertices.at[0], beyond.vertices.at[2]);  // the corners in the opposite order
        Touchable piece(raw);
        piece.at({0, 0, 0.01});
        piece.change(beyond);
        Contact felt = piece.at({0, 0, 0.01});
        EXPECT_NEAR(felt.height, -0.01, 1e-15);
        EXPECT_NEAR(felt.normal.z(), 1, 1e-15);
        piece.change(raw);  // and back again: free, as before
        EXPECT_NEAR(piece.at({0, 0, 0.01}).height, 0.01, 1e-15);

        Touchable other(raw);
        other.at({0, 0, 0.01});
        other.change(aside);
        other.at({0, 0, 0.01});
        EXPECT_EQ(other.state.touched, 0);
    }
}

TEST(PieceInMotion, AnUpdateThatBringsOneFromElsewhereIsNotACrossing) {
    Polygon aside = square(), over = square();
    for (std::uint32_t i = 0; i < 4; ++i) {
        aside.vertices.at[i].x += 0.1;
        over.vertices.at[i].z += 0.02;
    }
    Touchable piece(aside);
    piece.at({0, 0, 0.01});
    piece.change(over);
    EXPECT_EQ(piece.at({0, 0, 0.01}).height, infinity);  // seen from behind
}

TEST(PieceInMotion, AnUpdateStartsWhereItSays) {
    Polygon raw = square();
    raw.velocity = {0, 0, 1};
    Touchable piece(raw);
    for (int i = 0; i < 6; ++i) piece.at({0, 0, 0.01});  // it has risen to z = 5 mm
    Polygon next = square();
    for (std::uint32_t i = 0; i < 4; ++i) next.vertices.at[i].z = 0.006;  // still below the hand
    piece.change(next);
    EXPECT_NEAR(piece.at({0, 0, 0.01}).height, 0.004, 1e-15);
    EXPECT_EQ(piece.state.touched, 0);
    next.velocity = {0, 0, -1};  // only the velocity changes: it starts from the stated place
    piece.change(next);
    EXPECT_NEAR(piece.at({0, 0, 0.01}).height, 0.004, 1e-15);
    EXPECT_NEAR(piece.at({0, 0, 0.01}).height, 0.005, 1e-15);
    next.velocity = {0, 0, 1};
    piece.change(next);
    EXPECT_NEAR(piece.at({0, 0, 0.01}).height, 0.004, 1e-15);
}

TEST(PieceInMotion, AnUpdateThroughTheHandCountsWhereThePieceHasMovedTo) {
    Polygon raw = square();
    raw.velocity = {1, 0, 0};
    Touchable piece(raw);
    for (int i = 0; i < 31; ++i) piece.at({0.03, 0, 0.01});  // by now it lies under the hand
    Polygon beyond = square();
    for (std::uint32_t i = 0; i < 4; ++i) {
        beyond.vertices.at[i].x += 0.03;
        beyond.vertices.at[i].z += 0.02;
    }
    piece.change(beyond);
    EXPECT_NEAR(piece.at({0.03, 0, 0.01}).height, -0.01, 1e-15);
}

TEST(PieceInMotion, AnUpdateOfWhatItFeelsLikeLetsNothingGo) {
    Polygon raw = square();
    raw.velocity = {0, 0, 0.1};
    Touchable piece(raw);
    piece.at({0, 0, 0.001});
    const double height = piece.at({0, 0, -0.002}).height;
    raw.stiffness = 10;
    piece.change(raw);
    // not moved either: its motion continues
    EXPECT_NEAR(piece.at({0, 0, -0.002}).height, height - 1e-4, 1e-15);
}

TEST(PieceInMotion, ACrossingSeenWithNoTimePassedIsFeltButNotRecorded) {
    Touchable piece(square());
    piece.at({0, 0, 1e-3});
    EXPECT_NEAR(piece.at({0, 0, -1e-3}, 0, 0).height, -1e-3, 1e-15);
    EXPECT_EQ(piece.state.touched, 0);
    EXPECT_NEAR(piece.at({0.03, 0, 1e-3}, 0, 0).height, std::hypot(0.01, 1e-3), 1e-15);
}

TEST(PieceInMotion, ABallThatSlidesOnAndAroundAPlateFeelsNoJump) {
    constexpr double radius = 4e-3, path = 1e-5;
    Rng rng(7);
    for (int round = 0; round < 200; ++round) {
        Polygon raw = random_polygon(rng, 0.02, 0.1);
        raw.sides = Sides::both;
        const exact::Piece exactly = exact::piece_of(raw);
        Touchable piece(raw);
        Vector p = over(exactly, rng, 0.01, 0.01), goal = p;
        Vector last = force_of(piece.at(p, radius));
        for (int i = 0; i < 3'000; ++i) {
            if ((goal - p).norm() < path) goal = over(exactly, rng, 0.02, uniform(rng, -1, 1) * 0.006);
            const int before = piece.state.touched;
            const Vector to = p + path * (goal - p).normalized();
            // Not where an edge is nearer to the centre than half a radius, or beyond: there the plate slips
            // past.
            const exact::V centre = exact::real(to), now = exact::real(p);
            if (exactly.margin(centre) < path &&
                exact::length(centre - exactly.nearest(centre)) < radius / 2) {
                const bool above = exact::dot(now - exactly.point, exactly.normal) > 0;
                goal = over(exactly, rng, 0.005, 0.01 * (above ? 1 : -1));
                if (exactly.margin(now) < 2 * path) break;
                continue;
            }
            const bool leaves = before != 0 && exactly.margin(centre) < path;
            if (leaves) break;
            p = to;
            const Vector force = force_of(piece.at(p, radius));
            ASSERT_LE((force - last).norm(), 1000 * path * (1 + 1e-6) + 1e-12)
                << "round " << round << " cycle " << i;
            last = force;
        }
    }
}

TEST(PieceInMotion, ABallIsFeltFromTheOutsideThroughTheCentresCrossingWithoutAStep) {
    for (const Sides sides : {Sides::front, Sides::both}) {
        Touchable piece(square(sides));
        for (double z = 0.01; z > -0.01; z -= 1e-4) {
            EXPECT_NEAR(piece.at({0.004, 0.002, z}, 0.003).height, z - 0.003, 1e-15);
        }
    }
}

TEST(PieceInMotion, EdgesAreRoundFromAllDirectionsAlsoOfAOneSidedPiece) {
    const double beside = 0.001, r = 0.003;
    for (const Sides sides : {Sides::front, Sides::both}) {
        for (const double z : {0.001, -0.001}) {
            const Contact felt = Touchable(square(sides)).at({0.02 + beside, 0, z}, r);
            EXPECT_NEAR(felt.height, std::hypot(beside, 0.001) - r, 1e-15);
            EXPECT_NEAR(felt.normal.x(), std::sqrt(0.5), 1e-12);
            EXPECT_NEAR(felt.normal.z(), std::copysign(std::sqrt(0.5), z), 1e-12);
        }
    }
}

TEST(PieceInMotion, ABallThatSlipsOffAnEdgeFeelsNothingUntilItIsClearOrCrossesAnew) {
    const double r = 0.003;
    for (const Sides sides : {Sides::front, Sides::both}) {
        for (const bool anew : {false, true}) {
            Touchable piece(square(sides));
            piece.at({0.019, 0, 0.001}, r);
            EXPECT_NEAR(piece.at({0.0199, 0, -0.001}, r).height, -0.004, 1e-15);
            EXPECT_EQ(piece.at({0.0201, 0, -0.001}, r).height, infinity);
            EXPECT_EQ(piece.at({0.021, 0, 0.001}, r).height, infinity);  // up beside it, still overlapping
            if (anew) {
                EXPECT_EQ(piece.at({0.019, 0, 0.001}, r).height, infinity);
                EXPECT_NEAR(piece.at({0.019, 0, -0.001}, r).height, -0.004, 1e-15);
            } else {
                EXPECT_NEAR(piece.at({0.024, 0, 0}, r).height, 0.001, 1e-15);
                EXPECT_NEAR(piece.at({0.021, 0, 0}, r).height, -0.002, 1e-15);
            }
        }
    }
}

TEST(PieceInMotion, ABallFromBehindAOneSidedPieceIsLetThroughUntilAllOfItHasPassed) {
    const double r = 0.003;
    Touchable piece(square());
    for (double z = -0.01; z < 0.0029; z += 1e-4) EXPECT_EQ(piece.at({0, 0, z}, r).height, infinity) << z;
    EXPECT_EQ(piece.at({0, 0, -0.001}, r).height, infinity);  // also back again
    for (const double z : {0.001, 0.0031}) piece.at({0, 0, z}, r);
    EXPECT_NEAR(piece.at({0, 0, 0.002}, r).height, -0.001, 1e-15);
    EXPECT_NEAR(piece.at({0, 0, -0.002}, r).height, -0.005, 1e-15);
}

TEST(PieceInMotion, NoPathThroughThemGivesBackMoreThanItTook) {
    Rng rng(11);
    for (int round = 0; round < 60; ++round) {
        Polygon raw = random_polygon(rng, 0.01, 0.05);
        raw.sides = round % 2 ? Sides::both : Sides::front;
        const double radius = round % 3 ? 0 : 0.002;
        const exact::Piece exactly = exact::piece_of(raw);
        Touchable piece(raw);
        const Vector start = over(exactly, rng, 0.002, 0.01);
        Vector p = start;
        piece.at(p, radius);
        double sum = 0, path = 0;
        for (int i = 0; i < 12; ++i) {
            const Vector to = i < 11 ? over(exactly, rng, 0.012, uniform(rng, -0.004, 0.008)) : start;
            path += (to - p).norm();
            sum += work(piece, p, to, radius);
        }
        ASSERT_GE(sum, -1000 * 2e-6 * path)
            << "round " << round;  // the sum of steps of 2 um is off by k step path / 2
    }
}
