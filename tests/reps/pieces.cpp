// polygon and half_plane: finite flat pieces that know from which side they were entered.

#include <limits>

#include <gtest/gtest.h>

#include "random_pieces.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class R>
R random_piece(Rng& rng, double size, double far) {
    if constexpr (std::is_same_v<R, Polygon>) {
        return random_polygon(rng, size, far);
    } else {
        return random_half_plane(rng, far);
    }
}

template <class R>
struct Pieces : testing::Test {
    static constexpr std::uint64_t seed = 20261;
    Rng rng{seed};
};
using Kinds = testing::Types<Polygon, HalfPlane>;
TYPED_TEST_SUITE(Pieces, Kinds);

// A 40 mm square in z = 0 about the origin, facing up.
Polygon square(Sides sides = Sides::front) {
    Polygon polygon;
    polygon.vertices = {.at = {{-.02, -.02, 0}, {.02, -.02, 0}, {.02, .02, 0}, {-.02, .02, 0}}, .count = 4};
    polygon.stiffness = 1000;
    polygon.sides = sides;
    return polygon;
}

// The work that the hand does along a path in small steps (N m): what it puts in and does not get back is
// lost.
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

}  // namespace

// --- where it is
// -----------------------------------------------------------------------------------------------------

TYPED_TEST(Pieces, BeforeItIsEnteredTheNearestPointIsFeltAsAPlateWithRoundedEdges) {
    const int rounds = long_form() ? 1'000'000 : 40'000;
    for (int round = 0; round < rounds; ++round) {
        const double size = scale(this->rng, 1e-6, 1), far = between(this->rng, 0, 3) ? 0.1 : 1e6;
        TypeParam raw = random_piece<TypeParam>(this->rng, size, far);
        raw.sides = Sides::both;
        if (std::is_same_v<TypeParam, Polygon> && size < 1e-8 * far) continue;
        const Exact reference(raw);
        const double off = scale(this->rng, 1e-3, 10) * size;
        const Vector p = reference.over(this->rng, scale(this->rng, 1e-3, 10) * size,
                                        between(this->rng, 0, 1) ? off : -off);
        const double radius = between(this->rng, 0, 1) ? uniform(this->rng, 0, 1) * size : 0;
        const Contact felt = Touchable(raw).at(p, radius);
        const Vec away = exact(p) - reference.nearest(exact(p));
        const auto largest = static_cast<double>(std::max({reference.largest, exact(p).norm(), away.norm()}));
        ASSERT_NEAR(static_cast<double>(away.norm() - radius - felt.height), 0, 1e-12 * largest)
            << "seed " << this->seed << " round " << round;
        // The normal times the distance is the way from the nearest point.
        ASSERT_LE((exact(felt.normal) * away.norm() - away).norm(), 1e-12 * largest)
            << "seed " << this->seed << " round " << round;
        ASSERT_NEAR(felt.normal.norm(), 1, 1e-15);
    }
}

TYPED_TEST(Pieces, OnAnyPathItIsTouchedHeldAndLetGoAsTheRulesSay) {
    const int rounds = long_form() ? 100'000 : 4'000;
    int entered = 0, from_behind = 0, left = 0, passed = 0;
    for (int round = 0; round < rounds; ++round) {
        const double size = scale(this->rng, 1e-4, 1);
        TypeParam raw = random_piece<TypeParam>(this->rng, size, 0.1);
        raw.sides = between(this->rng, 0, 1) ? Sides::both : Sides::front;
        raw.velocity = to_plain(uniform(this->rng, 0, 1) * size / step * direction(this->rng));
        const Vector drift = step * to_eigen(raw.velocity);
        Touchable piece(raw);
        Expected expected{.piece = Exact(raw), .both = raw.sides == Sides::both};
        const double radius = between(this->rng, 0, 1) ? scale(this->rng, 1e-3, 1) * size : 0;
        for (int i = 0; i < 30; ++i) {  // from anywhere to anywhere else in each cycle
            const double reach = scale(this->rng, 1e-3, 3) * size;
            const Vector at = expected.piece.over(this->rng, scale(this->rng, 0.05, 1.2) * size,
                                                  uniform(this->rng, -1, 1) * reach);
            const Vector p = at + i * drift;
            const int before = expected.touched;
            const auto must = expected.at(exact(at), radius);
            const auto largest = static_cast<double>(std::max(expected.piece.largest, exact(p).norm()));
            if (expected.clear < 1e-11 * largest) break;
            const Contact felt = piece.at(p, radius);
            const std::string where = "seed " + std::to_string(this->seed) + " round " +
                                      std::to_string(round) + " cycle " + std::to_string(i);
            ASSERT_EQ(piece.state.touched, expected.touched) << where;
            ASSERT_EQ(felt.height == infinity, must.none) << where;
            if (!must.none) {
                ASSERT_NEAR(static_cast<double>(must.height - felt.height), 0, 1e-12 * largest) << where;
                if (must.height + radius > 1e-6 * size || expected.touched != 0) {
                    ASSERT_LE((exact(felt.normal) - must.normal).norm(), 1e-5) << where;
                }
            }
            ASSERT_EQ(felt.velocity, to_eigen(raw.velocity));
            entered += before == 0 && expected.touched > 0;
            from_behind += before == 0 && expected.touched < 0;
            left += before != 0 && expected.touched == 0;
            passed += must.none && expected.let_go == Expected::slipped;
        }
    }
    EXPECT_GT(entered, rounds);  // the paths really are of all sorts
    EXPECT_GT(from_behind, rounds / 4);
    EXPECT_GT(left, rounds);
    EXPECT_GT(passed, rounds / 100);
}

