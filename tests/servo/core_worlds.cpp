// A claim's world may have any scale: a plane that an application lifts under a resting hand rises as fast,
// and steps as little, in metres and newtons of the device.

#include <algorithm>
#include <cmath>

#include <knurl/drivers/sim_device.hpp>
#include <knurl/reps/plane.hpp>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

struct Lift {
    double arrives = -1;                            // s, until the hand is at 90 % of its way
    double jump = 0, most = 0;                      // N in a cycle, N
    Eigen::Vector3d end = Eigen::Vector3d::Zero();  // m
    std::uint32_t faults = 0;
};

Lift lift(double metre) {
    drivers::SimProfile profile = drivers::sim_profile("premium15");
    profile.hand.push = 1.5;
    drivers::SimDevice device(profile, drivers::Motion({{.t = 0, .position = {0, 0, -0.005}}}));
    ServoOptions options = offline_options();
    options.rise_speed = ServoOptions{}.rise_speed;
    Offline servo(device, options);
    ClaimTerms terms;
    terms.frame = frame_for(device.link(), {.workspace_radius = metre * device.link().workspace_radius});
    terms.limits = limits_for(device.link(), options.rate, terms.frame);
    OfflineClaim& claim = servo.claim(std::move(terms));
    Plane plane{.offset = -0.005 * metre, .stiffness = 800 / metre};
    const RepresentationId id = claim.add(plane);
    claim.arm();
    Lift lift;
    for (int i = 0; i < 1000; ++i) servo.step();
    const double from = device.state().position.z();
    plane.offset = 0.015 * metre;
    claim.update(id, plane);
    claim.commit();
    std::vector<double> way;
    double last = servo.servo().last().scene_force.z;
    for (int i = 0; i < 3000; ++i) {
        const Report& report = servo.step();
        lift.faults |= report.faults;
        lift.jump = std::max(lift.jump, std::abs(report.scene_force.z - last));
        lift.most = std::max(lift.most, std::abs(report.scene_force.z));
        last = report.scene_force.z;
        way.push_back(device.state().position.z() - from);
    }
    const auto at = std::find_if(way.begin(), way.end(), [&](double z) { return z > 0.9 * way.back(); });
    lift.arrives = 1e-3 * static_cast<double>(at - way.begin());
    lift.end = device.state().position;
    return lift;
}

TEST(Worlds, APlaneRisesUnderTheHandAsFastInAWorldOfAnySize) {
    const Lift here = lift(1);
    std::printf("20 mm: %.3f s, jump %.4f N, at most %.2f N\n", here.arrives, here.jump, here.most);
    EXPECT_GT(here.arrives, 0.05);
    EXPECT_LT(here.jump, 0.3);
    EXPECT_EQ(here.faults, 0u);
    for (const double metre : {0.01, 0.1, 10.0, 100.0, 1000.0}) {
        SCOPED_TRACE(metre);
        const Lift there = lift(metre);
        EXPECT_NEAR(there.arrives, here.arrives, 1e-9);
        EXPECT_NEAR(there.jump, here.jump, 1e-6);
        EXPECT_NEAR(there.most, here.most, 1e-6);
        EXPECT_LT((there.end - here.end).norm(), 1e-8);
        EXPECT_EQ(there.faults, 0u);
    }
    for (const double metre : {0x1p-7, 0x1p10}) {
        SCOPED_TRACE(metre);
        EXPECT_EQ(lift(metre).end, here.end) << "to the last bit";
    }
}

TEST(Worlds, TheLimitsSayWhatAMetreAndANewtonAre) {
    protocol::Frame frame;
    frame.scale = 8;
    frame.force_scale = 4;
    const Limits limits = limits_for({}, 1000, frame);
    EXPECT_EQ(limits.metre, 8);
    EXPECT_EQ(limits.newton, 0.25);
    EXPECT_EQ(limits.resolution, 8 * Limits{}.resolution);
}

}  // namespace
}  // namespace knurl::servo
