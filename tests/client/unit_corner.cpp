// In a concave corner one plane is not enough: the hand sinks into the side that was not sent. The library
// sends all faces that meet there, found from a model that answers with one point at a time.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "corner.hpp"
#include "models.hpp"

namespace {

using namespace knurl;
using namespace closed_loop;
using namespace models;

constexpr double degree = std::numbers::pi / 180;
constexpr Behind every_behind[] = {Behind::edge, Behind::deepest, Behind::shallowest};

/// Along the floor into the wall, at last 12 mm behind it; pressed 4 mm into the floor.
Path into_the_wall(double speed) {
    return [=](double t) { return Vector3d(std::min(-0.05 + speed * t, 0.012), 0, -0.004); };
}

Truth walls_push(const Walls& walls) {
    return [=](const Vector3d& p) -> Vector3d { return 1000 * (nearest_free(walls, p) - p); };
}

TEST(Corner, a_hand_that_slides_into_it_sinks_no_deeper_than_it_presses) {
    double without = 0;
    for (const double opening : {60.0, 90.0, 120.0, 150.0}) {
        const Walls walls = floor_and_wall(opening * degree);
        for (const Behind behind : every_behind) {
            for (const double speed : {0.05, 0.1, 0.2}) {
                for (double phase = 0; phase < update_cycles * dt; phase += 9 * dt) {
                    const auto slide = [&](Way way) {
                        return run(
                            {.way = way, .seconds = 0.06 / speed + 0.5, .judged_from = 0.1, .phase = phase},
                            room(walls, behind), into_the_wall(speed), walls_push(walls));
                    };
                    const Outcome safe = slide(Way::safe);
                    EXPECT_LT(safe.deepest, 0.004) << opening << " degrees at " << speed << " m/s, model "
                                                   << static_cast<int>(behind) << ", phase " << phase;
                    EXPECT_LT(safe.largest_step, 0.4) << "N a cycle";
                    without = std::max(without, slide(Way::none).deepest);
                }
            }
        }
    }
    EXPECT_GT(without, 0.012) << "this test would not see a hand that sinks into a corner";
}

TEST(Corner, of_a_room_has_three_sides) {
    const Walls walls{{{0, 0, 1}, 0}, {{-1, 0, 0}, 0}, {{0, -1, 0}, 0}};
    for (const Behind behind : every_behind) {
        for (double phase = 0; phase < update_cycles * dt; phase += 9 * dt) {
            const Path path = [](double t) {
                const double x = std::min(-0.03 + 0.07 * t, 0.010);
                return Vector3d(x, x, -0.004);
            };
            const auto push = [&](Way way) {
                return run({.way = way, .seconds = 1.2, .judged_from = 0.1, .phase = phase},
                           room(walls, behind), path, walls_push(walls));
            };
            EXPECT_LT(push(Way::safe).deepest, 0.005) << static_cast<int>(behind) << ", phase " << phase;
            EXPECT_GT(push(Way::none).deepest, 0.007);
        }
    }
}

TEST(Corner, holds_a_hand_that_rests_in_it) {
    const Walls walls = floor_and_wall(90 * degree);
    for (const Behind behind : every_behind) {
        // In, then 2 s of pressure into both sides, with changing strength.
        const Path path = [&](double t) {
            const double more = 0.004 * std::sin(2 * std::numbers::pi * 1.3 * t);
            return Vector3d(std::min(-0.03 + 0.1 * t, 0.006 + more), 0, -0.006 + more);
        };
        const Outcome safe =
            run({.seconds = 3, .judged_from = 0.8}, room(walls, behind), path, walls_push(walls));
        EXPECT_LT(safe.rms_error, 0.01) << "N, model " << static_cast<int>(behind);
    }
}

TEST(Corner, is_left_freely_and_its_sides_are_sent_no_more) {
    const Walls walls = floor_and_wall(90 * degree);
    FollowMemory memory;
    const auto at = [&](const Vec3& p, const Vec3& v) {
        return follow_surface(room(walls, Behind::deepest), {.position = p, .velocity = v}, lateness,
                              {.stiffness = 1000}, memory);
    };
    EXPECT_EQ(at({-0.03, 0, -0.001}, {}).faces.count, 1u);
    EXPECT_EQ(at({-0.004, 0, -0.001}, {0.1, 0, 0}).faces.count, 2u) << "it comes to the wall";
    EXPECT_EQ(at({0.001, 0, -0.002}, {}).faces.count, 2u) << "it rests in the corner";
    EXPECT_EQ(at({-0.01, 0, -0.001}, {-0.1, 0, 0}).faces.count, 2u) << "still near";
    EXPECT_EQ(at({-0.03, 0, -0.001}, {-0.1, 0, 0}).faces.count, 1u);
}

TEST(Corner, whose_sides_are_curved_has_them_where_they_meet) {
    // A ball of 0.1 m on a floor: a fold all around its foot, concave.
    const double radius = 0.1;
    const SurfaceModel model = [=](const Vec3& q) -> SurfacePoint {
        const Vector3d centre(0, 0, 0.6 * radius);
        const Vector3d out = to_eigen(q) - centre;
        if (out.norm() - radius < q.z)
            return {.foot = to_plain(centre + radius * out.normalized()),
                    .normal = to_plain(out.normalized()),
                    .curvature = -1 / radius};
        return {.foot = {q.x, q.y, 0}, .normal = {0, 0, 1}};
    };
    FollowMemory memory;
    for (const double rim : {0.0, 0.15}) {
        const Followed followed =
            follow_surface(model, {.position = {0.085, 0, -0.001}, .velocity = {-0.1, 0, 0}}, lateness,
                           {.stiffness = 1000, .rim = rim}, memory);
        ASSERT_EQ(followed.faces.count, 2u);
        for (const SurfacePoint& face : followed.faces.all()) {
            const bool floor = face.normal.z > 0.99;
            EXPECT_EQ(face.curvature, floor ? 0 : -1 / radius);
            EXPECT_NEAR(face.foot.x, 0.08, 0.01) << "where the ball meets the floor";
        }
    }
}

TEST(Corner, is_not_seen_where_there_is_none) {
    // An edge that folds away from the hand, a smooth valley, a plate, a step that ends below the hand.
    const auto faces = [](const SurfaceModel& model, const Vec3& p, const Vec3& v) {
        FollowMemory memory;
        follow_surface(model, {.position = {p.x - 0.05 * v.x, p.y, p.z}, .velocity = v}, lateness,
                       {.stiffness = 1000}, memory);
        return follow_surface(model, {.time = 0.05, .position = p, .velocity = v}, lateness,
                              {.stiffness = 1000}, memory)
            .faces.count;
    };
    for (double x = -0.02; x < 0.02; x += 0.0013) {
        EXPECT_EQ(faces(table, {x, 0, -0.002}, {0.2, 0, 0}), 1u) << x;
        EXPECT_EQ(faces(relief(0.003, 0.04), {x, 0, -0.004}, {0.15, 0, 0}), 1u) << x;
        EXPECT_EQ(faces(plate(0.010), {x, 0, -0.006}, {0.2, 0, 0}), 1u) << x;
    }
}

TEST(Corner, is_no_valley_that_turns_by_more_on_the_way_than_a_corner_and_its_plane_stays) {
    const SurfaceModel model = relief(0.003, 0.04);
    const auto at = [&](double x) { return detail::Face(model({x, 0, 0}), 0); };
    int sharp = 0;
    for (double from = -0.02; from < 0; from += 0.0007) {
        for (double way = 0.004; way < 0.018; way += 0.0011) {
            const std::vector<detail::Face> on_the_way = {at(from), at(from + way / 2), at(from + way)};
            std::vector<detail::Face> faces{on_the_way[1]};
            detail::Questions questions(model, 0);
            detail::add_corner(faces, on_the_way, on_the_way[0].foot(), 0.5e-3, questions);
            ASSERT_EQ(faces.size(), 1u) << from << " m, " << way << " m";
            EXPECT_EQ(faces[0].normal(), on_the_way[1].normal()) << from << " m, " << way << " m";
            EXPECT_FALSE(detail::is_corner(on_the_way[0], on_the_way[2], on_the_way[1].foot(), questions));
            sharp += on_the_way[0].normal().dot(on_the_way[2].normal()) < 0.87 ? 1 : 0;
        }
    }
    EXPECT_GT(sharp, 0) << "this test would not see a valley taken for a corner";
}

TEST(Corner, of_a_step_does_not_stop_a_hand_that_goes_over_it) {
    // A kerb of 5 mm: floor for x < 0, its wall at x = 0, its top at z = 5 mm.
    const SurfaceModel kerb = [](const Vec3& q) -> SurfacePoint {
        const double floor = q.x < 0 ? q.z : 1, wall = q.z < 0.005 ? -q.x : 1,
                     top = q.x >= 0 ? q.z - 0.005 : 1;
        if (q.x < 0 && q.z > 0.005 && std::hypot(q.x, q.z - 0.005) < q.z) {
            const double far = std::hypot(q.x, q.z - 0.005);
            return {.foot = {0, q.y, 0.005}, .normal = {q.x / far, 0, (q.z - 0.005) / far}};
        }
        if (std::abs(wall) <= std::min(std::abs(floor), std::abs(top)))
            return {.foot = {0, q.y, q.z}, .normal = {-1, 0, 0}};
        if (std::abs(floor) <= std::abs(top)) return {.foot = {q.x, q.y, 0}, .normal = {0, 0, 1}};
        return {.foot = {q.x, q.y, 0.005}, .normal = {0, 0, 1}};
    };
    for (const double speed : {0.1, 0.2, 0.3}) {
        for (double phase = 0; phase < update_cycles * dt; phase += 3 * dt) {
            // Up from the floor, and over it 3 mm above its top.
            const Path path = [=](double t) {
                const double x = -0.1 + speed * t;
                return Vector3d(x, 0, std::clamp(0.008 + 0.2 * (x + 0.005), 0.001, 0.008));
            };
            const double seconds = 0.15 / speed;
            const auto over = [&](Way way) {
                return run({.way = way, .seconds = seconds, .phase = phase}, kerb, path).largest_side;
            };
            EXPECT_LE(over(Way::safe), std::max(1.5, over(Way::none))) << speed << " m/s, phase " << phase;
        }
    }
}

}  // namespace
