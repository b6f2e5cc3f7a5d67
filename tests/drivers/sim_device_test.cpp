// The simulated device as a device: its clock, encoders, faults, address and description.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include <knurl/drivers/sim_device.hpp>

#include "../refusal.hpp"

namespace knurl::drivers {
namespace {

using Eigen::Vector3d;

constexpr Nanoseconds millisecond = 1'000'000;

std::string refusal(const std::string& address) {
    return test::refusal_of([&] { open_device(address); });
}

/// A small servo: a wall and some random efforts, run for a while.
std::uint64_t digest_of_a_run(const std::string& address, Nanoseconds begin, Nanoseconds period) {
    SimDevice device(sim_profile(address), parse_motion("0,0,0,0.01\n1,0.05,0,-0.01\n", "m"));
    std::mt19937_64 engine(1);
    JointSample sample;
    device.notify(Notice::claim_active);
    for (int i = 0; i < 1500; ++i) {
        const Nanoseconds now = begin + i * period;
        device.read(now, sample);
        TipPose pose;
        Jacobian jacobian;
        device.mechanism().forward(sample.position, pose, jacobian);
        const Vector3d force(0, 1e-20 * static_cast<double>(engine() >> 1),
                             std::max(0.0, -2000 * pose.position.z()));
        JointEfforts efforts{};
        for (int joint = 0; joint < device.link().actuated_joints; ++joint) {
            efforts[static_cast<std::size_t>(joint)] = jacobian.block<3, 1>(0, joint).dot(force);
        }
        device.write(now, efforts);
    }
    return device.digest();
}

TEST(SimClock, TheSameCallsGiveTheSameBits) {
    for (const std::string& profile : sim_profile_names()) {
        const std::string address = profile + ",tremor=0.2";
        const auto once = digest_of_a_run(address, 0, millisecond);
        EXPECT_EQ(digest_of_a_run(address, 0, millisecond), once);
        EXPECT_EQ(digest_of_a_run(address, 123'456'789'012'345, millisecond), once)
            << "wherever the clock begins: virtual and wall clock are the same code";
        EXPECT_NE(digest_of_a_run(address, 0, millisecond + 1), once);
        EXPECT_NE(digest_of_a_run(address + ",quantum=0", 0, millisecond), once);
    }
}

TEST(SimClock, SubStepsAreAtMostAHundredMicroseconds) {
    // A read after 1 ms equals ten reads of 100 us; one of 50 us differs by the integrator's order.
    const auto position = [](Nanoseconds period) {
        SimDevice device(sim_profile("cartesian3,coulomb=0"));
        device.place({0.01});
        JointSample sample;
        for (Nanoseconds now = 0; now <= 40 * millisecond; now += period) {
            device.read(now, sample);
        }
        return device.state().position.x();
    };
    EXPECT_NEAR(position(millisecond), position(100'000), 1e-15);
    EXPECT_NEAR(position(2 * millisecond), position(100'000), 1e-15);
    EXPECT_GT(std::abs(position(millisecond) - position(50'000)), 1e-7);
}

TEST(SimClock, CatchesUpFiftyMillisecondsAndCountsTheRest) {
    SimDevice device(sim_profile("cartesian3"));
    JointSample sample;
    device.read(5, sample);
    device.read(5 + 50 * millisecond, sample);
    EXPECT_NEAR(device.state().t, 0.050, 1e-15);
    EXPECT_EQ(device.state().skipped, 0);
    device.read(5 + 10'000 * millisecond, sample);
    EXPECT_NEAR(device.state().t, 0.100, 1e-15);
    EXPECT_EQ(device.state().skipped, 9'900 * millisecond);
    device.read(0, sample);  // a clock that goes back: no time passes
    device.read(5 + 10'000 * millisecond, sample);
    EXPECT_NEAR(device.state().t, 0.100, 1e-15);
}

TEST(SimEncoders, CountInThirtyMicrometresAtTheTip) {
    for (const std::string profile : {"cartesian3", "premium15"}) {
        SimDevice device(sim_profile(profile));
        TipPose pose;
        Jacobian jacobian;
        device.mechanism().forward(device.profile().centre, pose, jacobian);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto column = static_cast<Eigen::Index>(i);
            EXPECT_NEAR(device.link().radians_per_count[i] * jacobian.col(column).head<3>().norm(), 30e-6,
                        1e-15);
        }
        std::mt19937_64 engine(4);
        std::uniform_real_distribution<double> one(-0.05, 0.05);
        Nanoseconds now = 0;
        for (int trial = 0; trial < 1000; ++trial) {
            JointArray joints = device.profile().centre;
            for (std::size_t i = 0; i < 3; ++i) {
                joints[i] += one(engine);
            }
            device.place(joints);
            JointSample sample;
            device.read(now, sample);
            for (std::size_t i = 0; i < 3; ++i) {
                const double count = device.link().radians_per_count[i];
                EXPECT_LE(std::abs(sample.position[i] - device.state().joints[i]), 0.5 * count * (1 + 1e-9));
                EXPECT_NEAR(std::remainder(sample.position[i], count), 0, 1e-12);
            }
        }
    }
    SimDevice continuous(sim_profile("premium15,quantum=0"));
    JointSample sample;
    continuous.read(0, sample);
    EXPECT_EQ(continuous.link().radians_per_count[0], 0);
    EXPECT_EQ(sample.position[1], continuous.state().joints[1]);
}

TEST(SimLink, StatesTheFiguresThatStabilityIsReckonedWith) {
    for (const char* address : {"sim:cartesian3", "sim:premium15"}) {
        const auto device = open_device(address);
        const LinkConfig& link = device->link();
        EXPECT_EQ(link.name, std::string(address).substr(4));
        EXPECT_EQ(link.damping, 0.2);
        EXPECT_NEAR(link.lag, 0.53e-3, 1e-5);
        EXPECT_EQ(link.grip_damping, 3);
        EXPECT_EQ(link.peak_force, 8.5);
        EXPECT_EQ(link.measured_max_stiffness, 0) << "not measured: the servo estimates it";
        EXPECT_EQ(link.sensed_joints, 3);
        EXPECT_FALSE(link.senses_orientation);
        EXPECT_FALSE(link.renders_torque);
    }
    const auto six = open_device("sim:generic6");
    EXPECT_EQ(six->link().actuated_joints, 6);
    EXPECT_TRUE(six->link().senses_orientation);
    EXPECT_TRUE(six->link().renders_torque);
    EXPECT_GT(six->link().peak_torque, 0);
    EXPECT_NE(six->link().description.find("invented"), std::string::npos);
}

TEST(SimProfiles, ReachTheirWholeWorkspaceWithoutASingularPosture) {
    for (const std::string& name : sim_profile_names()) {
        std::mt19937_64 engine(6);
        std::normal_distribution<double> one;
        for (int trial = 0; trial < 100; ++trial) {
            const Vector3d way = Vector3d(one(engine), one(engine), one(engine)).normalized();
            const SimProfile profile = sim_profile(name);
            const Vector3d edge = profile.workspace_radius * way;
            const SimDevice device(profile, Motion({{.t = 0, .position = edge}}));
            EXPECT_LT((device.state().position - edge).norm(), 1e-9);
            TipPose pose;
            Jacobian jacobian;
            ASSERT_TRUE(profile.mechanism->forward(device.state().joints, pose, jacobian));
            const auto j = jacobian.topRows<3>();
            const double volume = std::sqrt((j * j.transpose()).determinant());
            EXPECT_GT(volume, 0.1 * std::pow(j.norm() / std::sqrt(3.0), 3) * 0.5) << name;
        }
    }
}

TEST(SimAddress, SaysWhatItDoesNotKnow) {
    EXPECT_EQ(refusal("sim:premium16"),
              "no simulated device \"premium16\"; there are cartesian3, premium15, falcon, generic6, "
              "generic7, omni, "
              "premium15_wrist, woodenhaptics, and arm=FILE.toml; did you mean 'premium15'?");
    EXPECT_EQ(refusal("sim:cartesian3,grip=1.5"),
              "simulated device \"cartesian3,grip=1.5\": cannot use \"grip=1.5\"; give grip=0..1");
    EXPECT_EQ(refusal("sim:cartesian3,lag=300Hz"),
              "simulated device \"cartesian3,lag=300Hz\": cannot use \"lag=300Hz\"; give lag=0|10..20000 Hz");
    for (const char* bad : {"sim:cartesian3,grip", "sim:cartesian3,grip=", "sim:cartesian3,grip=nan",
                            "sim:cartesian3,quantum=1", "sim:cartesian3,dac=1", "sim:cartesian3,mass=0"}) {
        EXPECT_NE(refusal(bad).find("cannot use"), std::string::npos) << bad;
    }
    EXPECT_NE(refusal("sim:cartesian3,").find("no option \"\"; there are grip, hand,"), std::string::npos);
    EXPECT_NE(refusal("sim:cartesian3,stiffness=3").find("no option \"stiffness\""), std::string::npos);
    EXPECT_NE(refusal("omega:0").find("no device \"omega:0\"; write one of sim:cartesian3"),
              std::string::npos);
    EXPECT_NE(refusal("premium15").find("write one of sim:"), std::string::npos);
    EXPECT_NE(refusal("").find("write one of sim:"), std::string::npos);
}

TEST(SimAddress, TakesOptionsAndThePushSoftensTheHandAlongIt) {
    const SimProfile p = sim_profile("premium15,grip=0.5,tremor=0.2,seed=7,quantum=0,lag=100,push=1.5");
    EXPECT_EQ(p.hand.grip, 0.5);
    EXPECT_EQ(p.hand.tremor, 0.2);
    EXPECT_EQ(p.seed, 7U);
    EXPECT_EQ(p.quantum, 0);
    EXPECT_EQ(p.lag, 100);
    EXPECT_EQ(p.hand.normal_stiffness, 60);
    EXPECT_EQ(p.hand.stiffness, 200);
    EXPECT_EQ(sim_profile("premium15,hand=400").hand.normal_stiffness, 400) << "alike in all directions";
    EXPECT_EQ(sim_profile("premium15,hand_normal=80,push=1").hand.normal_stiffness, 80);
    const std::string help = sim_option_help();
    for (const char* option : {"grip=0..1", "push=0..10 N", "lag=0|10..20000 Hz"}) {
        EXPECT_NE(help.find(option), std::string::npos) << option;
    }
}

TEST(SimAddress, HandFileThatIsMissingOrOutOfReachIsRefused) {
    OpenOptions options;
    options.hand_file = "/nonexistent/stroke.csv";
    EXPECT_THROW(open_device("sim:premium15", options), std::runtime_error);
    try {
        SimDevice device(sim_profile("premium15"), parse_motion("0,0.5,0,0\n", "far"));
        FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(
            error.what(),
            "premium15 cannot reach the start of the hand's motion, 0.500000,0.000000,0.000000 m; keep it "
            "within 0.100000 m of the origin");
    }
}

/// Reads n times; the statuses as letters.
std::string statuses(SimDevice& device, int n, std::vector<JointSample>* samples = nullptr) {
    std::string letters;
    for (int i = 0; i < n; ++i) {
        JointSample sample;
        letters += "osbu"[static_cast<std::size_t>(
            device.read(static_cast<Nanoseconds>(device.state().reads) * millisecond, sample))];
        if (samples != nullptr) {
            samples->push_back(sample);
        }
    }
    return letters;
}

TEST(SimFaults, ComeAtTheReadThatWasAskedFor) {
    SimDevice device(sim_profile("cartesian3"));
    device.faults() = {.stale_at = 2, .stale_reads = 2, .bad_at = 5, .bad_reads = 1};
    EXPECT_EQ(statuses(device, 8),
              "oossobo"
              "o");

    SimDevice jumping(sim_profile("cartesian3"));
    jumping.faults() = {
        .nan_at = 1, .jump_at = 3, .jump_joint = 2, .jump = 0.25, .unhomed_at = 5, .unhomed_reads = 2};
    std::vector<JointSample> samples;
    EXPECT_EQ(statuses(jumping, 8, &samples), "oooooooo");
    EXPECT_TRUE(std::isnan(samples[1].position[0]));
    EXPECT_EQ(samples[2].position[0], 0);
    EXPECT_EQ(samples[3].position[2], 0.25);
    EXPECT_EQ(samples[4].position[2], 0);
    EXPECT_TRUE(samples[4].calibrated);
    EXPECT_FALSE(samples[5].calibrated);
    EXPECT_FALSE(samples[6].calibrated);
    EXPECT_TRUE(samples[7].calibrated);
}

TEST(SimFaults, UnpluggedMotorsAreOffUntilItIsPluggedAndWrittenAgain) {
    SimDevice device(sim_profile("cartesian3,lag=0,dac=0"));
    device.faults() = {.unplug_at = 3, .replug_at = 6};
    EXPECT_EQ(statuses(device, 3), "ooo");
    EXPECT_TRUE(device.write(0, {1}));
    EXPECT_EQ(statuses(device, 1), "u");
    EXPECT_EQ(device.state().efforts[0], 1) << "the read that found it gone still had its force";
    EXPECT_FALSE(device.write(0, {1}));
    EXPECT_EQ(statuses(device, 2), "uu");
    EXPECT_EQ(device.state().efforts[0], 0);
    EXPECT_EQ(statuses(device, 1), "o");
    EXPECT_EQ(device.state().efforts[0], 0) << "never by itself";
    EXPECT_TRUE(device.write(0, {1}));
}

TEST(SimOracles, CountPeakForceAndWorkOnTheHand) {
    SimDevice device(sim_profile("premium15"));
    JointSample sample;
    TipPose pose;
    Jacobian jacobian;
    for (int i = 0; i < 1000; ++i) {
        device.read(i * millisecond, sample);
        device.mechanism().forward(sample.position, pose, jacobian);
        const Vector3d force(i < 500 ? 3.0 : 0.0, 0, 0);
        const Vector3d efforts = jacobian.topLeftCorner<3, 3>().transpose() * force;
        device.write(i * millisecond, {efforts[0], efforts[1], efforts[2]});
    }
    const SimState& state = device.state();
    EXPECT_NEAR(state.peak_motor_force, 3, 0.02);
    // The motors stretched the hand's spring and released it: the hand dissipated what it received (it cannot
    // be more).
    EXPECT_GT(state.motor_work, 0);
    EXPECT_GT(state.energy_to_hand, 0);
    EXPECT_LT(state.energy_to_hand, state.motor_work);
}

}  // namespace
}  // namespace knurl::drivers