TEST(HalfPlane, ItsInequalityHoldsAsItIsWrittenAlsoWhereTheEdgeIsOblique) {
    // Points of x + z = 2 (normal 3 0 3, offset 6) with 2 x <= 3: the edge runs along y through (1.5, 0,
    // 0.5).
    HalfPlane raw{.normal = {3, 0, 3}, .offset = 6, .edge = {2, 0, 0}, .edge_offset = 3};
    raw.sides = Sides::both;
    const Vector out = Vector(1, 0, -1).normalized(), rim(1.5, 7, 0.5);
    const Contact inside = Touchable(raw).at(rim - 0.01 * out + Vector(1e-3, 0, 1e-3));
    EXPECT_NEAR(inside.height, std::sqrt(2e-6), 1e-12);
    EXPECT_LE((inside.normal - Vector(1, 0, 1).normalized()).norm(), 1e-12);
    const Contact beyond = Touchable(raw).at(rim + 0.01 * out);
    EXPECT_NEAR(beyond.height, 0.01, 1e-12);
    EXPECT_LE((beyond.normal - out).norm(), 1e-12);
}

TEST(Polygon, FacesTheSideFromWhichItsCornersRunCounterClockwise) {
    Polygon raw = square();
    EXPECT_GT(Touchable(raw).at({0, 0, 1e-3}).height, 0);
    EXPECT_LT(Touchable(raw).at({0, 0, 1e-3}).height, 1);
    EXPECT_EQ(Touchable(raw).at({0, 0, -1e-3}).height, infinity);
    std::swap(raw.vertices.at[0], raw.vertices.at[2]);
    EXPECT_EQ(Touchable(raw).at({0, 0, 1e-3}).height, infinity);
    EXPECT_LT(Touchable(raw).at({0, 0, -1e-3}).height, 1);
}

// --- no way through
// ---------------------------------------------------------------------------------------------------

TYPED_TEST(Pieces, NothingTunnelsAtAnySpeedNorPopsOutHoweverDeep) {
    for (int round = 0; round < 20'000; ++round) {
        const double size = scale(this->rng, 1e-3, 1);
        TypeParam raw = random_piece<TypeParam>(this->rng, size, 0.1);
        raw.sides = between(this->rng, 0, 1) ? Sides::both : Sides::front;
        Exact exactly(raw);
        // Over the middle of the piece, so the foot stays inside.
        const double third = 0.05 * size / 3;
        if (exactly.corners.empty()) exactly.middle -= 2 * third * exactly.edge;
        const int from = raw.sides == Sides::both && between(this->rng, 0, 1) ? -1 : 1;
        Touchable piece(raw);
        const auto place = [&](double height) { return exactly.over(this->rng, third, from * height); };
        piece.at(place(scale(this->rng, 1e-9, 100)));
        for (int i = 0; i < 10; ++i) {
            const double depth = scale(this->rng, 1e-9, 100);
            const Contact felt = piece.at(place(-depth));
            ASSERT_NEAR(felt.height, -depth, 1e-12 * 101) << "seed " << this->seed << " round " << round;
            ASSERT_LE((exact(felt.normal) - from * exactly.normal).norm(), 1e-9);
        }
        const Contact back = piece.at(place(1e-3));
        ASSERT_NEAR(back.height, 1e-3, 1e-12);
        ASSERT_EQ(piece.state.touched, 0);
    }
}

