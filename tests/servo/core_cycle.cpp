// What one cycle does, seen from the device and from the report.

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <knurl/drivers/sim_device.hpp>
#include <knurl/shm/counters.hpp>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using drivers::ReadStatus;
using protocol::Count;

/// Active with a plane under the hand, 1 mm deep: 0.5 N.
struct Active {
    PuppetDevice device;
    Offline servo;
    OfflineClaim& claim;

    explicit Active(const ServoOptions& options = without_silence())
        : servo(device, options), claim(servo.claim()) {
        device.tip = {0, 0, -1e-3};
        claim.add(Plane{.stiffness = 500, .recovery = 0});
        claim.arm();
        run(servo, 600);
        EXPECT_EQ(state(), DeviceState::active);
        EXPECT_NEAR(device.force().z(), 0.5, 1e-12);
    }
    static ServoOptions without_silence() {
        ServoOptions options = live_options();
        options.silence = false;
        return options;
    }
    DeviceState state() { return servo.servo().last().state; }
    std::uint32_t faults() { return servo.servo().last().faults; }
};

/// Delivers stamps that advance by themselves: 7 us from read to write.
struct TickingClock final : Clock {
    Nanoseconds time = 0;
    Nanoseconds now() noexcept override { return time += 7'000; }
};

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
    const Handle plane = claim.add(Plane{.stiffness = 800});
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

// -------------------------------------------------------------------------------------------------- time

TEST(Time, TheFirstCycleIsOnePeriodLong) {
    // A spring that moves 1 m in 1 s has moved by dt after the first cycle that saw its new place.
    for (const double rate : {500.0, 1000.0, 3000.0, 4000.0}) {
        PuppetDevice device;
        Offline servo(device, offline_options(rate));
        OfflineClaim& claim = servo.claim();
        const Spring spring{.stiffness = 1, .duration = 1};
        const Handle handle = claim.add(spring);
        servo.step();
        Spring moved = spring;
        moved.anchor = {1, 0, 0};
        claim.update(handle, moved);
        claim.commit();
        for (int i = 0; i < 10; ++i) servo.step();
        EXPECT_NEAR(servo.servo().last().scene_force.x, 10 / rate, 1.5 / rate) << rate;
        const double before = servo.servo().last().scene_force.x;
        EXPECT_NEAR(servo.step().scene_force.x - before, 1 / rate, 1e-12) << rate;
    }
}

TEST(Time, RepresentationsNeverSeeAGapLongerThanTwoMilliseconds) {
    PuppetDevice device;
    Offline servo(device);
    OfflineClaim& claim = servo.claim();
    const Handle handle = claim.add(Spring{.stiffness = 1, .duration = 1});
    servo.step();
    claim.update(handle, Spring{.anchor = {1, 0, 0}, .stiffness = 1, .duration = 1});
    claim.commit();
    servo.step();
    const double before = servo.step().scene_force.x;
    EXPECT_NEAR(servo.step_after(15'000'000).scene_force.x - before, 2e-3, 1e-12);
    EXPECT_EQ(servo.count(Count::stalls), 0u);
}

TEST(Time, AStallTakesTheForceAndTheOrdinaryRampBringsItBack) {
    Active active;
    active.servo.step_after(19'000'000);
    EXPECT_EQ(active.servo.count(Count::stalls), 0u);
    EXPECT_NEAR(active.device.force().z(), 0.5, 1e-12);

    active.servo.step_after(21'000'000);
    EXPECT_EQ(active.servo.count(Count::stalls), 1u);
    EXPECT_EQ(active.state(), DeviceState::ramp_up);
    EXPECT_LE(active.device.force().z(), 0.5 * 2e-3 / 0.5 + 1e-12);
    double last = active.device.force().z();
    for (int i = 0; i < 499; ++i) {
        active.servo.step();
        EXPECT_NEAR(active.device.force().z() - last, i < 498 ? 1e-3 : 0, 1e-9);
        last = active.device.force().z();
    }
    EXPECT_EQ(active.state(), DeviceState::active);
    EXPECT_NEAR(last, 0.5, 1e-12);
    EXPECT_EQ(active.faults(), 0u);
}

TEST(Time, AJumpOfTheClockIsAFault) {
    Active active;
    active.servo.step_after(1'100'000'000);
    EXPECT_EQ(active.state(), DeviceState::fault);
    EXPECT_EQ(active.faults(), fault::clock_jump);
    EXPECT_TRUE(active.device.force().isZero(0));

    Active backwards;
    backwards.servo.step_after(-5'000'000);
    EXPECT_EQ(backwards.faults(), fault::clock_jump);
}

TEST(Time, WhenTheGuardianHasActedTheForceComesBackByTheRamp) {
    Active active;
    active.servo.servo().guardian_acted();
    const Report& report = active.servo.step();
    EXPECT_EQ(report.state, DeviceState::ramp_up);
    EXPECT_NE(report.flags & report_flags::guardian, 0u);
    EXPECT_LT(active.device.force().z(), 0.002);
    EXPECT_EQ(active.servo.count(Count::guardian_zeroings), 1u);
    EXPECT_EQ(active.servo.step().flags & report_flags::guardian, 0u);
    run(active.servo, 600);
    EXPECT_EQ(active.state(), DeviceState::active);
}

TEST(Time, ACycleIsLateIfItsWriteEndsAfterTheNextDeadline) {
    PuppetDevice device;
    TickingClock clock;
    OfflineMemory segment(protocol::device_layout().total);
    Servo servo(device, clock, segment.data(), live_options());
    const auto step = [&](Nanoseconds deadline, Nanoseconds now) {
        clock.time = now;
        servo.step(deadline, now);
        return servo.last();
    };
    Report report = step(0, 100);
    EXPECT_EQ(report.deadline_ns, 0);
    EXPECT_EQ(report.read_ns, 7'100) << "stamped after the read";
    EXPECT_EQ(report.write_ns, 14'100) << "stamped after the write";
    EXPECT_EQ(report.late_count, 0u);
    EXPECT_EQ(step(1'000'000, 1'985'999).late_count, 0u) << "its write ends 1 ns before the next deadline";
    EXPECT_EQ(step(2'000'000, 2'986'001).late_count, 1u) << "1 ns after it";
    EXPECT_EQ(step(3'000'000, 4'000'001).late_count, 2u);
    EXPECT_EQ(step(4'000'000, 4'020'000).late_count, 2u);
    const shm::CountersReader counters(segment.data() + protocol::device_layout().counters,
                                       protocol::count_names);
    EXPECT_EQ(counters.read(static_cast<std::size_t>(Count::late_cycles)), 2u);
    EXPECT_EQ(counters.read(static_cast<std::size_t>(Count::overruns)), 1u)
        << "began after the next deadline";
    EXPECT_EQ(counters.read(static_cast<std::size_t>(Count::cycles)), 5u);
    EXPECT_EQ(counters.read(static_cast<std::size_t>(Count::last_step_ns)), 14'000u);
}

// ----------------------------------------------------------------------------------------------- samples

TEST(Samples, ABadSampleIsCountedAndTheLastGoodOneKept) {
    Active active;
    active.device.status = ReadStatus::bad;
    active.device.tip = {0, 0, -5e-3};
    run(active.servo, 2);
    EXPECT_EQ(active.state(), DeviceState::active);
    EXPECT_NEAR(active.device.force().z(), 0.5, 1e-12);
    EXPECT_EQ(active.servo.count(Count::bad_samples), 2u);
    active.device.status = ReadStatus::ok;
    active.device.tip = {0, 0, -1e-3};
    run(active.servo, 1);
    active.device.status = ReadStatus::bad;
    run(active.servo, 2);
    EXPECT_EQ(active.state(), DeviceState::active) << "only bad ones in a row matter";
}

TEST(Samples, ThreeBadOnesInARowRampDownAndTenFault) {
    Active active;
    active.device.status = ReadStatus::bad;
    run(active.servo, 3);
    EXPECT_EQ(active.state(), DeviceState::ramp_down);
    EXPECT_GT(active.device.force().z(), 0.4);
    run(active.servo, 6);
    EXPECT_EQ(active.state(), DeviceState::ramp_down);
    run(active.servo, 1);
    EXPECT_EQ(active.state(), DeviceState::fault);
    EXPECT_EQ(active.faults(), fault::bad_samples);
    EXPECT_TRUE(active.device.force().isZero(0));
    active.device.status = ReadStatus::ok;
    run(active.servo, 100);
    EXPECT_EQ(active.state(), DeviceState::fault) << "latched";
}

TEST(Samples, ThreeBadOnesEndInIdleUntilSomebodyArms) {
    Active active;
    active.device.status = ReadStatus::bad;
    run(active.servo, 3);
    active.device.status = ReadStatus::ok;
    run(active.servo, 1000);
    EXPECT_EQ(active.state(), DeviceState::idle);
    active.claim.arm();
    run(active.servo, 600);
    EXPECT_EQ(active.state(), DeviceState::active);
}

TEST(Samples, NaNInASampleIsABadSample) {
    Active active;
    active.device.tip.x() = std::numeric_limits<double>::quiet_NaN();
    run(active.servo, 2);
    EXPECT_EQ(active.servo.count(Count::bad_samples), 2u);
    EXPECT_TRUE(std::isfinite(active.servo.servo().last().position.x));
    EXPECT_TRUE(std::isfinite(active.servo.servo().last().joints[0]));
    EXPECT_EQ(active.state(), DeviceState::active);
}

TEST(Samples, AnImpossibleJumpIsRejected) {
    Active active;
    active.device.tip = {0.05, 0, -1e-3};  // 50 m/s
    run(active.servo, 1);
    EXPECT_EQ(active.servo.servo().last().position.x, 0);
    EXPECT_EQ(active.servo.count(Count::bad_samples), 1u);
    active.device.tip = {0, 0, -1e-3};
    run(active.servo, 1);
    EXPECT_EQ(active.state(), DeviceState::active);
    EXPECT_TRUE(vec(active.servo.servo().last().velocity).isZero(1e-9))
        << "and leaves no trace in the velocity";
}

TEST(Samples, AJumpThatGoesOnIsAFaultAndThenWhereTheHandIs) {
    Active active;
    active.device.tip = {0.03, 0, -1e-3};
    run(active.servo, 9);
    EXPECT_EQ(active.state(), DeviceState::ramp_down)
        << "30 mm in 9 ms would be possible, in one cycle they were not";
    run(active.servo, 1);
    EXPECT_EQ(active.faults(), fault::encoder_jump);
    run(active.servo, 2);
    EXPECT_EQ(active.servo.servo().last().position.x, 0.03);
    EXPECT_TRUE(vec(active.servo.servo().last().velocity).isZero(1e-9));
    active.claim.reset_fault();
    run(active.servo, 1);
    EXPECT_EQ(active.state(), DeviceState::idle);
}

TEST(Samples, APostureNearASingularOneOrAStopIsReported) {
    PuppetDevice device;
    device.link_.joint_least[0] = -0.05;
    device.link_.joint_greatest[0] = 0.05;
    Offline servo(device, live_options());
    constexpr std::uint32_t both = report_flags::near_singular | report_flags::at_joint_limit;
    run(servo, 20);
    EXPECT_EQ(servo.servo().last().flags & both, 0u);
    for (; device.tip.x() < 0.0495; device.tip.x() += 0.0005)
        run(servo, 1);  // to 0.5 % of 100 mm from the stop
    run(servo, 16);
    EXPECT_EQ(servo.servo().last().flags & both, report_flags::at_joint_limit);
    device.tip.x() = 0.048;
    device.mechanism_.lever_z = 0.04;
    run(servo, 16);
    EXPECT_EQ(servo.servo().last().flags & both, report_flags::near_singular);
    device.mechanism_.lever_z = 0.06;
    run(servo, 16);
    EXPECT_EQ(servo.servo().last().flags & both, 0u);
}

TEST(Samples, AStaleSampleIsRepeatedAndSaidSo) {
    Active active;
    active.device.status = ReadStatus::stale;
    run(active.servo, 15);
    EXPECT_EQ(active.servo.count(Count::stale_samples), 15u);
    EXPECT_NE(active.servo.servo().last().flags & report_flags::stale, 0u);
    EXPECT_EQ(active.state(), DeviceState::active);
    EXPECT_NEAR(active.device.force().z(), 0.5, 1e-12);
    run(active.servo, 10);
    EXPECT_EQ(active.state(), DeviceState::ramp_down) << "after 20 ms it is as bad as none";
}

TEST(Samples, ADeviceSlowerThanTheServoIsNotJerkyInItsVelocity) {
    PuppetDevice device;
    Offline servo(device, live_options(4000));
    for (int i = 0; i < 4000; ++i) {
        device.status = i % 4 == 0 ? ReadStatus::ok : ReadStatus::stale;  // 1 kHz
        device.tip.x() = 0.05 * (i / 4) * 1e-3;
        servo.step();
        if (i > 400) {
            ASSERT_NEAR(servo.servo().last().velocity.x, 0.05, 1e-6) << i;
        }
    }
}

TEST(Samples, UnpluggedIsAFaultAndPluggedInAgainIsIdle) {
    Active active;
    active.device.status = ReadStatus::unplugged;
    run(active.servo, 1);
    EXPECT_EQ(active.state(), DeviceState::fault);
    EXPECT_EQ(active.faults(), fault::unplugged);
    run(active.servo, 1);
    EXPECT_EQ(active.state(), DeviceState::disconnected);
    EXPECT_EQ(active.faults(), fault::unplugged) << "the cause stays visible";
    const std::uint64_t writes = active.device.writes;
    run(active.servo, 100);
    EXPECT_EQ(active.device.writes, writes);
    active.device.status = ReadStatus::ok;
    active.device.tip = {0.08, 0, 0};  // moved meanwhile
    run(active.servo, 1);
    EXPECT_EQ(active.state(), DeviceState::idle);
    EXPECT_EQ(active.faults(), 0u);
    EXPECT_TRUE(vec(active.servo.servo().last().velocity).isZero(0));
    run(active.servo, 1000);
    EXPECT_EQ(active.state(), DeviceState::idle) << "enabling is never automatic";
    EXPECT_TRUE(active.device.force().isZero(0));
}

TEST(Samples, ADeviceIsThereOnceItHasSaidWhereItIs) {
    Active active;
    active.device.status = ReadStatus::unplugged;
    run(active.servo, 2);
    ASSERT_EQ(active.state(), DeviceState::disconnected);
    // Plugged in again, its driver has no sample for a while, or garbage.
    active.device.status = ReadStatus::stale;
    run(active.servo, 100);
    active.device.status = ReadStatus::bad;
    run(active.servo, 100);
    EXPECT_EQ(active.state(), DeviceState::disconnected);
    EXPECT_EQ(active.faults(), fault::unplugged) << "that nothing has come yet is no fault besides";
    active.device.calibrated = false;
    active.device.status = ReadStatus::ok;
    run(active.servo, 1);
    EXPECT_EQ(active.state(), DeviceState::idle);
    active.claim.arm();
    run(active.servo, 100);
    EXPECT_EQ(active.state(), DeviceState::idle) << "its homing was before it was unplugged";
}

TEST(Samples, HomingMayMoveTheEncodersAtOnce) {
    Active active;
    active.device.calibrated = false;
    run(active.servo, 5);
    active.device.calibrated = true;
    active.device.tip.x() += 0.05;
    run(active.servo, 1);
    EXPECT_EQ(active.faults(), 0u);
    EXPECT_EQ(active.servo.count(Count::bad_samples), 0u);
    EXPECT_TRUE(vec(active.servo.servo().last().velocity).isZero(0)) << "it was no motion";
}

TEST(Samples, AWriteThatFindsNoDeviceIsAFaultInTheSameCycle) {
    Active active;
    active.device.there = false;
    active.device.status = ReadStatus::ok;
    run(active.servo, 1);
    EXPECT_EQ(active.faults(), fault::unplugged);
    active.device.status = ReadStatus::unplugged;
    run(active.servo, 2);
    EXPECT_EQ(active.state(), DeviceState::disconnected);
}

TEST(Samples, WithoutAPoseTheEffortIsZeroAndThePoseIsKept) {
    Active active;
    active.device.mechanism_.broken = true;
    run(active.servo, 1);
    EXPECT_TRUE(active.device.force().isZero(0));
    EXPECT_EQ(active.servo.count(Count::kinematics_failures), 1u);
    EXPECT_EQ(active.servo.servo().last().position.z, -1e-3);
    EXPECT_EQ(active.state(), DeviceState::active);
    active.device.mechanism_.broken = false;
    run(active.servo, 1);
    EXPECT_NEAR(active.device.force().z(), 0.5, 1e-12);
    active.device.mechanism_.broken = true;
    run(active.servo, 10);
    EXPECT_EQ(active.faults(), fault::kinematics);
}

TEST(Samples, ADeviceThatMeasuresVelocityIsBelieved) {
    PuppetDevice device;
    device.has_velocity = true;
    device.velocity = {0.1, -0.2, 0.3};
    Offline servo(device);
    OfflineClaim& claim = servo.claim();
    claim.add(Plane{.offset = 1, .stiffness = 10, .damping = 2, .recovery = 0});
    device.tip = {0, 0, 0.9};
    const Report& report = servo.step();
    EXPECT_TRUE(vec(report.velocity).isApprox(device.velocity, 1e-15));
    EXPECT_NEAR(report.scene_force.z, 10 * 0.1 - 2 * 0.3, 1e-12);
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
    ClaimTerms terms;  // no limits: the scene may ask for more than the device gives
    servo.claim(terms).add(ConstantForce{.force = {3, 0, 4}, .recovery = 0});
    run(servo, 20);
    const Report& report = servo.servo().last();
    if (report.state == DeviceState::active) {
        EXPECT_TRUE(vec(report.scene_force).isApprox(Eigen::Vector3d(3, 0, 4)));
        EXPECT_NEAR(vec(report.sent_force).norm(), 1, 1e-12);
        EXPECT_NE(report.flags & report_flags::clamped, 0u);
    } else {
        ADD_FAILURE() << "5 N within one cycle are 2.5 ms of the slew gate: no fault";
    }
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
    const Handle plane = first.add(Plane{.offset = -0.01, .stiffness = 800, .damping = 1});
    const Handle spring = second.add(Spring{.stiffness = 40});
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
