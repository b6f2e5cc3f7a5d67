// Prediction in worlds of any scale: the hand gets the same. For powers of two to the last bit, else within
// the effect of rounding on the hand's path.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "models.hpp"

namespace scales_of_worlds_tests {
namespace {

using namespace knurl;
using namespace closed_loop;
using namespace models;

struct Case {
    const char* name;
    Run how;
    SurfaceModel model;
    Path path;
    Truth truth;
};

std::vector<Case> cases() {
    const Walls corner = floor_and_wall(std::numbers::pi / 2);
    const auto in_the_corner = [=](const Vector3d& p) -> Vector3d {
        return 1000 * (nearest_free(corner, p) - p);
    };
    const Path over = [](double t) { return Vector3d(-0.1 + 0.15 * t, 0, -0.010); };
    const Path into = [](double t) { return Vector3d(std::min(-0.05 + 0.1 * t, 0.012), 0, -0.004); };
    const Path turns = [](double t) {
        return Vector3d(0.015 * std::sin(2 * std::numbers::pi * 3 * t), 0, -0.006);
    };
    const Path fast = [](double t) { return Vector3d(-0.1 + 0.4 * t, 0, -0.010); };  // farther than 20 mm
    return {
        {"planes over a relief", {.seconds = 1.5}, relief(0.004, 0.08), over, {}},
        {"caps over a relief", {.rim = 0.15, .seconds = 1.5}, relief(0.004, 0.08), over, {}},
        {"a model without curvatures", {.seconds = 1.5}, without_curvature(relief(0.002, 0.02)), over, {}},
        {"a hand that turns round", {.seconds = 2}, relief(0.003, 0.06), turns, {}},
        {"a fast hand", {.seconds = 0.5}, relief(0.004, 0.08), fast, {}},
        {"unchecked", {.way = Way::unchecked, .seconds = 0.5}, relief(0.004, 0.08), fast, {}},
        {"into a corner", {.seconds = 1.2}, room(corner, Behind::deepest), into, in_the_corner},
        {"over an edge", {.seconds = 1}, table, over, {}},
    };
}

Outcome in_world(const Case& one, double metre, double newton) {
    Run how = one.how;
    how.metre = metre;
    how.newton = newton;
    return run(how, one.model, one.path, one.truth);
}

}  // namespace

TEST(Scales, PredictionErrsByAsMuchInAWorldOfAnySize) {
    for (const Case& one : cases()) {
        SCOPED_TRACE(one.name);
        const Outcome want = in_world(one, 1, 1);
        for (const double metre : {0.01, 0.1, 10.0, 100.0, 1000.0}) {
            SCOPED_TRACE(metre);
            const Outcome got = in_world(one, metre, 1);
            EXPECT_NEAR(got.rms_error, want.rms_error, 0.05 * want.rms_error + 1e-9);
            EXPECT_NEAR(got.deepest, want.deepest, 0.05 * want.deepest);
            EXPECT_NEAR(got.largest_step, want.largest_step, 0.05 * want.largest_step);
        }
    }
}

TEST(Scales, PredictionIsTheSameToTheLastBitWhereTheSizeIsAPowerOfTwo) {
    for (const Case& one : cases()) {
        SCOPED_TRACE(one.name);
        const Outcome want = in_world(one, 1, 1);
        for (const auto& [metre, newton] : {std::pair{0x1p-7, 1.0}, {0x1p-2, 4.0}, {0x1p10, 1.0}}) {
            SCOPED_TRACE(metre);
            const Outcome got = in_world(one, metre, newton);
            EXPECT_EQ(got.rms_error, want.rms_error);
            EXPECT_EQ(got.end, want.end);
            EXPECT_EQ(got.largest_step, want.largest_step);
            EXPECT_EQ(got.full_share, want.full_share);
            EXPECT_EQ(got.cornered, want.cornered);
            EXPECT_EQ(got.undersampled, want.undersampled);
            EXPECT_EQ(got.asked, want.asked);
        }
    }
}

}  // namespace scales_of_worlds_tests
