// The effects of one cycle at the device and in the report; and whole runs.

#include <cstring>
#include <random>

#include <knurl/drivers/sim_device.hpp>
#include <knurl/reps/constant_force.hpp>
#include <knurl/reps/spring.hpp>
#include <knurl/shm/broadcast_ring.hpp>

#include "core_active.hpp"

namespace knurl::servo {
namespace {

using namespace testing;

TEST(Cycle, OfflineASceneOfTheFirstCycleIsInFullForceAtOnce) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-3};
    Offline servo(device);
    servo.claim().add(Plane{.stiffness = 800});

    const Report& report = servo.step();

    EXPECT_EQ(report.cycle, 1u);
    EXPECT_EQ(report.state, DeviceState::active);
    EXPECT_DOUBLE_EQ(report.scene_force.z, 0.8);
    EXPECT_DOUBLE_EQ(device.force().z(), 0.8);
    EXPECT_EQ(report.flags & report_flags::touching, report_flags::touching);
    EXPECT_NEAR(report.contact_point.z, 0, 1e-15);
}

TEST(Cycle, OfflineALaterChangeIsFadedOverTenMilliseconds) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-3};
    Offline servo(device);
    OfflineClaim& claim = servo.claim();
    const RepresentationId plane = claim.add(Plane{.stiffness = 800});
    run(servo, 3);

    claim.update(plane, Plane{.stiffness = 400});
    claim.commit();

    double last = 0.8;
    for (int i = 0; i < 12; ++i) {
        const double force = servo.step().scene_force.z;
        EXPECT_LE(force, last + 1e-12);
        EXPECT_LE(last - force, 0.4 / 10 + 1e-12) << "cycle " << i;
        last = force;
    }
    EXPECT_NEAR(last, 0.4, 1e-12);
}

// ----------------------------------------------------------------------------------------------- reports

TEST(Reports, AreInTheSegmentOneACycleWithTheNewestLast) {
    Active active;
    shm::BroadcastReader reader(active.servo.segment() + protocol::device_layout().reports,
                                protocol::report_slots, sizeof(Report), 0);
    Report report;
    std::uint64_t expected = 1;
    while (reader.next(&report)) EXPECT_EQ(report.cycle, expected++);
    EXPECT_EQ(expected, 601u);
    EXPECT_EQ(std::memcmp(&report, &active.servo.servo().last(), sizeof report), 0);
}

TEST(Reports, SayWhatTheSceneWantedAndWhatWasSent) {
    PuppetDevice device;
    device.link_.peak_force = 1;
    ServoOptions options = live_options();
    options.start_active = true;
    Offline servo(device, options);
    ClaimTerms terms;  // no limits: the scene may request more than the device can give
    servo.claim(terms).add(ConstantForce{.force = {3, 0, 4}, .recovery = 0});
    run(servo, 20);
    const Report& report = servo.servo().last();
    ASSERT_EQ(report.state, DeviceState::active)
        << "5 N within one cycle are 2.5 ms of the slew gate: no fault";
    EXPECT_TRUE(vec(report.scene_force).isApprox(Eigen::Vector3d(3, 0, 4)));
    EXPECT_NEAR(vec(report.sent_force).norm(), 1, 1e-12);
    EXPECT_NE(report.flags & report_flags::clamped, 0u);
}

// ------------------------------------------------------------------------------------------- whole runs

struct Trace {
    std::vector<Report> reports;
    std::uint64_t device = 0;
};

/// Two seconds of a hand that strokes the simulated arm, with a client that changes its scene all the time.
Trace stroke(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    drivers::SimDevice device(drivers::sim_profile("premium15"));
    ServoOptions options = live_options();
    Offline servo(device, options);
    OfflineClaim& first = servo.claim();
    OfflineClaim& second = servo.claim();
    const RepresentationId plane = first.add(Plane{.offset = -0.01, .stiffness = 800, .damping = 1});
    const RepresentationId spring = second.add(Spring{.stiffness = 40});
    first.arm();
    second.arm();
    Trace trace;
    for (int i = 0; i < 2000; ++i) {
        if (i % 37 == 0) {
            first.update(plane, Plane{.normal = {0.1 * uniform(random), 0.1 * uniform(random), 1},
                                      .offset = 0.005 * uniform(random),
                                      .stiffness = 800,
                                      .damping = 1});
            first.commit(trace.reports.empty() ? 0 : trace.reports.back().cycle);
        }
        if (i % 91 == 0) {
            second.update(spring, Spring{.anchor = {0.03 * uniform(random), 0.03 * uniform(random), 0},
                                         .stiffness = 40});
            second.commit();
        }
        trace.reports.push_back(servo.step());
    }
    trace.device = device.digest();
    return trace;
}

TEST(Runs, TheSameRunTwiceIsTheSameToTheLastBit) {
    const Trace once = stroke(5), again = stroke(5), other = stroke(6);
    ASSERT_EQ(once.reports.size(), again.reports.size());
    EXPECT_EQ(std::memcmp(once.reports.data(), again.reports.data(), once.reports.size() * sizeof(Report)),
              0);
    EXPECT_EQ(once.device, again.device);
    EXPECT_NE(once.device, other.device);
}

TEST(Runs, AHandOnTheSimulatedArmFeelsThePlaneWithoutFault) {
    const Trace trace = stroke(9);
    double most = 0;
    for (const Report& report : trace.reports) {
        EXPECT_EQ(report.faults, 0u) << report.cycle;
        most = std::max(most, vec(report.sent_force).norm());
    }
    EXPECT_EQ(trace.reports.back().state, DeviceState::active);
    EXPECT_GT(most, 0.2);
}

}  // namespace
}  // namespace knurl::servo
