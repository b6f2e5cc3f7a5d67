// Reports come in the device's frame and leave the library in the claim's world.

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "frame.hpp"

namespace {

using knurl::Report;
using knurl::to_eigen;
using knurl::Vec3;
using knurl::detail::to_world;

knurl::protocol::Frame some_frame() {
    return {.device_centre = {0.01, -0.02, 0.15}, .world_centre = {1, 2, 3}, .scale = 10, .force_scale = 0.5};
}

TEST(Frame, an_observers_is_the_devices_own) {
    Report report;
    report.position = {0.1, 0.2, 0.3};
    report.sent_torque = {4, 5, 6};
    const Report same = to_world({}, report);
    EXPECT_EQ(same.position, report.position);
    EXPECT_EQ(same.sent_torque, report.sent_torque);
}

TEST(Frame, the_devices_centre_lies_where_the_claim_said) {
    Report report;
    report.position = some_frame().device_centre;
    report.contact_point = report.position;
    EXPECT_EQ(to_world(some_frame(), report).position, (Vec3{1, 2, 3}));
    EXPECT_EQ(to_world(some_frame(), report).contact_point, (Vec3{1, 2, 3}));
}

TEST(Frame, one_that_only_moves_changes_points_alone) {
    const knurl::protocol::Frame frame{.device_centre = {0.01, -0.02, 0.15}, .world_centre = {1, 2, 3}};
    Report report;
    report.position = report.velocity = report.slow_velocity = report.angular_velocity = {0.1, 0.2, 0.3};
    report.contact_point = report.scene_force = report.scene_torque = report.sent_force =
        report.sent_torque = {0.3, 0.2, 0.1};
    Report wanted = report;
    wanted.position = {0.1 - 0.01 + 1, 0.2 + 0.02 + 2, 0.3 - 0.15 + 3};
    wanted.contact_point = {0.3 - 0.01 + 1, 0.2 + 0.02 + 2, 0.1 - 0.15 + 3};
    const Report world = to_world(frame, report);
    EXPECT_EQ(std::memcmp(&world, &wanted, sizeof world), 0);
    EXPECT_EQ(to_world({.device_centre = {1, 2, 3}, .world_centre = {1, 2, 3}}, report).position,
              report.position)
        << "where both centres are the same nothing is rounded";
}

TEST(Frame, lengths_scale_and_angles_do_not) {
    Report report;
    report.position = {0.02, -0.02, 0.15};  // 1 cm from the centre
    report.velocity = {0.1, 0, 0};
    report.slow_velocity = {0, 0.2, 0};
    report.angular_velocity = {0, 0, 3};
    const Report world = to_world(some_frame(), report);
    EXPECT_NEAR(world.position.x, 1.1, 1e-12);
    EXPECT_NEAR(world.velocity.x, 1.0, 1e-12);
    EXPECT_NEAR(world.slow_velocity.y, 2.0, 1e-12);
    EXPECT_EQ(world.angular_velocity.z, 3.0);
}

TEST(Frame, power_keeps_one_ratio_between_force_and_torque) {
    // F.v and torque.w are both powers: with different ratios a lever in the world would gain or lose work.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto vector = [&] { return Vec3{any(random), any(random), any(random)}; };
    const knurl::protocol::Frame frame = some_frame();
    for (int i = 0; i < 100; ++i) {
        Report report;
        report.velocity = vector();
        report.angular_velocity = vector();
        report.sent_force = vector();
        report.sent_torque = vector();
        const Report world = to_world(frame, report);
        const double linear = to_eigen(world.sent_force).dot(to_eigen(world.velocity)) /
                              to_eigen(report.sent_force).dot(to_eigen(report.velocity));
        const double angular = to_eigen(world.sent_torque).dot(to_eigen(world.angular_velocity)) /
                               to_eigen(report.sent_torque).dot(to_eigen(report.angular_velocity));
        EXPECT_NEAR(linear, frame.scale / frame.force_scale, 1e-9);
        EXPECT_NEAR(angular, linear, 1e-9);
    }
}

}  // namespace
