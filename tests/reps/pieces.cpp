// polygon and half_plane: finite flat pieces that know the side of entry. tests/reference/pieces.cpp compares them
// with the reference on random paths.

#include <gtest/gtest.h>

#include "random_pieces.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

template <class R>
struct Pieces : testing::Test {
    static constexpr std::uint64_t seed = 20261;
    Rng rng{seed};
};
TYPED_TEST_SUITE(Pieces, PieceKinds);

}  // namespace

TYPED_TEST(Pieces, NothingTunnelsAtAnySpeedNorPopsOutHoweverDeep) {
    for (int round = 0; round < 20'000; ++round) {
        const double size = scale(this->rng, 1e-3, 1);
        TypeParam raw = random_piece<TypeParam>(this->rng, size, 0.1);
        raw.sides = between(this->rng, 0, 1) ? Sides::both : Sides::front;
        exact::Piece exactly = exact::piece_of(raw);
        // Over the middle of the piece, so the foot stays inside.
        const double third = 0.05 * size / 3;
        if (exactly.corners.empty()) exactly.point += -2 * third * exactly.edge;
        const int from = raw.sides == Sides::both && between(this->rng, 0, 1) ? -1 : 1;
        Touchable piece(raw);
        const auto place = [&](double height) { return over(exactly, this->rng, third, from * height); };
        piece.at(place(scale(this->rng, 1e-9, 100)));
        for (int i = 0; i < 10; ++i) {
            // From any distance, to where it is still within the piece's ball; then to anywhere.
            const auto reach = static_cast<double>(std::min<exact::Real>(0.9L * exactly.ball, 100));
            const double depth = scale(this->rng, 1e-9, i == 0 ? reach : 100);
            const Contact felt = piece.at(place(-depth));
            ASSERT_NEAR(felt.height, -depth, 1e-12 * 101) << "seed " << this->seed << " round " << round;
            ASSERT_LE((felt.normal - from * exact::rounded(exactly.normal)).norm(), 1e-9);
        }
        const Contact back = piece.at(place(1e-3));
        ASSERT_NEAR(back.height, 1e-3, 1e-12);
        ASSERT_EQ(piece.state.touched, 0);
    }
}

TEST(Piece, AHandThatComesToLieExactlyInTheFaceIsStillOnItsSide) {
    for (const Sides sides : {Sides::front, Sides::both}) {
        for (const int from : {1, -1}) {
            if (from < 0 && sides == Sides::front) continue;
            Touchable piece(square(sides));
            piece.at({0, 0, from * 1e-3});
            EXPECT_EQ(piece.at({0, 0, 0}).height, 0);
            const Contact felt = piece.at({0, 0, from * -1e-3});  // so this is a crossing
            EXPECT_NEAR(felt.height, -1e-3, 1e-15);
            EXPECT_NEAR(felt.normal.z(), from, 1e-15);
            EXPECT_EQ(piece.at({0, 0, 0}).height, 0);
            EXPECT_EQ(piece.at({0, 0, from * 1e-3}).height, 1e-3);
            EXPECT_EQ(piece.state.touched, 0);
        }
    }
}

TEST(Piece, SeenFirstFromBehindAPieceIsNotTouched) {
    Touchable piece(square());
    for (const double z : {-1e-3, -2e-3, -1e-6}) EXPECT_EQ(piece.at({0, 0, z}).height, infinity);
    EXPECT_EQ(piece.at({0, 0, 1e-3}).height, 1e-3);             // it comes through ...
    EXPECT_NEAR(piece.at({0, 0, -1e-3}).height, -1e-3, 1e-15);  // ... and from then on it cannot go back
}

TEST(Piece, AStepThatEndsFartherAwayThanThePieceIsLargeHasLedPastIt) {
    const double ball = 0.02 * std::sqrt(2.0);  // around the square
    for (const double depth : {0.9 * ball, 1.1 * ball}) {
        Touchable piece(square(Sides::both));
        piece.at({0, 0, 5});  // however far away the step began
        EXPECT_NEAR(piece.at({0, 0, -depth}).height, depth < ball ? -depth : depth, 1e-15);
        EXPECT_EQ(piece.state.touched, depth < ball ? 1 : 0);
    }
}

TEST(Piece, ThePathMustCrossThePieceNotItsPlaneBeside) {
    Touchable piece(square(Sides::both));
    piece.at({0.03, 0, 0.01});
    piece.at({0.03, 0, -0.01});
    EXPECT_GT(piece.at({0, 0, -0.01}).height, 0);  // entered around the edge: free behind it
    EXPECT_EQ(piece.state.touched, 0);
}

TEST(Piece, TheFootLeavesSidewaysAndThePieceLetsGo) {
    for (const double depth : {5e-4, 2e-3, 0.1}) {
        Touchable piece(square());
        piece.at({0.019, 0, 1e-3});
        EXPECT_NEAR(piece.at({0.019, 0, -1e-4}).height, -1e-4, 1e-15);
        EXPECT_NEAR(piece.at({0.019, 0, -depth}).height, -depth, 1e-15);
        EXPECT_NEAR(piece.at({0.01999999, 0, -depth}).height, -depth, 1e-15);
        EXPECT_GT(piece.at({0.02000001, 0, -depth}).height, 0);
        EXPECT_EQ(piece.at({0.019, 0, -depth}).height, infinity);  // back under it, but behind
    }
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