TEST(Piece, AHandThatComesToLieExactlyInTheFaceIsStillOnItsSide) {
    for (const Sides sides : {Sides::front, Sides::both}) {
        Touchable piece(square(sides));
        piece.at({0, 0, 1e-3});
        EXPECT_EQ(piece.at({0, 0, 0}).height, 0);
        EXPECT_NEAR(piece.at({0, 0, -1e-3}).height, -1e-3, 1e-15);  // so this is a crossing from the front
        EXPECT_EQ(piece.at({0, 0, 0}).height, 0);
        EXPECT_EQ(piece.at({0, 0, 1e-3}).height, 1e-3);
        EXPECT_EQ(piece.state.touched, 0);
    }
}

TEST(Piece, SeenFirstFromBehindAPieceIsNotTouched) {
    Touchable piece(square());
    for (const double z : {-1e-3, -2e-3, -1e-6}) EXPECT_EQ(piece.at({0, 0, z}).height, infinity);
    EXPECT_EQ(piece.at({0, 0, 1e-3}).height, 1e-3);             // it comes through ...
    EXPECT_NEAR(piece.at({0, 0, -1e-3}).height, -1e-3, 1e-15);  // ... and from then on it cannot go back
}

TEST(Piece, ThePathMustCrossThePieceNotItsPlaneBeside) {
    Touchable piece(square(Sides::both));
    piece.at({0.03, 0, 0.01});
    piece.at({0.03, 0, -0.01});
    EXPECT_GT(piece.at({0, 0, -0.01}).height, 0);  // reached around the edge: free behind it
    EXPECT_EQ(piece.state.touched, 0);
}

TEST(Piece, TheFootLeavesSidewaysAndThePieceLetsGo) {
    for (const double depth : {5e-4, 2e-3, 0.1}) {
        Touchable piece(square());
        piece.at({0.019, 0, 1e-3});
        EXPECT_NEAR(piece.at({0.019, 0, -depth}).height, -depth, 1e-15);
        EXPECT_NEAR(piece.at({0.01999999, 0, -depth}).height, -depth, 1e-15);
        EXPECT_GT(piece.at({0.02000001, 0, -depth}).height, 0);
        EXPECT_EQ(piece.at({0.019, 0, -depth}).height, infinity);  // back under it, but behind
    }
}

// --- moving
// -----------------------------------------------------------------------------------------------------------

TEST(Piece, OneThatMovesTakesAHandThatRestsAlong) {
    Polygon raw = square();
    raw.velocity = {0, 0, 0.5};
    Touchable piece(raw);
    const Vector p(0.001, 0.002, 0.01);
    for (int i = 0; i < 100; ++i) {
        const Contact felt = piece.at(p);
        EXPECT_NEAR(felt.height, 0.01 - 0.5e-3 * i,
                    1e-15);  // in its first cycle it is where it was said to be
        EXPECT_EQ(felt.velocity, Vector(0, 0, 0.5));
    }
    EXPECT_EQ(piece.state.touched, 1);
}

