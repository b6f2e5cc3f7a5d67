// The device's states: how each is entered, how each is left, and what reaches the motors in it.

#include <string>

#include "core_gate.hpp"

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::RefusalReason;

const Eigen::Vector3d push{0, 0, 1};  // N

TEST(States, BeginIdleWithoutForce) {
    Gate gate;
    gate.steps(100, push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle);
    EXPECT_TRUE(zero(gate.last));
}

TEST(States, ArmingWaitsInArmedForASlowHand) {
    Gate gate;
    gate.velocity = {0.3, 0, 0};  // above arm_speed
    EXPECT_EQ(gate.supervisor.arm(true, 0.3), RefusalReason::none);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::armed);
    gate.steps(1000, push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::armed);
    EXPECT_TRUE(zero(gate.last));

    gate.velocity = {0.1, 0, 0};
    gate.step(push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::ramp_up);
}

TEST(States, RampUpIsLinearOverHalfASecondAndEndsActive) {
    Gate gate;
    gate.supervisor.arm(true, 0);
    gate.step(push);
    ASSERT_EQ(gate.supervisor.state(), DeviceState::ramp_up);
    for (int i = 1; i < 500; ++i) {
        gate.step(push);
        ASSERT_EQ(gate.supervisor.state(), DeviceState::ramp_up) << i;
        ASSERT_NEAR(gate.last.sent.force.z(), i / 500.0, 1e-9);
    }
    gate.step(push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
    EXPECT_EQ(gate.last.sent.force.z(), 1.0);
}

TEST(States, DisarmingRampsDownOverFiftyMillisecondsAndEndsIdle) {
    Gate gate;
    gate.activate(push);
    gate.supervisor.disarm();
    EXPECT_EQ(gate.supervisor.state(), DeviceState::ramp_down);
    for (int i = 1; i < 50; ++i) {
        gate.step(push);
        ASSERT_EQ(gate.supervisor.state(), DeviceState::ramp_down);
        ASSERT_NEAR(gate.last.sent.force.z(), 1 - i / 50.0, 1e-9);
    }
    gate.step(push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle);
    EXPECT_TRUE(zero(gate.last));
}

TEST(States, WithoutAnArmedClaimTheDeviceRampsDown) {
    Gate gate;
    gate.activate(push);
    gate.armed = 0;
    gate.step(push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::ramp_down);
    gate.until(DeviceState::idle, push);

    Gate armed;
    armed.velocity = {0.3, 0, 0};
    armed.supervisor.arm(true, 0.3);
    armed.armed = 0;
    armed.step();
    EXPECT_EQ(armed.supervisor.state(), DeviceState::idle);

    Gate rising;
    rising.supervisor.arm(true, 0);
    rising.steps(100, push);
    rising.armed = 0;
    rising.step(push);
    EXPECT_EQ(rising.supervisor.state(), DeviceState::ramp_down);
}

TEST(States, ArmedAgainDuringTheRampDownItGoesThroughZero) {
    Gate gate;
    gate.activate(push);
    gate.supervisor.disarm();
    gate.steps(10, push);
    EXPECT_EQ(gate.supervisor.arm(true, 0), RefusalReason::none);
    gate.until(DeviceState::armed, push);
    EXPECT_TRUE(zero(gate.last));
    EXPECT_EQ(gate.supervisor.gain(), 0);
    gate.until(DeviceState::active, push);
}

TEST(States, ArmingAgainWhileActiveChangesNothing) {
    Gate gate;
    gate.activate(push);
    EXPECT_EQ(gate.supervisor.arm(true, 0), RefusalReason::none);
    gate.step(push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
    EXPECT_EQ(gate.last.sent.force.z(), 1.0);
}

TEST(States, AFaultIsZeroAtOnceFromEveryState) {
    for (const DeviceState from : {DeviceState::idle, DeviceState::armed, DeviceState::ramp_up,
                                   DeviceState::active, DeviceState::ramp_down}) {
        SCOPED_TRACE("from state " + std::to_string(static_cast<int>(from)));
        Gate gate;
        if (from != DeviceState::idle) gate.supervisor.arm(true, 0);
        if (from == DeviceState::ramp_up || from == DeviceState::active || from == DeviceState::ramp_down)
            gate.steps(100, push);
        if (from == DeviceState::active) gate.until(DeviceState::active, push);
        if (from == DeviceState::ramp_down) gate.supervisor.disarm();
        ASSERT_EQ(gate.supervisor.state(), from);

        gate.supervisor.raise(fault::guardian);
        gate.step(push);
        EXPECT_EQ(gate.supervisor.state(), DeviceState::fault);
        EXPECT_EQ(gate.supervisor.faults(), fault::guardian);
        EXPECT_TRUE(zero(gate.last));
        EXPECT_EQ(gate.supervisor.counts().faults, 1u);
    }
}

TEST(States, AFaultIsLatchedUntilItIsResetWithASlowHand) {
    Gate gate;
    gate.activate(push);
    gate.supervisor.raise(fault::speed);
    gate.steps(5000, push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::fault);
    EXPECT_EQ(gate.supervisor.arm(true, 0), RefusalReason::in_fault);
    gate.supervisor.disarm();
    EXPECT_EQ(gate.supervisor.state(), DeviceState::fault);
    EXPECT_EQ(gate.supervisor.reset_fault(0.25), RefusalReason::hand_too_fast);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::fault);

    EXPECT_EQ(gate.supervisor.reset_fault(0.1), RefusalReason::none);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle);
    EXPECT_EQ(gate.supervisor.faults(), 0u);
    gate.steps(1000, push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle) << "enabling is never automatic";
    EXPECT_TRUE(zero(gate.last));
}

