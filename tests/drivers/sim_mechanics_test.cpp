// The simulated device's mechanics and actuators against closed forms.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <knurl/drivers/sim_device.hpp>

namespace knurl::drivers::sim_mechanics_tests {
namespace {

using Eigen::Vector3d;

constexpr Nanoseconds millisecond = 1'000'000;
const std::string ideal = ",grip=0,coulomb=0,damping=0,lag=0,dac=0,quantum=0";

SimDevice make(const std::string& address) {
    return SimDevice(sim_profile(address));
}

/// Joint efforts equivalent to the force at the tip.
JointEfforts efforts_for(const SimDevice& device, const Vector3d& force) {
    TipPose pose;
    Jacobian jacobian;
    device.mechanism().forward(device.state().joints, pose, jacobian);
    JointEfforts efforts{};
    for (int i = 0; i < device.link().actuated_joints; ++i) {
        efforts[static_cast<std::size_t>(i)] = jacobian.block<3, 1>(0, i).dot(force);
    }
    return efforts;
}

/// Joint rates that move the tip like this, for three axes.
JointArray rates_for(const SimDevice& device, const JointArray& joints, const Vector3d& velocity) {
    TipPose pose;
    Jacobian jacobian;
    device.mechanism().forward(joints, pose, jacobian);
    const Vector3d rates = jacobian.topLeftCorner<3, 3>().inverse() * velocity;
    return {rates[0], rates[1], rates[2]};
}

/// Runs `seconds` with a constant force at the tip and a read every `period`.
void run(SimDevice& device, double seconds, Nanoseconds period, const Vector3d& force = Vector3d::Zero()) {
    JointSample sample;
    const auto cycles = std::llround(seconds * 1e9) / period;
    static_assert(SimDevice::max_catch_up > millisecond);
    const auto begin = std::llround(device.state().t * 1e9);
    device.read(begin, sample);
    for (std::int64_t i = 1; i <= cycles; ++i) {
        device.write(begin + (i - 1) * period, efforts_for(device, force));
        device.read(begin + i * period, sample);
    }
}

TEST(Mechanics, AFreeMassWithViscousDampingFollowsTheClosedForm) {
    // m v' = F - b v: v = F/b (1 - exp(-b t/m)). The integrator is of first order: half the sub-step, half
    // the error.
    constexpr double m = 0.1, b = 2, f = 0.15, t = 0.3;
    const double v = f / b * (1 - std::exp(-b * t / m));
    const double x = f / b * (t - m / b * (1 - std::exp(-b * t / m)));
    double error[2] = {};
    const Nanoseconds periods[2] = {millisecond, 50'000};
    for (int i = 0; i < 2; ++i) {
        SimDevice device = make("cartesian3,grip=0,coulomb=0,damping=2,lag=0,dac=0,quantum=0");
        run(device, t, periods[i], {0, f, 0});
        EXPECT_NEAR(device.state().velocity.y(), v, 1e-3 * v);
        error[i] = std::abs(device.state().position.y() - x);
        EXPECT_LT(error[i], 1e-3 * x);
    }
    EXPECT_NEAR(error[0] / error[1], 2, 0.05);
}

TEST(Mechanics, TheReferenceFiguresAreThoseOfTheTip) {
    // 0.15 kg with the finger, 200 N/m and 3 + 0.2 N s/m: a damped oscillation once let go from 10 mm.
    for (const std::string profile : {"cartesian3", "premium15"}) {
        SimDevice device = make(profile + ",coulomb=0,quantum=0");
        JointArray joints = device.profile().centre;
        joints[profile == "premium15" ? 2 : 0] += profile == "premium15" ? 0.01 / 0.170 : 0.01;
        device.place(joints);
        const Vector3d start = device.state().position;
        constexpr double m = 0.15, b = 3.2, k = 200, t = 0.1;
        run(device, t, millisecond);
        const double decay = b / (2 * m), w = std::sqrt(k / m - decay * decay);
        const double share = std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
        EXPECT_LT((device.state().position - share * start).norm(), 0.01 * start.norm()) << profile;
    }
}

TEST(Mechanics, ATipThatNothingHoldsMovesStraight) {
    // An arm whose mass is at its tip has Coriolis forces in its joints: at the tip there are none.
    double miss[2] = {};
    const Nanoseconds periods[2] = {100'000, 50'000};
    for (int i = 0; i < 2; ++i) {
        SimDevice device = make("premium15" + ideal);
        const JointArray centre = device.profile().centre;
        const Vector3d velocity(0.1, -0.15, 0.08);
        device.place(centre, rates_for(device, centre, velocity));
        run(device, 0.4, periods[i]);
        EXPECT_LT((device.state().velocity - velocity).norm(), 1e-12);
        miss[i] = (device.state().position - 0.4 * velocity).norm();
        EXPECT_LT(miss[i], 2e-5);
    }
    EXPECT_NEAR(miss[0] / miss[1], 2, 0.1) << "what is left is the integrator's first order";
}

TEST(Mechanics, AForceThroughTheJacobianIsThatForceAtTheTip) {
    for (const char* profile : {"cartesian3", "premium15"}) {
        SimDevice device = make(std::string(profile) + ideal);
        const Vector3d force(0.5, -0.3, 0.4);  // N on 0.1 kg
        run(device, 0.05, 100'000, force);
        EXPECT_LT((device.state().velocity - force / 0.1 * 0.05).norm(), 1e-4) << profile;
        EXPECT_LT((device.state().motor_force - force).norm(), 1e-3) << profile;
    }
}

TEST(Mechanics, EnergyNeverGrowsWithoutInput) {
    constexpr std::uint64_t seed = 42;
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> one(-1, 1);
    for (const std::string& profile : sim_profile_names()) {
        for (int trial = 0; trial < 20; ++trial) {
            SimProfile free = sim_profile(profile + ideal);
            free.rotational_damping = 0;
            SimDevice device(free);
            JointArray joints = device.profile().centre, rates{};
            for (std::size_t i = 0; i < static_cast<std::size_t>(device.link().sensed_joints); ++i) {
                const double metres = profile == "cartesian3" ? 0.1 : 1;  // a slide or a turn
                joints[i] += 0.1 * metres * one(engine);
                rates[i] = metres * one(engine);
            }
            device.place(joints, rates);
            double energy = device.state().kinetic_energy;
            const double at_start = energy;
            for (int i = 0; i < 100; ++i) {
                run(device, 0.001, 100'000);
                EXPECT_LE(device.state().kinetic_energy, energy + 1e-14 * at_start) << profile;
                energy = device.state().kinetic_energy;
            }
            EXPECT_GT(energy, 0.9 * at_start) << profile << ": nothing takes it away either";
        }
    }
}

TEST(Mechanics, WorkInIsKineticEnergyWhenNothingDissipates) {
    SimDevice device = make("cartesian3,coulomb=0,damping=0,lag=0,dac=0,quantum=0");
    run(device, 0.2, millisecond, {1, 0.5, -0.7});
    const SimState& state = device.state();
    EXPECT_GT(state.motor_work, 1e-3);
    EXPECT_NEAR(state.kinetic_energy, state.motor_work - state.energy_to_hand, 1e-15);
}

TEST(Mechanics, DryFrictionHoldsAgainstLessAndStopsWhatMoves) {
    SimDevice device = make("cartesian3,grip=0,damping=0,coulomb=0.05,lag=0,dac=0,quantum=0");
    run(device, 1, millisecond, {0.03, 0.03, 0});  // 0.042 N
    EXPECT_EQ(device.state().position.norm(), 0) << "it sticks";
    // Thrown at 0.1 m/s it stops after m v^2 / (2 f) = 10 mm, and stays.
    device.place({}, {0.1});
    run(device, 0.25, millisecond);
    EXPECT_NEAR(device.state().position.x(), 0.010, 1e-5);
    const Vector3d stopped = device.state().position;
    run(device, 0.5, millisecond);
    EXPECT_EQ(device.state().position, stopped);
    // A larger force moves it with the excess.
    device.place({});
    run(device, 0.1, millisecond, {0.15, 0, 0});
    EXPECT_NEAR(device.state().velocity.x(), (0.15 - 0.05) / 0.1 * 0.1, 1e-12);
}

TEST(Mechanics, StopsHoldTheTipNearTheWorkspace) {
    for (const std::string& profile : sim_profile_names()) {
        SimDevice device = make(profile + ",grip=0");
        run(device, 2, millisecond, {8, 0, 0});
        const double distance = device.state().position.norm();
        EXPECT_GT(distance, device.profile().stop_radius - 0.02) << profile;
        EXPECT_LT(distance, device.profile().stop_radius + 8.5 / 3000 + 0.001) << profile;
        EXPECT_LT(device.state().velocity.norm(), 0.02) << profile << ": at rest there";
    }
}

TEST(Mechanics, TheStopOfARowPushesAllJointsThatMoveIt) {
    // Row 3 is q3 - q2 and ends at 10 mm. 1 N on joint 3 presses it on; its stop hands that to joint 2, whose
    // own stop is at 0: each gives way by 1 N / 1000 N/m.
    SimProfile profile = sim_profile("cartesian3,grip=0,coulomb=0,lag=0,dac=0,quantum=0,damping=5");
    profile.coupling = Eigen::Matrix3d{{1, 0, 0}, {0, 1, 0}, {0, -1, 1}};
    profile.row_least[2] = -0.01;
    profile.row_greatest[2] = 0.01;
    profile.greatest[1] = 0;
    profile.joint_stop_stiffness = 1000;
    SimDevice device(profile);
    run(device, 3, millisecond, {0, 0, 1});
    EXPECT_NEAR(device.state().joints[1], 0.001, 1e-6);
    EXPECT_NEAR(device.state().joints[2], 0.001 + 0.01 + 0.001, 1e-6);
    EXPECT_EQ(device.state().joints[0], 0);
    EXPECT_EQ(device.link().joint_greatest[1], 0) << "and the servo is told of the joint's own";
}

TEST(Mechanics, GravityPullsTheDevicesMassAlone) {
    SimDevice device = make("cartesian3,gravity=9.81,coulomb=0");
    run(device, 3, millisecond);
    EXPECT_NEAR(device.state().position.z(), -0.1 * 9.81 / 200, 1e-5) << "hangs in the hand's spring";
}

/// The largest swing (m) of a tip that a hand lowers onto a wall of stiffness k at 1 kHz and presses there.
double swing_on_a_wall(const std::string& address, double k) {
    SimDevice device(sim_profile(address + ",push=1.5"),
                     parse_motion("0,0,0,0.005\n0.1,0,0,-0.002\n", "down"));
    JointSample sample;
    TipPose pose;
    Jacobian jacobian;
    device.read(0, sample);
    device.notify(Notice::claim_active);
    double lowest = 1, highest = -1;
    for (int i = 1; i < 4000; ++i) {
        device.read(i * millisecond, sample);
        device.mechanism().forward({sample.position.data(), 3}, pose, jacobian);
        const Vector3d force(0, 0, std::clamp(-k * pose.position.z(), 0.0, 8.5));
        const Vector3d efforts = jacobian.topLeftCorner<3, 3>().transpose() * force;
        device.write(i * millisecond, {efforts[0], efforts[1], efforts[2]});
        if (i > 2000) {
            lowest = std::min(lowest, device.state().position.z());
            highest = std::max(highest, device.state().position.z());
        }
    }
    return highest - lowest;
}

TEST(Mechanics, AWallBecomesUnstableWhereTheoryAndEarlierMeasurementsSay) {
    // Stable: a limit cycle below 0.1 mm. Without dry friction k < b/(T/2 + tau) (Colgate & Brown 1994, with
    // the lag), b = 0.2 + 3 of the hand; 0.05 N of friction lifts it to about 4500 N/m.
    const double bound = 3.2 / (0.5e-3 + 1 / (2 * std::numbers::pi * 300));
    for (const std::string profile : {"cartesian3", "premium15"}) {
        EXPECT_LT(swing_on_a_wall(profile + ",coulomb=0", 0.9 * bound), 1e-4) << profile;
        EXPECT_GT(swing_on_a_wall(profile + ",coulomb=0", 1.1 * bound), 1e-4) << profile;
        EXPECT_LT(swing_on_a_wall(profile, 0.9 * 4500), 1e-4) << profile;
        EXPECT_GT(swing_on_a_wall(profile, 1.1 * 4500), 1e-4) << profile;
    }
}

TEST(Actuator, LagsByFirstOrder) {
    SimDevice device = make("cartesian3,dac=0");
    JointSample sample;
    device.read(0, sample);
    device.write(0, {2});
    EXPECT_NEAR(device.link().lag, 1 / (2 * std::numbers::pi * 300), 1e-15);
    for (int i = 1; i <= 10; ++i) {
        device.read(i * Nanoseconds{300'000}, sample);
        const double t = i * 300e-6;
        EXPECT_NEAR(device.state().efforts[0], 2 * (1 - std::exp(-t / device.link().lag)), 1e-12);
    }
}

TEST(Actuator, ClipsEachMotorAndRoundsToTwelveBits) {
    SimDevice device = make("premium15,lag=0,grip=0");
    const double limit = device.link().effort_limit[1];
    JointSample sample;
    Nanoseconds now = 0;
    device.read(now, sample);
    for (const double ask : {1e9, limit * 1.0001, limit}) {
        device.write(now, {0, ask, -ask});
        device.read(now += 100'000, sample);
        EXPECT_EQ(device.state().efforts[1], limit);
        EXPECT_EQ(device.state().efforts[2], -device.link().effort_limit[2]);
        device.place(device.profile().centre);
    }
    const double step = limit / 2047;  // two's complement without its odd one
    for (const double ask : {0.4 * step, 0.6 * step, 100.3 * step, -7.7 * step}) {
        device.write(now, {0, ask});
        device.read(now += 100'000, sample);
        EXPECT_NEAR(device.state().efforts[1], std::nearbyint(ask / step) * step, 1e-15);
    }
}

TEST(Actuator, ReachesItsPeakForceAtTheTipInTheWholeWorkspace) {
    std::mt19937_64 engine(12);
    std::normal_distribution<double> one;
    const auto direction = [&] { return Vector3d(one(engine), one(engine), one(engine)).normalized(); };
    for (const char* name : {"cartesian3", "premium15"}) {
        for (int trial = 0; trial < 200; ++trial) {
            const SimProfile profile = sim_profile(name);
            // A hand that rests at the edge of the workspace puts the tip there.
            const SimDevice device(profile,
                                   Motion({{.t = 0, .position = profile.workspace_radius * direction()}}));
            const JointEfforts efforts = efforts_for(device, 8.5 * direction());
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_LE(std::abs(efforts[i]), device.link().effort_limit[i] * (1 + 1e-12))
                    << name << " joint " << i;
            }
        }
    }
}

TEST(Actuator, TakesWhatIsNotFiniteAsZero) {
    SimDevice device = make("cartesian3,lag=0");
    JointSample sample;
    device.read(0, sample);
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        EXPECT_TRUE(device.write(0, {1, bad, 0}));
    }
    device.read(millisecond, sample);
    EXPECT_EQ(device.state().refused_efforts, 3U);
    EXPECT_EQ(device.state().efforts[0], 0);
    EXPECT_EQ(device.state().position.norm(), 0);
}

TEST(Actuator, WatchdogSwitchesOffAfterSilenceAndOnWithTheNextWrite) {
    SimDevice device = make("cartesian3,lag=0,dac=0,watchdog=0.02");
    EXPECT_TRUE(device.link().has_watchdog);
    JointSample sample;
    device.read(0, sample);
    device.write(0, {1});
    device.read(20 * millisecond, sample);
    EXPECT_EQ(device.state().efforts[0], 1);
    device.read(21 * millisecond, sample);
    EXPECT_EQ(device.state().efforts[0], 0);
    EXPECT_EQ(device.state().watchdog_trips, 1U);
    device.write(21 * millisecond, {1});
    device.read(22 * millisecond, sample);
    EXPECT_EQ(device.state().efforts[0], 1);
}

}  // namespace
}  // namespace knurl::drivers::sim_mechanics_tests
