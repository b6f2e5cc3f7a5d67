// The advantage of a cap over a plane where the model states its curvature, or can be queried; and where
// neither is enough.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "models.hpp"

namespace {

using namespace knurl;
using namespace closed_loop;
using namespace models;

// The stroke of the goals: a sine of 5 mm and 80 mm, sharpest radius 32 mm, to and fro over 160 mm at up to
// 0.1 m/s, pressed with 1.5 N + 60 N/m; for 8 s, the first second not counted.
const SurfaceModel gentle = relief(0.005, 0.08);
const SurfaceModel harsh = relief(0.003, 0.04);

Outcome to_and_fro(const Run& how, const SurfaceModel& model, double speed, int seed) {
    constexpr double reach = 0.08;  // m
    Run goals = how;
    goals.hand = stroking;
    goals.seconds = 8;
    goals.judged_from = 1;
    goals.phase = 0.017 * seed;
    return run(goals, model,
               [=](double t) { return Vector3d(0.027 * seed + reach * std::sin(speed / reach * t), 0, 0); });
}

double worst_error(const Run& how, const SurfaceModel& model, double speed) {
    double worst = 0;
    for (const int seed : {0, 1, 2}) worst = std::max(worst, to_and_fro(how, model, speed, seed).rms_error);
    return worst;
}

TEST(Caps, bring_the_force_error_of_a_gentle_stroke_under_15_mN_and_planes_under_50_mN) {
    const double none = worst_error({.way = Way::none}, gentle, 0.1);
    const double plane = worst_error({}, gentle, 0.1);
    const double cap = worst_error({.rim = 0.15}, gentle, 0.1);
    RecordProperty("none_mN", std::to_string(1e3 * none));
    RecordProperty("plane_mN", std::to_string(1e3 * plane));
    RecordProperty("cap_mN", std::to_string(1e3 * cap));
    EXPECT_LE(plane, 0.050);
    EXPECT_LE(cap, 0.015);
    EXPECT_GT(none, 0.2) << "this stroke would be easy for anything";
}

TEST(Caps, are_no_worse_than_planes_on_any_stroke) {
    for (const auto* model : {&gentle, &harsh}) {
        for (const double speed : {0.05, 0.1, 0.15}) {
            const double plane = worst_error({.stiffness = 2000}, *model, speed);
            const double cap = worst_error({.rim = 0.15, .stiffness = 2000}, *model, speed);
            EXPECT_LT(cap, plane) << (model == &harsh ? "harsh" : "gentle") << " at " << speed << " m/s";
        }
    }
}

TEST(Caps, whose_curvature_is_asked_of_the_normals_are_as_good_as_those_that_know_it) {
    for (const auto* model : {&gentle, &harsh}) {
        const double known = worst_error({.rim = 0.15}, *model, 0.1);
        const double asked = worst_error({.rim = 0.15}, curved(without_curvature(*model)), 0.1);
        EXPECT_NEAR(asked, known, 0.05 * known) << "N";
    }
}

TEST(Caps, from_a_model_without_curvature_are_planes) {
    const SurfaceModel flat = without_curvature(harsh);
    const Outcome cap = to_and_fro({.rim = 0.15}, flat, 0.1, 0), plane = to_and_fro({}, flat, 0.1, 0);
    EXPECT_NEAR(cap.rms_error, plane.rms_error, 1e-9);
}

TEST(Caps, are_checked_where_the_hand_lands_by_their_own_height) {
    // A hump whose stated curvature is too large: its plane at p* leaves the landing free, its cap does not.
    const auto hump = [](double curvature) -> SurfaceModel {
        return [=](const Vec3& q) -> SurfacePoint {
            return {.foot = {q.x, q.y, 0}, .normal = {0, 0, 1}, .curvature = q.x > 0.009 ? curvature : 0};
        };
    };
    const auto share = [&](double curvature, double rim) {
        FollowMemory memory;
        return follow_surface(hump(curvature), {.position = {0, 0, 0}, .velocity = {0.2, 0, 0}}, lateness,
                              {.stiffness = 1000, .rim = rim}, memory)
            .look_ahead;
    };
    EXPECT_EQ(share(200, 0), 1) << "a plane at p*";
    EXPECT_EQ(share(-200, 0.15), 1) << "a hump leaves the hand free";
    EXPECT_EQ(share(200, 0.15), 0.5) << "a hollow of 5 mm would throw it up";
}

TEST(Undersampling, is_reported_where_the_hand_passes_more_than_half_a_radius_between_two_updates) {
    // |v| interval against R/2 at the top of a hump.
    for (const double radius : {0.01, 0.03, 0.1}) {
        const SurfaceModel hump = [=](const Vec3& q) -> SurfacePoint {
            const Vector3d out = to_eigen(q) + Vector3d(0, 0, radius);
            return {.foot = to_plain(Vector3d(radius * out.normalized() - Vector3d(0, 0, radius))),
                    .normal = to_plain(out),
                    .curvature = -1 / radius};
        };
        for (const bool told : {false, true}) {
            for (const double times : {0.5, 0.9, 1.1, 2.0}) {
                const double speed = times * radius / 2 / lateness.interval;
                FollowMemory memory;
                const bool undersampled =
                    follow_surface(told ? hump : without_curvature(hump), {.velocity = {speed, 0, 0}},
                                   lateness, {.stiffness = 1000}, memory)
                        .undersampled;
                EXPECT_EQ(undersampled, times > 1)
                    << radius << " m, " << times << (told ? " told" : " not told");
            }
        }
    }
}

TEST(Undersampling, is_not_a_corner_whose_sides_are_all_sent_nor_the_back_of_a_plate) {
    FollowMemory memory;
    const Walls walls = floor_and_wall(std::numbers::pi / 2);
    const Followed corner = follow_surface(room(walls, Behind::deepest),
                                           {.position = {-0.004, 0, -0.001}, .velocity = {0.1, 0, 0}},
                                           lateness, {.stiffness = 1000}, memory);
    EXPECT_EQ(corner.faces.count, 2u);
    EXPECT_FALSE(corner.undersampled);
    memory = {};
    EXPECT_FALSE(follow_surface(plate(0.01), {.position = {0, 0, -0.003}, .velocity = {0.1, 0, -0.2}},
                                lateness, {.stiffness = 1000}, memory)
                     .undersampled);
}

TEST(Undersampling, is_said_of_the_harsh_stroke_and_not_of_the_gentle_one) {
    EXPECT_EQ(to_and_fro({}, gentle, 0.1, 0).undersampled, 0);
    EXPECT_GT(to_and_fro({}, harsh, 0.15, 0).undersampled, 0.1);
}

}  // namespace
