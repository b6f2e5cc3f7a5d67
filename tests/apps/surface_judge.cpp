// The definition of "stable", with constructed strokes; and the path on which the hand is sent.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/protocol/report.hpp>

#include "surface/judge.hpp"
#include "surface/stroke.hpp"

namespace {

using surface::Cycle;
using surface::Ideal;
using surface::Judgement;
using surface::Terrain;

constexpr Ideal ideal{.stiffness = 1000, .greatest_force = 8};
constexpr surface::Span span{.rest_at = 2.0, .end = 3.0};

/// A stroke over a level surface at z = 0, 1 mm deep, with an exactly right force. Each test spoils one
/// property.
struct Made {
    std::vector<Cycle> cycles;
    std::vector<Terrain::Foot> feet;

    Made() {
        for (int i = 0; i <= 3000; ++i) {
            const double t = i * 1e-3;
            const double z = t < 0.5 ? 4e-3 - 10e-3 * t : -1e-3;  // comes down at 10 mm/s, touches at 0.4 s
            add(t, z);
        }
    }
    void add(double t, double z) {
        cycles.push_back({.number = 100 + cycles.size(),
                          .t = t,
                          .position = {0.05 * t, 0, z},
                          .velocity = {0.05, 0, 0},
                          .late_count = 7});
        feet.push_back({});
        place(cycles.size() - 1, z);
        cycles.back().force = surface::true_force(feet.back(), ideal);
    }
    void place(std::size_t i, double z) {
        cycles[i].position.z() = z;
        feet[i] = {.point = {cycles[i].position.x(), 0, 0}, .distance = z};
    }
    Judgement judged() const { return surface::judge(cycles, feet, ideal, span); }
};

TEST(Judge, AFaithfulStrokeIsStable) {
    const Judgement j = Made().judged();
    EXPECT_EQ(j.stable(), true);
    EXPECT_EQ(j.verdict(), "stable");
    EXPECT_EQ(j.cycles, 3001u);
    EXPECT_EQ(j.missed, 0u);
    EXPECT_EQ(j.late, 0u);
    EXPECT_NEAR(j.jump, 0.01, 1e-9);  // 10 mm/s into 1000 N/m
    EXPECT_EQ(j.force_error, 0);
    EXPECT_EQ(j.kick, 0);
    EXPECT_EQ(j.limit_cycle, 0);
    EXPECT_NEAR(j.contact_share, 1, 1e-12);
}

TEST(Judge, AForceStepAboveOneNewtonIsAJumpInWhateverDirection) {
    for (const Eigen::Vector3d& step :
         {Eigen::Vector3d(0, 0, 1.05), Eigen::Vector3d(0, 0, -1.05), Eigen::Vector3d(0.75, 0.75, 0)}) {
        Made made;
        for (std::size_t i = 1500; i < made.cycles.size(); ++i) made.cycles[i].force += step;
        const Judgement j = made.judged();
        EXPECT_NEAR(j.jump, step.norm(), 1e-9);
        EXPECT_NEAR(j.jump_at, 1.5, 1e-9);
        EXPECT_EQ(j.jumps, 1u);
        EXPECT_EQ(j.verdict(), "not stable: jump");
    }
    Made gentle;
    for (std::size_t i = 1500; i < gentle.cycles.size(); ++i) gentle.cycles[i].force.z() += 0.95;
    EXPECT_EQ(gentle.judged().stable(), true);
}

TEST(Judge, AStepAtTheFirstTouchCountsToo) {
    Made made;
    for (std::size_t i = 0; i < 401; ++i) made.cycles[i].force.setZero();
    for (std::size_t i = 401; i < made.cycles.size(); ++i) made.cycles[i].force = {0, 0, 2};
    EXPECT_NEAR(made.judged().jump, 2, 1e-9);
}

TEST(Judge, AStepAcrossMissedReportsIsNoJump) {
    Made made;
    for (std::size_t i = 1500; i < made.cycles.size(); ++i)
        made.cycles[i].force.z() += 3, made.cycles[i].number += 40;
    const Judgement j = made.judged();
    EXPECT_EQ(j.missed, 40u);
    EXPECT_LT(j.jump, 0.1);
}

TEST(Judge, OverALateCycleTheStepIsSharedAmongThePeriodsThatItTook) {
    Made made;
    for (std::size_t i = 1500; i < made.cycles.size(); ++i) made.cycles[i].force.x() += 3;
    made.cycles[1500].gap = 6e-3;
    EXPECT_NEAR(made.judged().jump, 0.5, 1e-6);
    made.cycles[1500].gap = 1.2e-3;  // jitter is not late
    EXPECT_NEAR(made.judged().jump, 3, 1e-6);
}

TEST(Judge, AStallOfTheServoIsCounted) {
    Made made;
    for (std::size_t i = 1200; i < 1700; ++i) made.cycles[i].active = false;
    EXPECT_EQ(made.judged().stalls, 1u);
}

TEST(Judge, SpeedAwayFromTheSurfaceIsAKickSpeedAlongOrIntoItIsNot) {
    Made made;
    made.cycles[1000].velocity = {0, 0, 0.31};
    EXPECT_EQ(made.judged().verdict(), "not stable: kick");
    EXPECT_NEAR(made.judged().kick, 0.31, 1e-12);

    Made along;
    along.cycles[1000].velocity = {2, 0, -2};
    EXPECT_EQ(along.judged().stable(), true);

    Made before;  // before the first contact, any motion is permitted
    before.cycles[200].velocity = {0, 0, 0.9};
    EXPECT_EQ(before.judged().stable(), true);
}

TEST(Judge, ASwingAtRestIsALimitCycleOneDuringTheStrokeIsNot) {
    Made made;
    for (std::size_t i = 2400; i < made.cycles.size(); ++i)
        made.place(i, -1e-3 + 0.12e-3 * std::sin(2 * M_PI * 40 * made.cycles[i].t));
    EXPECT_NEAR(made.judged().limit_cycle.value(), 0.12e-3, 1e-6);
    EXPECT_EQ(made.judged().verdict(), "not stable: limit cycle");

    Made moving;
    for (std::size_t i = 600; i < 2000; ++i)
        moving.place(i, -1e-3 + 0.5e-3 * std::sin(2 * M_PI * 5 * moving.cycles[i].t));
    EXPECT_EQ(moving.judged().limit_cycle, 0);
}

TEST(Judge, AStrokeThatEndsEarlySaysNothingOfTheRest) {
    Made made;
    made.cycles.resize(1800);
    made.feet.resize(1800);
    EXPECT_FALSE(made.judged().limit_cycle);
    EXPECT_EQ(made.judged().verdict(), "no verdict: the hand was not seen at rest");
    made.cycles[1500].force.z() += 3;
    EXPECT_EQ(made.judged().verdict(), "not stable: jump") << "what was seen is enough for that";
}

TEST(Judge, NoContactIsNoVerdict) {
    Made above;
    for (std::size_t i = 0; i < above.cycles.size(); ++i)
        above.place(i, 2e-3), above.cycles[i].force.setZero();
    EXPECT_FALSE(above.judged().stable());
    EXPECT_THAT(above.judged().verdict(),
                testing::StartsWith("no verdict: the hand never touched the surface; "));

    Made brushed;
    for (std::size_t i = 450; i < brushed.cycles.size(); ++i)
        brushed.place(i, 2e-3), brushed.cycles[i].force.setZero(), brushed.cycles[449].force.setZero();
    EXPECT_THAT(brushed.judged().verdict(),
                testing::HasSubstr("no verdict: the hand touched the surface for"));
    brushed.cycles[2000].faults = knurl::fault::speed;
    EXPECT_EQ(brushed.judged().stable(), false) << "a fault is one wherever the hand was";
}

TEST(Judge, AHandThatRestsOnTheSurfaceHasNotStrokedIt) {
    Made made;
    for (std::size_t i = 0; i < made.cycles.size(); ++i) made.feet[i].point = {0.03, 0, 0};
    EXPECT_THAT(made.judged().verdict(),
                testing::StartsWith("no verdict: the hand went 0.0 mm along the surface only"));
}

TEST(Judge, WhereTooManyReportsWereMissedNothingIsStable) {
    Made made;
    for (std::size_t i = 1500; i < made.cycles.size(); ++i) made.cycles[i].number += 200;
    EXPECT_EQ(made.judged().verdict(),
              "no verdict: 200 of 3201 reports were missed: a jump between them is not seen");
}

TEST(Judge, ForceErrorIsTheRootMeanSquareAgainstTheTrueSurface) {
    Made made;
    std::size_t spoiled = 0;
    for (std::size_t i = 0; i < made.cycles.size(); ++i)
        if (made.cycles[i].t > 0.6 && i % 2 == 0)
            made.cycles[i].force += Eigen::Vector3d(0.3, 0.4, 0), ++spoiled;
    const std::size_t from_touch = 3001 - 401;
    EXPECT_NEAR(made.judged().force_error, 0.5 * std::sqrt(double(spoiled) / double(from_touch)), 1e-3);
}

TEST(Judge, AFaultEndsTheStrokeAndNamesItsReason) {
    Made made;
    for (std::size_t i = 1234; i < made.cycles.size(); ++i) {
        made.cycles[i].faults = knurl::fault::speed | knurl::fault::power;
        made.cycles[i].force.z() += 100;
    }
    const Judgement j = made.judged();
    EXPECT_EQ(j.cycles, 1234u);
    EXPECT_LT(j.jump, 0.1);
    EXPECT_EQ(j.stable(), false);
    EXPECT_EQ(j.verdict(), "faulted at t = 1.23 s (hand too fast, too much power into the hand)");
}

TEST(Judge, TheTrueForceIsBoundedAsTheDeviceIs) {
    EXPECT_EQ(surface::true_force({.distance = 1e-3}, ideal).norm(), 0);
    EXPECT_NEAR(surface::true_force({.distance = -2e-3}, ideal).z(), 2, 1e-12);
    EXPECT_NEAR(surface::true_force({.distance = -1}, ideal).z(), 8, 1e-12);
}

surface::Terrain waves(int rows = 344, int columns = 403) {
    surface::HeightGrid grid{.rows = rows, .columns = columns, .cell = 0.5e-3};
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c)
            grid.heights.push_back(3e-3 * std::sin(c * 0.05) * std::cos(r * 0.04));
    return Terrain(grid);
}

