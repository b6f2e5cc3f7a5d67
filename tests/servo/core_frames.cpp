// A claim's frame, and its limits in the units of its world.

#include <cmath>
#include <random>

#include <knurl/reps/plane.hpp>
#include <knurl/reps/spring.hpp>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;

TEST(Frames, VirtualWorkAgreesForForceAndTorque) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 50; ++round) {
        SCOPED_TRACE(round);
        PuppetDevice device(6);
        device.tip = 0.02 * Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
        Offline servo(device);
        ClaimTerms terms;
        terms.frame = {.device_centre = {uniform(random), uniform(random), uniform(random)},
                       .world_centre = {uniform(random), uniform(random), uniform(random)},
                       .scale = std::exp(uniform(random) * 3),
                       .force_scale = std::exp(uniform(random))};
        OfflineClaim& claim = servo.claim(terms);
        // A spring on a lever makes force and torque.
        claim.add(Spring{.anchor = {uniform(random), uniform(random), uniform(random)},
                         .attach = {uniform(random), uniform(random), uniform(random)},
                         .stiffness = 100});
        servo.step();
        const auto& entry = claim.feedback().entries.at(0);
        const Report& report = servo.servo().last();
        // World x = s (device x - centre) + centre': a device motion dx is s dx there, a rotation is the
        // same. In both, the device's work is f/s of the world's.
        const double ratio = terms.frame.force_scale / terms.frame.scale;
        const Eigen::Vector3d dx(uniform(random), uniform(random), uniform(random));
        const Eigen::Vector3d turn(uniform(random), uniform(random), uniform(random));
        EXPECT_NEAR(vec(report.sent_force).dot(dx), ratio * vec(entry.force).dot(terms.frame.scale * dx),
                    1e-12 * (1 + vec(report.sent_force).norm()));
        EXPECT_NEAR(vec(report.sent_torque).dot(turn), ratio * vec(entry.torque).dot(turn),
                    1e-12 * (1 + vec(report.sent_torque).norm()));
    }
}

TEST(Frames, APlaneOfTheWorldLiesWhereTheFrameSays) {
    PuppetDevice device;
    device.link_.workspace_centre = {0.1, 0.2, 0.3};
    device.link_.workspace_radius = 0.05;
    const protocol::ClaimRequest request{.workspace_radius = 0.5, .workspace_centre = {0, 0, 1}};
    const protocol::Frame frame = frame_for(device.link(), request);
    EXPECT_NEAR(frame.scale, 10, 1e-12);
    EXPECT_EQ(frame.force_scale, 1);

    ServoOptions options = offline_options();
    Offline servo(device, options);
    ClaimTerms terms;
    terms.frame = frame;
    OfflineClaim& claim = servo.claim(terms);
    claim.add(Plane{.offset = 1, .stiffness = 50});  // through the world's workspace centre
    device.tip = {0.1, 0.2, 0.299};                  // 1 mm below it: 10 mm in the world
    const Report& report = servo.step();
    EXPECT_NEAR(report.sent_force.z, 0.5, 1e-12);
    EXPECT_NEAR(report.contact_point.z, 0.3, 1e-12) << "reports are in the device's frame";
    EXPECT_NEAR(claim.feedback().entries.at(0).contact_point.z, 1, 1e-12) << "feedback in the claim's";
}

TEST(Frames, LimitsAreTheDevicesInWorldUnits) {
    PuppetDevice device(6);
    protocol::Frame frame;
    frame.scale = 5;
    frame.force_scale = 2;
    const Limits limits = limits_for(device.link(), 1000, frame);
    // The hand feels a world plane of k_world as f s k_world.
    EXPECT_NEAR(limits.max_stiffness * 10, max_stiffness(device.link(), 1000), 1e-9);
    EXPECT_NEAR(limits.max_force * 2, device.link().peak_force, 1e-12);
    EXPECT_NEAR(limits.max_torque * 2 / 5, device.link().peak_torque, 1e-12);
    EXPECT_NEAR(limits.damping * 10, device.link().damping, 1e-12);
    EXPECT_EQ(limits.lag, device.link().lag);
    EXPECT_EQ(limits.period, 1e-3);
}

TEST(Frames, WithoutAWorkspaceTheScaleIsOne) {
    PuppetDevice device;
    EXPECT_EQ(frame_for(device.link(), {}).scale, 1);
    EXPECT_EQ(frame_for(device.link(), {.workspace_radius = std::nan("")}).scale, 1);
    EXPECT_EQ(frame_for(device.link(), {.workspace_radius = -2}).scale, 1);
}

TEST(Frames, TheStiffnessOfADeviceIsMeasuredElseEstimatedElseModest) {
    drivers::LinkConfig link;
    link.damping = 0.2;
    link.lag = 0.53e-3;
    EXPECT_NEAR(max_stiffness(link, 1000), 0.2 / 1.03e-3, 1e-9);
    link.grip_damping = 3;
    EXPECT_NEAR(max_stiffness(link, 1000), 3.2 / 1.03e-3, 1e-9);
    EXPECT_NEAR(max_stiffness(link, 4000), 3.2 / 0.655e-3, 1e-9);
    link.measured_max_stiffness = 1234;
    EXPECT_EQ(max_stiffness(link, 1000), 1234);
    EXPECT_EQ(max_stiffness({}, 1000), 1000);
}

TEST(Frames, AStiffnessAboveTheLimitIsClampedUnlessTheServoOnlyWarns) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-4};
    ServoOptions options = live_options();
    options.start_active = true;
    for (const bool clamp : {true, false}) {
        options.clamp_stiffness = clamp;
        Offline servo(device, options);
        servo.claim().add(Plane{.stiffness = 10'000, .recovery = 0});
        run(servo, 5);
        EXPECT_NEAR(servo.servo().last().scene_force.z,
                    clamp ? max_stiffness(device.link(), 1000) * 1e-4 : 1.0, 1e-9);
    }
}

}  // namespace
}  // namespace knurl::servo
