// The output stage, stage by stage, against closed forms.

#include <cmath>
#include <limits>
#include <random>

#include "core_gate.hpp"

namespace knurl::servo::core_stages_tests {
namespace {

using namespace testing;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// ------------------------------------------------------------------------------------------- 1: finite

TEST(Stages, AWrenchThatIsNotFiniteIsZeroAndAFault) {
    for (const double bad : {nan, infinity, -infinity}) {
        Gate gate;
        gate.activate();
        EXPECT_TRUE(zero(gate.step({0, bad, 0})));
        EXPECT_EQ(gate.supervisor.state(), DeviceState::fault);
        EXPECT_EQ(gate.supervisor.faults(), fault::not_finite);

        Gate turning;
        turning.activate();
        EXPECT_TRUE(zero(turning.step({0, 0, 0}, {bad, 0, 0})));
        EXPECT_EQ(turning.supervisor.faults(), fault::not_finite);
    }
}

TEST(Stages, APoseOrAJacobianThatIsNotFiniteNeverReachesTheMotors) {
    Gate gate;
    gate.activate({0, 0, 1});
    gate.jacobian(2, 2) = nan;
    EXPECT_TRUE(zero(gate.step({0, 0, 1})));
    EXPECT_EQ(gate.supervisor.faults(), fault::kinematics);

    Gate fast;
    fast.activate({0, 0, 1});
    fast.velocity.x() = nan;
    EXPECT_TRUE(zero(fast.step({0, 0, 1})));
    EXPECT_EQ(fast.supervisor.state(), DeviceState::fault);
}

// ---------------------------------------------------------------------------------------- 1: workspace

TEST(Stages, BeyondTheWorkspaceMarginNothingPushesOutwards) {
    Gate gate;
    gate.activate({1, 1, 0});
    gate.position = {0.126, 0, 0};  // 1.25 x 0.1 m and a little
    gate.step({1, 1, 0});
    EXPECT_EQ(gate.last.sent.force.x(), 0);
    EXPECT_EQ(gate.last.sent.force.y(), 1) << "along the edge it may";
    gate.step({-1, 0, 0});
    EXPECT_EQ(gate.last.sent.force.x(), -1) << "and inwards";
    gate.position = {0.119, 0, 0};
    gate.step({1, 0, 0});
    EXPECT_EQ(gate.last.sent.force.x(), 1);
}

TEST(Stages, TheWorkspaceEdgeIsNoStep) {
    Gate gate;
    gate.activate({1, 0, 0});
    double last = 1;
    for (double x = 0.11; x < 0.13; x += 1e-5) {
        gate.position = {x, 0, 0};
        gate.supervisor.supervise({{1, 0, 0}, {}}, gate.position, {0, 0, 0}, gate.jacobian, 3, 1, Gate::dt);
        const double force = gate.step({1, 0, 0}).sent.force.x();
        EXPECT_NEAR(force, last, 1e-5 / 5e-3 + 1e-9);
        last = force;
    }
    EXPECT_EQ(last, 0);
}

// ------------------------------------------------------------------------------------------- 1: speed

TEST(Stages, DampingComesInAboveOneMetrePerSecond) {
    Gate gate;
    gate.activate();
    gate.velocity = {1.0, 0, 0};
    EXPECT_TRUE(gate.step().sent.force.isZero(0));
    gate.velocity = {0, 1.2, 0};
    // b = 5 N s/m per m/s above 1 = 1 N s/m, at 1.2 m/s
    EXPECT_NEAR(gate.step().sent.force.y(), -1.2, 1e-12);
}

TEST(Stages, SpeedDampingIsBoundedByTheDevicesOwnStability) {
    SupervisorLimits limits;
    limits.speed_damping = 1000;
    limits.slew = 1e9;
    Gate gate(limits);
    gate.activate();
    gate.velocity = {1.4, 0, 0};
    // m/(4 (T + tau + 1/(2 pi 100 Hz)))
    const double cap = 0.15 / (4 * (1e-3 + 0.53e-3 + 1 / (200 * M_PI)));
    EXPECT_NEAR(gate.step().sent.force.x(), -std::min(10.0, cap * 1.4), 1e-9);
    EXPECT_LT(cap * 1.4, 20.0);
}

TEST(Stages, AHandAboveTheSpeedLimitFaultsWhileThereIsForce) {
    Gate gate;
    gate.activate();
    gate.velocity = {1.5, 0, 0};
    gate.step();
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
    gate.velocity = {1.51, 0, 0};
    EXPECT_TRUE(zero(gate.step()));
    EXPECT_EQ(gate.supervisor.faults(), fault::speed);

    Gate free;
    free.velocity = {3, 0, 0};
    free.step();
    EXPECT_EQ(free.supervisor.state(), DeviceState::idle) << "a hand may be quick while nothing pushes it";
}

// ------------------------------------------------------------------------------- 1: power, 2: energy

/// Moves with the force at the speed for this power (W) for `cycles`; returns the cycles until the fault.
int cycles_at_power(double power, int cycles) {
    SupervisorLimits limits;
    limits.slew = 1e6;
    PuppetDevice device;
    device.link_.workspace_radius = 100;
    Gate gate(limits, device);
    gate.activate({8, 0, 0});
    for (int i = 0; i < cycles; ++i) {
        gate.position.x() += power / 8 * Gate::dt;
        gate.step({8, 0, 0});
        if (gate.supervisor.faults() == fault::power) return i;
    }
    return cycles;
}

TEST(Stages, MeanPowerIntoTheHandAboveFiveWattsFaults) {
    EXPECT_EQ(cycles_at_power(4.95, 2000), 2000);
    EXPECT_NEAR(cycles_at_power(5.2, 2000), 50, 2) << "a full window";
    // At 10 W half a window is enough: 10 W * 25 ms = 5 W * 50 ms.
    EXPECT_NEAR(cycles_at_power(10, 2000), 25, 3);
}

TEST(Stages, PowerOutOfTheHandIsFree) {
    EXPECT_EQ(cycles_at_power(-8, 1000), 1000);
}

TEST(Stages, TheObserverCountsTheWorkDoneOnTheHandSinceContactBegan) {
    Gate gate;
    gate.activate({2, 0, 0});
    EXPECT_EQ(gate.supervisor.counts().generated_energy, 0);
    gate.position.x() -= 1e-3;  // the hand pushes in: it pays 2 mJ
    gate.step({2, 0, 0});
    EXPECT_EQ(gate.supervisor.counts().generated_energy, 0);
    gate.position.x() += 3e-3;  // and gets 6 mJ
    gate.step({2, 0, 0});
    EXPECT_NEAR(gate.supervisor.counts().generated_energy, 4e-3, 1e-12);
    gate.step({0, 0, 0});
    gate.step({0, 0, 0});
    EXPECT_EQ(gate.supervisor.counts().generated_energy, 0) << "out of contact";
}

// -------------------------------------------------------------------------------------------- 3: slew

TEST(Stages, TheSlewGateClipsAndCounts) {
    Gate gate;
    gate.activate();
    EXPECT_NEAR(gate.step({5, 0, 0}).sent.force.x(), 2, 1e-12);  // 2000 N/s
    EXPECT_NE(gate.last.flags & report_flags::clamped, 0u);
    EXPECT_NEAR(gate.step({5, 0, 0}).sent.force.x(), 4, 1e-12);
    EXPECT_NEAR(gate.step({5, 0, 0}).sent.force.x(), 5, 1e-12);
    EXPECT_EQ(gate.last.flags & report_flags::clamped, 0u);
    EXPECT_EQ(gate.supervisor.counts().slew_clips, 2u);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
}

TEST(Stages, ExactlyTheSlewLimitIsNoClip) {
    Gate gate;
    gate.activate();
    for (int i = 1; i <= 4; ++i) gate.step({2.0 * i, 0, 0});
    EXPECT_EQ(gate.supervisor.counts().slew_clips, 0u);
}

TEST(Stages, MoreThanFiveMillisecondsOfClippingInARowFault) {
    Gate gate;
    gate.activate();
    for (int i = 0; i < 5; ++i) gate.step({9.9 * (i % 2 == 0 ? 1 : -1), 0, 0});
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
    EXPECT_TRUE(zero(gate.step({-9.9, 0, 0})));
    EXPECT_EQ(gate.supervisor.faults(), fault::slew);
}

TEST(Stages, ACycleBelowTheGateForgivesTheClipsBefore) {
    Gate gate;
    gate.activate();
    for (int round = 0; round < 20; ++round) {
        for (int i = 0; i < 4; ++i) gate.step({round % 2 == 0 ? 9.0 : 0.0, 0, 0});
        gate.step({round % 2 == 0 ? 9.0 : 0.0, 0, 0});
        gate.step({round % 2 == 0 ? 9.0 : 0.0, 0, 0});
    }
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
    EXPECT_GT(gate.supervisor.counts().slew_clips, 20u);
}

TEST(Stages, AFullStepOfADesktopDeviceWithinOneCycleDoesNotFault) {
    PuppetDevice device;
    device.link_.peak_force = 8.5;
    Gate gate({}, device);
    gate.activate();
    gate.steps(10, {8.5, 0, 0});  // 4.25 ms at 2000 N/s
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
    EXPECT_EQ(gate.last.sent.force.x(), 8.5);
}

// ----------------------------------------------------------------------------------- 4: norm, thermal

TEST(Stages, TheNormClampKeepsTheDirection) {
    SupervisorLimits limits;
    limits.slew = 1e9;
    Gate gate(limits);
    gate.activate();
    gate.step({30, 40, 0});
    EXPECT_NEAR(gate.last.sent.force.x(), 6, 1e-12);
    EXPECT_NEAR(gate.last.sent.force.y(), 8, 1e-12);
    EXPECT_EQ(gate.supervisor.counts().force_clamps, 1u);
    EXPECT_NE(gate.last.flags & report_flags::clamped, 0u);
}

TEST(Stages, ConfigurationMayOnlyTightenWhatTheDeviceStates) {
    SupervisorLimits limits;
    limits.peak_force = 4;
    EXPECT_EQ(Gate(limits).supervisor.peak_force(), 4);
    limits.peak_force = 40;
    EXPECT_EQ(Gate(limits).supervisor.peak_force(), 10);
    limits.peak_force = 0;
    EXPECT_EQ(Gate(limits).supervisor.peak_force(), 10);
}

TEST(Stages, AColdMotorGivesItsPeakForAboutTheThermalTimeAndThenTheContinuousForce) {
    // Closed form: heat = P^2 (1 - exp(-t/tau)), P = peak/continuous = 2, tau from heat(10 s) = 1; full force
    // until heat = 0.9.
    const ThermalLimit model(10, 5, 10);
    const double tau = model.time_constant();
    EXPECT_NEAR(4 * (1 - std::exp(-10 / tau)), 1, 1e-12);
    const double full_until = -tau * std::log1p(-0.9 / 4);

    Gate gate;
    gate.activate({10, 0, 0});
    // The ramp up has warmed it a little: its heat by the same law, (i/500)^2 P^2.
    double heat = 0;
    for (int i = 1; i <= 500; ++i) heat += (1 - std::exp(-Gate::dt / tau)) * (4.0 * i * i / 250'000 - heat);
    const double remaining = -tau * std::log((4 - 0.9) / (4 - heat));
    EXPECT_LT(remaining, full_until);
    int full = 0;
    while (gate.step({10, 0, 0}).sent.force.x() == 10.0 && full < 20'000) ++full;
    EXPECT_NEAR(full * Gate::dt, remaining, 0.002);

    gate.steps(300'000, {10, 0, 0});
    EXPECT_NEAR(gate.last.sent.force.x(), 5, 0.05);
    EXPECT_GT(gate.supervisor.counts().thermal_clamps, 0u);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
}

TEST(Stages, TheContinuousForceIsForEver) {
    Gate gate;
    gate.activate({5, 0, 0});
    for (int i = 0; i < 200'000; ++i) gate.step({5, 0, 0});
    EXPECT_NEAR(gate.last.sent.force.x(), 5, 0.02);
}

// --------------------------------------------------------------------------------- 4: J^T, joint clamp

TEST(Stages, EffortsAreTheTransposeOfTheJacobianTimesTheWrench) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 100; ++round) {
        Gate gate({}, PuppetDevice(6));
        gate.activate();
        gate.jacobian = drivers::Jacobian::NullaryExpr([&] { return uniform(random); });
        gate.jacobian.rightCols<2>().setZero();
        const Eigen::Vector3d force(uniform(random), uniform(random), uniform(random));
        const Eigen::Vector3d torque(0.01 * uniform(random), 0.01 * uniform(random), 0.01 * uniform(random));
        gate.step(force, torque);
        // Virtual work: for every joint motion, effort . dq = force . dx + torque . dtheta.
        for (int joint = 0; joint < 8; ++joint) {
            long double work = 0;
            for (int k = 0; k < 3; ++k) {
                work += static_cast<long double>(force[k]) * gate.jacobian(k, joint);
                work += static_cast<long double>(torque[k]) * gate.jacobian(k + 3, joint);
            }
            EXPECT_NEAR(gate.last.efforts[static_cast<std::size_t>(joint)], static_cast<double>(work), 1e-14);
        }
    }
}

TEST(Stages, AJointAtItsLimitScalesAllJointsTogether) {
    PuppetDevice device;
    device.link_.effort_limit = {1.0, 100, 100};
    Gate gate({}, device);
    gate.activate();
    gate.steps(4, {2, 1, -1});
    EXPECT_NEAR(gate.last.efforts[0], 1, 1e-12);
    EXPECT_NEAR(gate.last.efforts[1], 0.5, 1e-12);
    EXPECT_NEAR(gate.last.efforts[2], -0.5, 1e-12);
    EXPECT_TRUE(gate.last.sent.force.isApprox(Eigen::Vector3d(1, 0.5, -0.5), 1e-12));
    EXPECT_EQ(gate.supervisor.counts().joint_clamps, 4u);
}

TEST(Stages, ADeviceWithoutTorqueGetsNone) {
    Gate gate;
    gate.activate();
    gate.step({0, 0, 1}, {1, 1, 1});
    for (std::size_t i = 3; i < 8; ++i) EXPECT_EQ(gate.last.efforts[i], 0);
    EXPECT_TRUE(gate.last.sent.torque.isZero(0));
}

TEST(Stages, PassiveJointsGetNoEffort) {
    PuppetDevice device(6);
    device.link_.actuated_joints = 3;
    Gate gate({}, device);
    gate.activate();
    gate.jacobian(0, 5) = 1;
    gate.step({1, 1, 1});
    for (std::size_t i = 3; i < 8; ++i) EXPECT_EQ(gate.last.efforts[i], 0);
}

// -------------------------------------------------------------------------------------------- whole

TEST(Stages, WhateverComesInWhatGoesOutIsFiniteAndBounded) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> exponent(-320, 320), uniform(-1, 1);
        Gate gate({}, PuppetDevice(6));
        gate.supervisor.arm(true, 0);
        double last_force = 0;
        const auto number = [&] {
            const auto kind = random() % 16;
            return kind == 0   ? nan
                   : kind == 1 ? infinity
                   : kind < 5  ? uniform(random) * std::pow(10, exponent(random))
                               : 10 * uniform(random);
        };
        for (int i = 0; i < 20'000; ++i) {
            if (gate.supervisor.state() == DeviceState::fault) {
                gate.supervisor.reset_fault(0);
                gate.supervisor.arm(true, 0);
                last_force = 0;
            }
            const bool wild = random() % 64 == 0;
            gate.position = 0.1 * Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
            gate.velocity = wild ? Eigen::Vector3d(number(), number(), number()) : Eigen::Vector3d::Zero();
            gate.step(wild ? Eigen::Vector3d(number(), number(), number()) : Eigen::Vector3d(3, 2, 1),
                      wild ? Eigen::Vector3d(number(), number(), number()) : Eigen::Vector3d::Zero());
            for (const double effort : gate.last.efforts) {
                ASSERT_TRUE(std::isfinite(effort)) << "cycle " << i;
                ASSERT_LE(std::abs(effort), 1000);
            }
            const double force = gate.last.sent.force.norm();
            ASSERT_LE(force, 10 * (1 + 1e-12));
            ASSERT_LE(gate.last.sent.torque.norm(), 0.5 * (1 + 1e-12));
            ASSERT_LE(force, last_force + 2 + 1e-9) << "a rise faster than the slew gate, cycle " << i;
            last_force = force;
        }
    }
}

TEST(Stages, SwitchedOffOnlyTheJacobianIsLeft) {
    SupervisorLimits limits;
    limits.off = true;
    Gate gate(limits);
    gate.supervisor.start_active();
    gate.velocity = {100, 0, 0};
    gate.step({1e6, 0, 0}, {0, 0, 5});
    EXPECT_EQ(gate.last.sent.force.x(), 1e6);
    EXPECT_EQ(gate.last.efforts[0], 1e6);
    EXPECT_EQ(gate.last.efforts[5], 5);
    EXPECT_EQ(gate.supervisor.state(), DeviceState::active);
}

}  // namespace
}  // namespace knurl::servo::core_stages_tests
