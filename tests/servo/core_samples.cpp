// Samples of the device and their effects: bad ones, stale ones, jumps, a device that is unplugged and
// returns.

#include <cmath>
#include <limits>

#include "core_active.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using drivers::ReadStatus;
using protocol::Count;

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

TEST(Samples, AFaultIsNotResetWhileItsCauseGoesOn) {
    Active active;
    active.device.status = ReadStatus::bad;
    run(active.servo, 20);
    ASSERT_EQ(active.state(), DeviceState::fault);
    active.claim.replies();
    active.claim.reset_fault();
    run(active.servo, 1);
    const protocol::Reply refused = active.claim.replies().at(0);
    EXPECT_EQ(refused.reason, static_cast<std::uint32_t>(protocol::RefusalReason::cause_persists));
    EXPECT_EQ(refused.value, fault::bad_samples) << "and says what goes on";
    EXPECT_EQ(active.state(), DeviceState::fault);
    active.device.status = ReadStatus::ok;
    run(active.servo, 1);
    active.claim.reset_fault();
    run(active.servo, 1);
    EXPECT_EQ(active.claim.replies().at(0).code, static_cast<std::uint32_t>(Verdict::Code::ok));
    EXPECT_EQ(active.state(), DeviceState::idle);
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
    // After plugging in, its driver has no sample for a while, or garbage.
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

}  // namespace
}  // namespace knurl::servo
