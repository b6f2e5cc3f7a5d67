// Time in the cycle: its own length, stalls, jumps of the clock, the guardian, lateness.

#include <knurl/reps/spring.hpp>
#include <knurl/shm/counters.hpp>

#include "core_active.hpp"

namespace knurl::servo::core_time_tests {
namespace {

using namespace testing;
using protocol::Count;

/// Delivers stamps that advance by themselves: 7 us from read to write.
struct TickingClock final : Clock {
    Nanoseconds time = 0;
    Nanoseconds now() noexcept override { return time += 7'000; }
};

TEST(Time, TheFirstCycleIsOnePeriodLong) {
    // A spring that moves 1 m in 1 s has moved by dt after the first cycle that saw its new place.
    for (const double rate : {500.0, 1000.0, 3000.0, 4000.0}) {
        PuppetDevice device;
        Offline servo(device, offline_options(rate));
        OfflineClaim& claim = servo.claim();
        const Spring spring{.stiffness = 1, .duration = 1};
        const RepresentationId id = claim.add(spring);
        servo.step();
        Spring moved = spring;
        moved.anchor = {1, 0, 0};
        claim.update(id, moved);
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
    const RepresentationId id = claim.add(Spring{.stiffness = 1, .duration = 1});
    servo.step();
    claim.update(id, Spring{.anchor = {1, 0, 0}, .stiffness = 1, .duration = 1});
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

TEST(Time, WhileTheGuardianStandsStillNoForceIsOn) {
    Active active;
    Servo& servo = active.servo.servo();
    servo.guardian_is_still(true);
    double last = active.device.force().z();
    int cycles = 0;
    for (; active.state() != DeviceState::fault && cycles < 100; ++cycles) {
        active.servo.step();
        EXPECT_LE(last - active.device.force().z(), 2 * 0.5 / 50 + 1e-9) << "N: two ramps, no step";
        last = active.device.force().z();
    }
    EXPECT_NEAR(cycles, 52, 1) << "the ramp, and the cycle after it";
    EXPECT_EQ(active.faults(), fault::unguarded);
    EXPECT_EQ(last, 0);

    const auto answer = [&] {
        return static_cast<protocol::RefusalReason>(active.claim.replies().back().reason);
    };
    active.claim.reset_fault();
    active.servo.step();
    EXPECT_EQ(answer(), protocol::RefusalReason::cause_persists);
    servo.guardian_is_still(false);
    active.servo.step();
    active.claim.reset_fault();
    active.claim.arm();
    run(active.servo, 600);
    EXPECT_EQ(active.state(), DeviceState::active);
    EXPECT_EQ(active.faults(), 0u);
}

TEST(Time, AGuardianThatStandsStillIsNoFaultOfADeviceWithoutForce) {
    Active active;
    active.claim.disarm();
    run(active.servo, 100);
    ASSERT_EQ(active.state(), DeviceState::idle);
    active.servo.servo().guardian_is_still(true);
    run(active.servo, 100);
    EXPECT_EQ(active.state(), DeviceState::idle);
    active.claim.arm();
    for (int i = 0; i < 100; ++i) {
        active.servo.step();
        EXPECT_LE(std::abs(active.device.force().z()), 0.5 * 2 / 500 + 1e-9) << "two cycles of the ramp up";
    }
    EXPECT_EQ(active.faults(), fault::unguarded);
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

}  // namespace
}  // namespace knurl::servo::core_time_tests
