// What polygon and half_plane refuse and with which tolerance, where they are out of reach, and that they
// stay finite.

#include <gtest/gtest.h>

#include "random_pieces.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

template <class R>
struct PiecesAtTheirLimits : testing::Test {
    static constexpr std::uint64_t seed = 20261;
    Rng rng{seed};
};
TYPED_TEST_SUITE(PiecesAtTheirLimits, PieceKinds);

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
        const exact::Piece flat = exact::piece_of(prepared(polygon, {}));
        for (const exact::V& corner : flat.corners)
            ASSERT_LE(std::abs(exact::dot(corner - flat.point, flat.normal)), 1e-14 * size);
    }
}

TEST(Polygon, ATinyOneFarAwayIsLegalAsLongAsItsCornersCanBeToldApart) {
    Rng rng(4);
    EXPECT_TRUE(Describe<Polygon>::check(random_polygon(rng, 1e-12, 0)));
    for (int round = 0; round < 1'000; ++round)
        EXPECT_TRUE(Describe<Polygon>::check(random_polygon(rng, 5e-5, 1e6))) << round;
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
            auto state = piece.state;  // as in a repeated evaluation of this cycle
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
    EXPECT_GT(piece.at({0, 0, -0.01}).height, 0);  // came around the edge, unseen
    EXPECT_EQ(piece.state.touched, 0);
}

TYPED_TEST(PiecesAtTheirLimits, StayFiniteForAnythingThatIsLegal) {
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
