// Prediction must help where it can and never do harm. Three variants in the closed loop of closed_loop.hpp:
// the plane where the hand was, the unchecked plane where it will be, and the library's.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <knurl/client/error.hpp>

#include "models.hpp"

namespace {

using namespace knurl;
using namespace closed_loop;
using namespace models;

/// Down onto the plate at `speed`, and on until `depth` below its face; then held there.
Path tap(double speed, double depth, double phase) {
    return [=](double t) { return Vector3d(0, 0, std::max(0.04 + phase * speed - speed * t, -depth)); };
}

Outcome stroke(Way way, const SurfaceModel& model, const Path& path, double seconds) {
    return run({.way = way, .seconds = seconds}, model, path);
}

TEST(Prediction, never_pushes_a_hand_through_a_plate) {
    int unchecked_pushed_through = 0;
    for (const double thickness : {0.010, 0.015, 0.020, 0.030}) {
        for (const double speed : {0.1, 0.2, 0.3}) {
            for (double phase = 0; phase < update_cycles * dt; phase += 7 * dt) {
                const SurfaceModel model = plate(thickness);
                // The grip presses with 300 N/m x 4 mm at most when the hand is held at the face.
                const Path path = tap(speed, 0.004, phase);
                const Outcome safe = stroke(Way::safe, model, path, 1.0);
                EXPECT_GT(safe.lowest.z(), -thickness)
                    << thickness << " m at " << speed << " m/s, phase " << phase;
                EXPECT_GT(safe.end.z(), -thickness / 2)
                    << thickness << " m at " << speed << " m/s, " << phase;
                unchecked_pushed_through +=
                    stroke(Way::unchecked, model, path, 1.0).lowest.z() < -thickness ? 1 : 0;
            }
        }
    }
    EXPECT_GT(unchecked_pushed_through, 0) << "this test would not see an unsafe prediction";
}

TEST(Prediction, keeps_a_hand_on_its_side_of_a_plate_that_it_has_pressed_past_the_middle_of) {
    int lost_without = 0;
    for (const double thickness : {0.010, 0.014, 0.020}) {
        for (const double speed : {0.05, 0.1, 0.2, 0.3}) {
            for (double phase = 0; phase < update_cycles * dt; phase += 7 * dt) {
                const SurfaceModel model = plate(thickness);
                // 300 N/m of grip against 1000 N/m of plate: it comes to rest at 60 % of the thickness.
                const double rest = 0.6 * thickness;
                Hand calm{.damping = 12};
                const Path path = tap(speed, rest * 1300 / 300, phase);
                const double seconds = 0.8 + 0.1 / speed;
                const Outcome safe = run({.hand = calm, .seconds = seconds}, model, path);
                EXPECT_NEAR(safe.end.z(), -rest, 0.2e-3)
                    << thickness << " m at " << speed << " m/s, phase " << phase;
                const Outcome none = run({.way = Way::none, .hand = calm, .seconds = seconds}, model, path);
                lost_without += none.end.z() < -thickness ? 1 : 0;
            }
        }
    }
    EXPECT_GT(lost_without, 0) << "this test would not see a side that is lost";
}

TEST(Prediction, keeps_a_hand_outside_of_a_thin_shell_that_it_strokes_past_the_middle_of) {
    const double radius = 0.06, thickness = 0.008;
    const SurfaceModel model = shell(radius, thickness);
    for (const double rim : {0.0, 0.15}) {
        for (double phase = 0; phase < update_cycles * dt; phase += 7 * dt) {
            // 5 mm deep, 0.1 m/s along the outside, over more than a quarter of it.
            const Path path = [=](double t) {
                const double angle = std::clamp(0.1 * (t - 0.5) / radius, 0.0, 1.8) - 0.9;
                const double deep = 0.005 * 1300 / 300 * std::min(t / 0.4, 1.0);
                return Vector3d((radius - deep) * std::sin(angle), 0,
                                (radius - deep) * std::cos(angle) - radius);
            };
            const Outcome safe =
                run({.rim = rim, .hand = {.damping = 12}, .seconds = 2, .phase = phase}, model, path,
                    [&](const Vector3d& p) -> Vector3d {
                        const Vector3d from(p.x(), 0, p.z() + radius);
                        return 1000 * std::max(0.0, radius - from.norm()) * from.normalized();
                    });
            EXPECT_LT(safe.deepest, 0.95 * thickness) << "rim " << rim << ", phase " << phase;
            EXPECT_GT(safe.deepest, 0.55 * thickness) << "the hand never came past the middle";
        }
    }
}

TEST(Prediction, kicks_a_hand_that_leaves_a_table_over_its_edge_with_no_more_than_1_5_N) {
    double unchecked_kick = 0;
    for (const double speed : {0.1, 0.2, 0.3}) {
        for (double phase = 0; phase < update_cycles * dt; phase += 3 * dt) {
            const Path path = [=](double t) { return Vector3d(-0.1 + speed * (t + phase - 0.2), 0, -0.008); };
            const double seconds = 0.1 / speed + 0.4;
            const double none = stroke(Way::none, table, path, seconds).largest_side;
            const double safe = stroke(Way::safe, table, path, seconds).largest_side;
            EXPECT_LE(safe, std::max(1.5, none)) << speed << " m/s, phase " << phase;
            unchecked_kick =
                std::max(unchecked_kick, stroke(Way::unchecked, table, path, seconds).largest_side);
        }
    }
    EXPECT_GT(unchecked_kick, 1.5) << "this test would not see an unsafe prediction";
}

TEST(Prediction, is_no_worse_than_none_when_the_hand_reverses_at_3_Hz) {
    for (const double deep : {0.004, 0.008}) {
        for (const double wave : {0.04, 0.06, 0.08, 0.16}) {
            const SurfaceModel model = relief(0.003, wave);
            double none = 0, plane = 0, cap = 0;
            for (double phase = 0; phase < 1.0 / 3; phase += 0.037) {
                const Path path = [=](double t) {
                    return Vector3d(0.015 * std::sin(2 * std::numbers::pi * 3 * (t + phase)), 0, -deep);
                };
                const double without = stroke(Way::none, model, path, 3).rms_error;
                const double with = stroke(Way::safe, model, path, 3).rms_error;
                // The valley in which a hand ends is random, with prediction and without.
                EXPECT_LE(with, 1.15 * without) << "wave " << wave << " m, phase " << phase;
                none += without;
                plane += with;
                cap += run({.rim = 0.15, .seconds = 3}, model, path).rms_error;
            }
            EXPECT_LE(plane, none) << "wave " << wave << " m, " << deep << " m deep";
            EXPECT_LE(cap, plane) << "wave " << wave << " m, " << deep << " m deep";
        }
    }
}

TEST(Prediction, sends_the_plane_that_is_nearest_all_along_the_way_on_which_it_is_felt) {
    const double amplitude = 0.003, wave = 0.06, speed = 0.1;
    const SurfaceModel model = relief(amplitude, wave);
    const auto height = [=](double x) { return amplitude * std::sin(2 * std::numbers::pi / wave * x); };
    const auto mean_square = [&](double begin, double end, auto line) {
        constexpr int n = 200;
        double sum = 0;
        for (int i = 0; i < n; ++i) {
            const double x = begin + (i + 0.5) / n * (end - begin);
            sum += (line(x) - height(x)) * (line(x) - height(x)) / n;
        }
        return sum;
    };
    double sent = 0, best = 0, tangent = 0;
    for (double x = 0; x < wave; x += wave / 97) {
        FollowMemory memory;
        const Vec3 p{x, 0, height(x)};
        const Followed followed = follow_surface(model, {.position = p, .velocity = {speed, 0, 0}}, lateness,
                                                 {.stiffness = 1000}, memory);
        ASSERT_EQ(followed.look_ahead, 1);
        ASSERT_EQ(followed.faces.count, 1u);
        const auto line_of = [](const SurfacePoint& face) {
            return [face](double at) {
                return face.foot.z - face.normal.x / face.normal.z * (at - face.foot.x);
            };
        };
        const double middle = x + speed * (lateness.latency + lateness.interval / 2);
        const double begin = middle - 0.6 * speed * lateness.interval, end = 2 * middle - begin;
        // Least squares, by sums.
        constexpr int n = 200;
        double x1 = 0, x2 = 0, z1 = 0, xz = 0;
        for (int i = 0; i < n; ++i) {
            const double at = begin + (i + 0.5) / n * (end - begin), z = height(at);
            x1 += at / n, x2 += at * at / n, z1 += z / n, xz += at * z / n;
        }
        const double slope = (xz - x1 * z1) / (x2 - x1 * x1);
        sent += mean_square(begin, end, line_of(followed.faces.face[0]));
        best += mean_square(begin, end, [&](double at) { return z1 + slope * (at - x1); });
        tangent += mean_square(begin, end, line_of(model(look_ahead(p, {speed, 0, 0}, lateness))));
    }
    std::printf("rms: sent %.1f um, nearest %.1f um, tangent %.1f um\n", 1e6 * std::sqrt(sent / 97),
                1e6 * std::sqrt(best / 97), 1e6 * std::sqrt(tangent / 97));
    EXPECT_LT(std::sqrt(sent), 1.1 * std::sqrt(best));
    EXPECT_GT(std::sqrt(tangent), 1.5 * std::sqrt(best)) << "this test would not see a tangent plane";
}

TEST(Prediction, keeps_what_it_gains_on_a_smooth_stroke) {
    const SurfaceModel model = relief(0.004, 0.08);
    const Path path = [](double t) { return Vector3d(-0.1 + 0.15 * t, 0, -0.010); };
    const Outcome none = stroke(Way::none, model, path, 1.5);
    const Outcome free = stroke(Way::unchecked, model, path, 1.5);
    const Outcome safe = stroke(Way::safe, model, path, 1.5);
    EXPECT_LT(safe.rms_error, 0.5 * none.rms_error);
    EXPECT_LT(safe.rms_error, 1.1 * free.rms_error);
    EXPECT_GT(safe.full_share, 0.9);
}

TEST(Prediction, looks_nowhere_before_it_knows_how_late_the_application_is) {
    FollowMemory memory;
    const Followed followed =
        follow_surface(relief(0.004, 0.08), {.position = {0.01, 0, 0}, .velocity = {0.3, 0, 0}}, {},
                       {.stiffness = 1000}, memory);
    EXPECT_EQ(followed.look_ahead, 0);
    EXPECT_EQ(followed.asked, 1u);
}

TEST(Prediction, looks_at_most_20_mm_ahead) {
    const Vec3 far = look_ahead({0, 0, 0}, {3, 4, 0}, {.latency = 1, .interval = 1});
    EXPECT_NEAR(to_eigen(far).norm(), max_look_ahead, 1e-12);
    EXPECT_NEAR(far.x / far.y, 0.75, 1e-12);
}

TEST(Prediction, asks_below_the_surface_only_where_the_hand_is_already) {
    // A hand that dives: the normal part of its path ends at the surface.
    double lowest = 1;
    const SurfaceModel model = [&](const Vec3& q) -> SurfacePoint {
        if (q.x != 0) lowest = std::min(lowest, q.z);  // not at the hand, not at the landing
        return {.foot = {q.x, q.y, 0}, .normal = {0, 0, 1}};
    };
    FollowMemory memory;
    follow_surface(model, {.position = {0, 0, 0.002}, .velocity = {0.1, 0, -0.3}},
                   {.latency = 0, .interval = 0.05}, {.stiffness = 1000}, memory);
    EXPECT_NEAR(lowest, 0, 1e-15);
}

TEST(Prediction, keeps_the_face_by_which_the_hand_came_in) {
    FollowMemory memory;
    const SurfaceModel model = plate(0.010);
    const Followed outside =
        follow_surface(model, {.position = {0, 0, 0.001}}, lateness, {.stiffness = 1000}, memory);
    EXPECT_EQ(outside.faces.face[0].normal, (Vec3{0, 0, 1}));
    const Followed past_the_middle =
        follow_surface(model, {.position = {0, 0, -0.006}}, lateness, {.stiffness = 1000}, memory);
    EXPECT_TRUE(past_the_middle.kept_side);
    EXPECT_EQ(past_the_middle.faces.face[0].normal, (Vec3{0, 0, 1}));
    const Followed went_round =
        follow_surface(model, {.position = {0, 0, -0.011}}, lateness, {.stiffness = 1000}, memory);
    EXPECT_EQ(went_round.faces.face[0].normal, (Vec3{0, 0, -1})) << "outside again, by whichever way";
}

TEST(Prediction, refuses_a_model_that_answers_nonsense_and_says_what_it_answered) {
    FollowMemory memory;
    const auto answer = [&](SurfacePoint point) {
        try {
            follow_surface([=](const Vec3&) { return point; }, {.position = {1, 2, 3}}, {},
                           {.stiffness = 1000}, memory);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind, Error::Kind::bad_parameters);
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    EXPECT_NE(answer({.foot = {0, 0, 0}, .normal = {0, 0, 0}}).find("normal (0, 0, 0)"), std::string::npos);
    EXPECT_NE(answer({.foot = {NAN, 0, 0}, .normal = {0, 0, 1}}).find("(1, 2, 3)"), std::string::npos);
    EXPECT_NE(answer({.foot = {0, 0, 0}, .normal = {INFINITY, 0, 1}}).find("follow"), std::string::npos);
}

}  // namespace