TEST(Stroke, BeginsAboveTheSurfaceGoesAtItsSpeedAndRestsPressing) {
    const Terrain terrain = waves();
    const surface::StrokeOptions options;
    const auto stroke = surface::make_stroke(terrain, options);
    EXPECT_GT(stroke.rows.front().position.z(),
              terrain.height(stroke.rows.front().position.x(), stroke.rows.front().position.y()) + 4e-3);
    EXPECT_GT(stroke.end, 7.5);
    EXPECT_LT(stroke.end, 11);
    double fastest = 0, farthest = 0;
    for (std::size_t i = 1; i < stroke.rows.size(); ++i) {
        const auto& a = stroke.rows[i - 1];
        const auto& b = stroke.rows[i];
        EXPECT_GT(b.t, a.t);
        fastest = std::max(fastest, (b.position - a.position).head<2>().norm() / (b.t - a.t));
        farthest = std::max(farthest, b.position.norm());
        if (b.t > stroke.begin && b.t < stroke.rest_at) {
            EXPECT_LT(b.position.z(), terrain.height(b.position.x(), b.position.y()) - 3e-3) << b.t;
        }
    }
    EXPECT_NEAR(fastest, options.speed, 0.002);
    EXPECT_LT(farthest, 0.095) << "within a workspace of 0.1 m";
    EXPECT_LT((stroke.rows.back().position - stroke.rows[stroke.rows.size() - 150].position).norm(), 1e-12)
        << "rests";
}

TEST(Stroke, FitsASmallRelief) {
    const auto stroke = surface::make_stroke(waves(40, 60), {});
    for (const auto& row : stroke.rows) EXPECT_LT(std::abs(row.position.x()), 0.03);
}

}  // namespace