TEST(States, CausesAddUpWhileInFault) {
    Gate gate;
    gate.supervisor.raise(fault::speed);
    gate.supervisor.raise(fault::power);
    EXPECT_EQ(gate.supervisor.faults(), fault::speed | fault::power);
    EXPECT_EQ(gate.supervisor.counts().faults, 1u);
}

TEST(States, RefusalsSayWhy) {
    Gate gate;
    EXPECT_EQ(gate.supervisor.arm(false, 0), RefusalReason::not_calibrated);
    EXPECT_EQ(gate.supervisor.arm(true, 1.6), RefusalReason::hand_too_fast);
    EXPECT_EQ(gate.supervisor.reset_fault(0), RefusalReason::not_in_fault);
    gate.supervisor.raise(fault::unplugged);
    gate.supervisor.disconnected();
    EXPECT_EQ(gate.supervisor.arm(true, 0), RefusalReason::disconnected);
    EXPECT_EQ(gate.supervisor.reset_fault(0), RefusalReason::disconnected);
}

TEST(States, ReconnectedIsIdleAndNeverArmed) {
    Gate gate;
    gate.activate(push);
    gate.supervisor.raise(fault::unplugged);
    gate.supervisor.disconnected();
    EXPECT_TRUE(zero(gate.step(push)));
    EXPECT_EQ(gate.supervisor.state(), DeviceState::disconnected);
    gate.supervisor.reconnected();
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle);
    EXPECT_EQ(gate.supervisor.faults(), 0u);
    gate.steps(1000, push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle);
}

TEST(States, PullingThePlugDoesNotResetAnotherFault) {
    Gate gate;
    gate.supervisor.raise(fault::speed);
    gate.supervisor.raise(fault::unplugged);
    gate.supervisor.disconnected();
    gate.supervisor.reconnected();
    EXPECT_EQ(gate.supervisor.state(), DeviceState::fault);
    EXPECT_EQ(gate.supervisor.faults(), fault::speed);
}

TEST(States, AStallBooksNoWorkForWhatTheHandDidMeanwhile) {
    Gate gate;
    gate.activate({0, 0, 3});
    gate.supervisor.hold();
    gate.position.z() += 0.1;  // 0.3 J, were the old force still there: 6 W over 50 ms, above the limit
    gate.steps(60, {0, 0, 3});
    EXPECT_EQ(gate.supervisor.state(), DeviceState::ramp_up);
    EXPECT_EQ(gate.supervisor.faults(), 0u);
}

TEST(States, AStallTakesTheGainAndGivesItBackByTheOrdinaryRamp) {
    Gate gate;
    gate.activate(push);
    gate.supervisor.hold();
    EXPECT_EQ(gate.supervisor.state(), DeviceState::ramp_up);
    for (int i = 1; i < 500; ++i) {
        gate.step(push);
        ASSERT_NEAR(gate.last.sent.force.z(), i / 500.0, 1e-9);
    }
    gate.step(push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);

    gate.supervisor.disarm();
    gate.steps(10, push);
    gate.supervisor.hold();
    gate.step(push);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle) << "a stall during the ramp down ends it";
    gate.supervisor.hold();
    EXPECT_EQ(gate.supervisor.state(), DeviceState::idle);
}

TEST(States, ACycleWithoutAPoseWritesZeroAndGoesOnFromZero) {
    Gate gate;
    gate.activate({0, 0, 5});
    EXPECT_TRUE(zero(gate.supervisor.cut(1, Gate::dt)));
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
    gate.step({0, 0, 5});
    EXPECT_NEAR(gate.last.sent.force.z(), 2, 1e-12) << "2000 N/s from zero";
}

}  // namespace
}  // namespace knurl::servo