TEST(Piece, AnUpdateThatCarriesOneThroughTheHandTakesItAlong) {
    for (const bool turned : {false, true}) {
        Polygon raw = square(turned ? Sides::both : Sides::front), beyond = raw, aside = raw;
        for (std::uint32_t i = 0; i < 4; ++i) {
            beyond.vertices.at[i].z += 0.02;
            aside.vertices.at[i].x += 0.1;
            aside.vertices.at[i].z += 0.02;
        }
        if (turned)
            std::swap(beyond.vertices.at[0], beyond.vertices.at[2]);  // the corners sent the other way round
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

TEST(Piece, AnUpdateOfWhatItFeelsLikeLetsNothingGo) {
    Polygon raw = square();
    raw.velocity = {0, 0, 0.1};
    Touchable piece(raw);
    piece.at({0, 0, 0.001});
    const double height = piece.at({0, 0, -0.002}).height;
    raw.stiffness = 10;
    piece.change(raw);
    EXPECT_NEAR(piece.at({0, 0, -0.002}).height, height - 1e-4,
                1e-15);  // not placed anew either: it moves on
}

TYPED_TEST(Pieces, WithNoTimePassedTheAnswerIsThatOfTheCycleAndNothingAdvances) {
    for (int round = 0; round < 3'000; ++round) {
        TypeParam raw = random_piece<TypeParam>(this->rng, 0.02, 0.1);
        raw.sides = between(this->rng, 0, 1) ? Sides::both : Sides::front;
        raw.velocity = to_plain(direction(this->rng));
        const Exact exactly(raw);
        Touchable piece(raw);
        const double radius = between(this->rng, 0, 1) ? 0.003 : 0;
        for (int i = 0; i < 20; ++i) {
            const Vector p = exactly.over(this->rng, 0.02, uniform(this->rng, -0.01, 0.01));
            const auto before = piece.state;
            if (between(this->rng, 0, 1)) piece.at(p, radius, 0);
            ASSERT_EQ(std::memcmp(&before, &piece.state, sizeof before), 0);
            const Contact first = piece.at(p, radius);
            const auto after = piece.state;
            const Contact again = piece.at(p, radius, 0);
            ASSERT_EQ(std::memcmp(&after, &piece.state, sizeof after), 0);
            ASSERT_EQ(first.height, again.height) << "seed " << this->seed << " round " << round;
            ASSERT_EQ(first.normal, again.normal);
        }
    }
}

TEST(Piece, ACrossingSeenWithNoTimePassedIsFeltButNotRecorded) {
    Touchable piece(square());
    piece.at({0, 0, 1e-3});
    EXPECT_NEAR(piece.at({0, 0, -1e-3}, 0, 0).height, -1e-3, 1e-15);
    EXPECT_EQ(piece.state.touched, 0);
    EXPECT_NEAR(piece.at({0.03, 0, 1e-3}, 0, 0).height, std::hypot(0.01, 1e-3), 1e-15);
}

// --- a probe with a radius
// ----------------------------------------------------------------------------------------------

TEST(Piece, ABallThatSlidesOnAndAroundAPlateFeelsNoJump) {
    constexpr double radius = 4e-3, path = 1e-5;
    Rng rng(7);
    for (int round = 0; round < 200; ++round) {
        Polygon raw = random_polygon(rng, 0.02, 0.1);
        raw.sides = Sides::both;
        const Exact exactly(raw);
        Touchable piece(raw);
        Vector p = exactly.over(rng, 0.01, 0.01), goal = p;
        Vector last = force_of(piece.at(p, radius));
        for (int i = 0; i < 3'000; ++i) {
            if ((goal - p).norm() < path) goal = exactly.over(rng, 0.02, uniform(rng, -1, 1) * 0.006);
            const int before = piece.state.touched;
            const Vector to = p + path * (goal - p).normalized();
            // Not where an edge is nearer to the centre than half a radius, or beyond: there the plate slips
            // past.
            const Vec x = exactly.nearest(exact(to));
            if (exactly.inside(exact(to)) < path && (exact(to) - x).norm() < radius / 2) {
                goal = exactly.over(rng, 0.005, 0.01 * (exactly.height(exact(p)) > 0 ? 1 : -1));
                if (exactly.inside(exact(p)) < 2 * path) break;
                continue;
            }
            const bool leaves = before != 0 && exactly.inside(exact(to)) < path;
            if (leaves) break;
            p = to;
            const Vector force = force_of(piece.at(p, radius));
            ASSERT_LE((force - last).norm(), 1000 * path * (1 + 1e-6) + 1e-12)
                << "round " << round << " cycle " << i;
            last = force;
        }
    }
}

TEST(Piece, ABallIsFeltFromTheOutsideThroughTheCentresCrossingWithoutAStep) {
    for (const Sides sides : {Sides::front, Sides::both}) {
        Touchable piece(square(sides));
        for (double z = 0.01; z > -0.01; z -= 1e-4) {
            EXPECT_NEAR(piece.at({0.004, 0.002, z}, 0.003).height, z - 0.003, 1e-15);
        }
    }
}

TEST(Piece, EdgesAreRoundFromAllDirectionsAlsoOfAOneSidedPiece) {
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

TEST(Piece, ABallThatSlipsOffAnEdgeFeelsNothingUntilItIsClearOrCrossesAnew) {
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

TEST(Piece, ABallFromBehindAOneSidedPieceIsLetThroughUntilAllOfItHasPassed) {
    const double r = 0.003;
    Touchable piece(square());
    for (double z = -0.01; z < 0.0029; z += 1e-4) EXPECT_EQ(piece.at({0, 0, z}, r).height, infinity) << z;
    EXPECT_EQ(piece.at({0, 0, -0.001}, r).height, infinity);  // also back again
    for (const double z : {0.001, 0.0031}) piece.at({0, 0, z}, r);
    EXPECT_NEAR(piece.at({0, 0, 0.002}, r).height, -0.001, 1e-15);
    EXPECT_NEAR(piece.at({0, 0, -0.002}, r).height, -0.005, 1e-15);
}

TEST(Piece, NoPathThroughThemGivesBackMoreThanItTook) {
    Rng rng(11);
    for (int round = 0; round < 60; ++round) {
        Polygon raw = random_polygon(rng, 0.01, 0.05);
        raw.sides = round % 2 ? Sides::both : Sides::front;
        const double radius = round % 3 ? 0 : 0.002;
        const Exact exactly(raw);
        Touchable piece(raw);
        const Vector start = exactly.over(rng, 0.002, 0.01);
        Vector p = start;
        piece.at(p, radius);
        double sum = 0, path = 0;
        for (int i = 0; i < 12; ++i) {
            const Vector to = i < 11 ? exactly.over(rng, 0.012, uniform(rng, -0.004, 0.008)) : start;
            path += (to - p).norm();
            sum += work(piece, p, to, radius);
        }
        ASSERT_GE(sum, -1000 * 2e-6 * path)
            << "round " << round;  // the sum of steps of 2 um is off by k step path / 2
    }
}

// --- what is refused
// ----------------------------------------------------------------------------------------------------

namespace {

void expect_refused(const Polygon& polygon, std::string_view reason, double value) {
    const Verdict verdict = Describe<Polygon>::check(polygon);
    ASSERT_EQ(verdict.code, Verdict::Code::contradiction) << reason;
    EXPECT_EQ(Describe<Polygon>::fields[verdict.field].name, "vertices");
    EXPECT_NE(Describe<Polygon>::contradictions[verdict.reason].find(reason), std::string_view::npos)
        << Describe<Polygon>::contradictions[verdict.reason];
    EXPECT_NEAR(verdict.value, value, 1e-9) << reason;
}

}  // namespace

TEST(Polygon, AContradictionIsRefusedByHowMuch) {
    Polygon bent = square();
    bent.vertices.at[2].z = 0.004;
    const Verdict verdict = Describe<Polygon>::check(bent);
    EXPECT_NEAR(verdict.value, 0.001, 2e-5);  // a quarter of it off the mean plane, as is each other corner
    EXPECT_NE(Describe<Polygon>::contradictions[verdict.reason].find("not planar"), std::string_view::npos);

    Polygon hollow = square();
    hollow.vertices.at[2] = {-0.01, -0.01, 0};
    expect_refused(hollow, "not convex", 0.01 * std::sqrt(2.0) * 0 + Describe<Polygon>::check(hollow).value);
    EXPECT_GT(Describe<Polygon>::check(hollow).value, 0.01);

    Polygon twice = square();
    twice.vertices.at[3] = {0.02, 0.02 - 1e-9, 0};
    expect_refused(twice, "repeated", 1e-9);

    Polygon line = square();
    line.vertices = {.at = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, .count = 3};
    expect_refused(line, "no area", 0);

    Polygon star;  // winds around twice: each corner is left of some edge
    star.vertices.count = 5;
    for (int i = 0; i < 5; ++i) star.vertices.at[i] = {std::cos(0.8 * M_PI * i), std::sin(0.8 * M_PI * i), 0};
    EXPECT_NE(Describe<Polygon>::contradictions[Describe<Polygon>::check(star).reason].find("not convex"),
              std::string_view::npos);
}

TEST(Polygon, CornersInSinglePrecisionAreGoodEnoughAndBecomePlanar) {
    Rng rng(3);
    for (int round = 0; round < 2'000; ++round) {
        const double size = scale(rng, 1e-6, 10);
        Polygon polygon = random_polygon(rng, size, size);
        for (std::uint32_t i = 0; i < polygon.vertices.count; ++i) {
            Vec3& v = polygon.vertices.at[i];
            v = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
        }
        ASSERT_TRUE(Describe<Polygon>::check(polygon)) << round;
        const Exact flat(prepared(polygon, {}));
        for (const Vec& corner : flat.corners) ASSERT_LE(std::abs(flat.height(corner)), 1e-14 * size);
    }
}

TEST(Polygon, ATinyOneFarAwayIsLegalAsLongAsItsCornersCanBeToldApart) {
    Rng rng(4);
    EXPECT_TRUE(Describe<Polygon>::check(random_polygon(rng, 1e-12, 0)));
    for (int round = 0; round < 1'000; ++round)
        EXPECT_TRUE(Describe<Polygon>::check(random_polygon(rng, 1e-3, 1e6))) << round;
    EXPECT_FALSE(Describe<Polygon>::check(random_polygon(rng, 1e-10, 1e6)));
}

TEST(HalfPlane, AnEdgeAlongTheNormalIsRefused) {
    HalfPlane half{.normal = {0, 0, 2}, .edge = {0, 1e-7, 1}};
    const Verdict verdict = Describe<HalfPlane>::check(half);
    EXPECT_EQ(verdict.code, Verdict::Code::contradiction);
    EXPECT_EQ(Describe<HalfPlane>::fields[verdict.field].name, "edge");
    EXPECT_NEAR(verdict.value, 1e-7, 1e-12);
    half.edge.y = 1e-5;
    EXPECT_TRUE(Describe<HalfPlane>::check(half));
}

// --- skipping
// -----------------------------------------------------------------------------------------------------------

TEST(Polygon, IsOutOfReachOutsideOfItsBallUnlessItHoldsTheProbe) {
    Rng rng(5);
    for (int round = 0; round < 2'000; ++round) {
        Polygon raw = random_polygon(rng, 0.02, 0.1);
        raw.sides = between(rng, 0, 1) ? Sides::both : Sides::front;
        raw.velocity = to_plain(direction(rng));
        Touchable piece(raw);
        for (int i = 0; i < 10; ++i) {
            const auto ball = bound(piece.params, piece.state);
            ASSERT_EQ(ball.has_value(), piece.state.touched == 0);
            if (!ball) continue;
            const double radius = uniform(rng, 0, 0.01);
            auto state = piece.state;  // as it is asked once more in this cycle
            const Vector out = ball->center + (ball->radius * (1 + 1e-9) + radius) * direction(rng);
            state.met = 0;
            ASSERT_GT(contact(piece.params, state, probe_at(out, radius), 0).height, 0);
            piece.at(ball->center + 0.02 * direction(rng), radius);
        }
    }
}

TEST(Polygon, WhatItSawBeforeItWasOutOfReachIsForgotten) {
    Touchable piece(square(Sides::both));
    piece.at({0, 0, 0.01});
    out_of_reach(piece.params, piece.state);
    EXPECT_GT(piece.at({0, 0, -0.01}).height, 0);  // came around, unseen
    EXPECT_EQ(piece.state.touched, 0);
}

TYPED_TEST(Pieces, StayFiniteForAnythingThatIsLegal) {
    for (int round = 0; round < 100'000; ++round) {
        const double size = scale(this->rng, 1e-20, 1e8);
        TypeParam raw = random_piece<TypeParam>(this->rng, size, scale(this->rng, 1e-9, 4e8));
        raw.velocity = to_plain(scale(this->rng, 1e-9, 1e3) * direction(this->rng));
        raw.sides = between(this->rng, 0, 1) ? Sides::both : Sides::front;
        if (!Describe<TypeParam>::check(raw)) continue;
        Touchable piece(raw);
        for (int i = 0; i < 6; ++i) {
            const double radius = between(this->rng, 0, 1) ? scale(this->rng, 1e-12, 1e3) : 0;
            const Contact felt = piece.at(scale(this->rng, 1e-20, 1e12) * direction(this->rng), radius,
                                          std::array{0.0, 1e-6, 0.05}[static_cast<std::size_t>(i % 3)]);
            ASSERT_TRUE(felt.height == infinity || std::isfinite(felt.height)) << "round " << round;
            ASSERT_NEAR(felt.normal.norm(), 1, 1e-12) << "seed " << this->seed << " round " << round;
        }
    }
}
