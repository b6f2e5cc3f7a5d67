// `knurl device test`: measures a device, and finds what differs from its description.

#include "../../apps/knurl/device_trial.hpp"

#include <atomic>
#include <csignal>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/sim_profile.hpp>
#include <knurl/json/json.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using cli::Trial;
using testing::Contains;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A simulated device without a hand, with faults.
class Broken final : public drivers::Device {
  public:
    double effort = 1;                       // ratio of the motors' effort to the command
    double last_effort = 1;                  // ... of the last motor's
    double moves_back = 1;                   // -1: joint 0's encoder counts the wrong way
    std::uint64_t stale = 0;                 // one of so many samples is missing; 0: none
    bool exerts = false, exerted = false;    // at present; at any time
    drivers::Nanoseconds answers_after = 0;  // ns, after each order and only then; 0: at any time

    explicit Broken(const std::string& options = "", const std::string& arm = "cartesian3")
        : inner_(drivers::open_device("sim:" + arm + ",grip=0,coulomb=0" + options)) {}
    const drivers::LinkConfig& link() const noexcept override { return inner_->link(); }
    const drivers::Mechanism& mechanism() const noexcept override { return inner_->mechanism(); }
    drivers::ReadStatus read(drivers::Nanoseconds now, drivers::JointSample& sample) noexcept override {
        const drivers::ReadStatus status = inner_->read(now, sample);
        sample.position[0] *= moves_back;
        if (answers_after != 0 && now - ordered_ < answers_after) return drivers::ReadStatus::stale;
        return stale != 0 && ++reads_ % stale == 0 ? drivers::ReadStatus::stale : status;
    }
    bool write(drivers::Nanoseconds now, const drivers::JointEfforts& efforts) noexcept override {
        ordered_ = now;
        exerts = efforts != drivers::JointEfforts{};
        exerted |= exerts;
        drivers::JointEfforts made = efforts;
        for (double& e : made) e *= effort;
        made[static_cast<std::size_t>(link().actuated_joints - 1)] *= last_effort;
        return inner_->write(now, made);
    }
    void make_safe() noexcept override {}

  private:
    std::unique_ptr<drivers::Device> inner_;
    std::uint64_t reads_ = 0;
    drivers::Nanoseconds ordered_ = 0;
};

Trial tried(drivers::Device& device) {
    return cli::try_device(device, {.virtual_time = true}, [](const std::string&) {});
}

TEST(DeviceTest, FindsMassFrictionDelayAndStiffestWall) {
    for (const double damping : {0.2, 1.0}) {
        Broken device(fmt::format(",damping={}", damping));
        const Trial trial = tried(device);
        EXPECT_THAT(cli::findings(trial), IsEmpty());
        EXPECT_EQ(trial.rest.sample_rate, 1000);
        for (const cli::PushTrial& push : trial.pushes) {
            EXPECT_NEAR(push.cosine, 1, 1e-3);
            EXPECT_NEAR(push.mass, device.link().apparent_mass, 0.05 * device.link().apparent_mass);
            EXPECT_NEAR(push.delay, device.link().lag, 0.5e-3);
            EXPECT_LT(push.friction, 0.02);
        }
        EXPECT_NEAR(trial.wall.stiffness, trial.wall.predicted, 0.15 * trial.wall.predicted);
        EXPECT_NEAR(trial.wall.predicted, damping / (0.5e-3 + device.link().lag), 1e-6);
    }
    const auto rubbing = drivers::open_device("sim:premium15,grip=0,coulomb=0.1");
    for (const cli::PushTrial& push : tried(*rubbing).pushes) EXPECT_NEAR(push.friction, 0.1, 0.05);
}

TEST(DeviceTest, AnEncoderThatCountsBackwardsIsFound) {
    Broken device;
    device.moves_back = -1;
    try {
        const Trial trial = tried(device);
        EXPECT_THAT(cli::findings(trial), Contains(HasSubstr("moves it the other way")));
    } catch (const std::runtime_error& error) {  // the controller pushes it away, so it accelerates
        EXPECT_THAT(error.what(), HasSubstr("faster than"));
    }
}

TEST(DeviceTest, MotorsThatPushTwiceAsHardAreFound) {
    Broken device;
    device.effort = 2;
    EXPECT_THAT(cli::findings(tried(device)), Contains(HasSubstr("times as strong as it should be")));
}

TEST(DeviceTest, FindsWhichWayATorqueTurnsItAndHowHardThatIs) {
    const drivers::SimProfile profile = drivers::sim_profile("generic6");
    drivers::TipPose pose;
    drivers::Jacobian wide = drivers::Jacobian::Zero();
    ASSERT_TRUE(profile.mechanism->forward(std::span(profile.centre).first<6>(), pose, wide));
    const Eigen::Matrix<double, 6, 6> j = wide.leftCols<6>();
    const Eigen::Matrix<double, 6, 6> inertia =
        profile.mass * j.topRows<3>().transpose() * j.topRows<3>() +
        profile.rotational_inertia * j.bottomRows<3>().transpose() * j.bottomRows<3>() +
        profile.joint_inertia * Eigen::Matrix<double, 6, 6>::Identity();
    const Eigen::Matrix3d turned = (j * inertia.inverse() * j.transpose()).bottomRightCorner<3, 3>();

    Broken device("", "generic6");
    const Trial trial = tried(device);
    EXPECT_THAT(cli::findings(trial), IsEmpty());
    ASSERT_EQ(trial.turns.size(), 3u);
    for (const cli::PushTrial& turn : trial.turns) {
        const Eigen::Vector3d way = turned * turn.axis;  // rad/s^2 of 1 N m
        EXPECT_NEAR(turn.cosine, way.normalized().dot(turn.axis), 0.01);
        EXPECT_NEAR(turn.mass, 1 / way.dot(turn.axis), 0.1 * turn.mass);
        EXPECT_LT(turn.friction, 0.002);
    }
    EXPECT_EQ(trial.pushes.size(), 3u);
}

TEST(DeviceTest, AMotorOfTheWristThatPushesTheWrongWayIsFound) {
    Broken device("", "generic6");
    device.last_effort = -1;
    try {
        EXPECT_THAT(cli::findings(tried(device)), Contains(HasSubstr("a torque about")));
    } catch (const std::runtime_error& error) {  // the controller turns it away, so it accelerates
        EXPECT_THAT(error.what(), HasSubstr("faster than"));
    }
}

TEST(DeviceTest, MissingSamplesAreCounted) {
    Broken device;
    device.stale = 4;
    const Trial trial = tried(device);
    EXPECT_EQ(trial.rest.sample_rate, 750);
    EXPECT_THAT(cli::findings(trial), Contains(HasSubstr("only 75.0 %")));
}

TEST(DeviceTest, TheRoundTripIsFromAnOrderToItsAnswer) {
    constexpr double answer = 850e-6, look = 10e-6;  // s
    Broken device;
    device.answers_after = 850'000;
    const Trial trial = tried(device);
    ASSERT_EQ(trial.rest.round_trip.size(), 1000u);
    for (const double took : trial.rest.round_trip) {
        EXPECT_GE(took, answer - 1e-12);
        EXPECT_LE(took, answer + look);
    }
}

TEST(DeviceTest, TheProgramSaysItAsTextAndAsJson) {
    const Outcome text = knurl({"device", "test", "sim:premium15,grip=0", "--virtual"});
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("stiffest wall"));
    EXPECT_THAT(text.out, Not(HasSubstr("round trip"))) << "of a virtual clock";
    EXPECT_THAT(text.out, HasSubstr("as it should be"));
    const auto json =
        knurl::Json::parse(knurl({"device", "test", "sim:premium15,grip=0", "--virtual", "--json"}).out);
    EXPECT_EQ(json.at("device"), "premium15");
    EXPECT_EQ(json.at("pushes").size(), 3u);
    EXPECT_TRUE(json.at("turns").empty()) << "it renders no torque";
    EXPECT_GT(json.at("rest").at("round_trip").at("p50_s"), 0);
    EXPECT_TRUE(json.at("findings").empty());
}

TEST(DeviceTest, ASimulatedArmIsLetGoOfUnlessAHandIsAskedFor) {
    const Outcome free = knurl({"device", "test", "sim:premium15", "--virtual"});
    EXPECT_EQ(free.code, 0) << free.out;
    EXPECT_THAT(free.err, HasSubstr("nobody's hand on it: tests sim:premium15,grip=0 "));
    EXPECT_THAT(free.out, HasSubstr("as it should be"));
    // One device has three stiffnesses; the output states the meaning of each.
    EXPECT_THAT(free.out, ContainsRegex("stiffest wall +[0-9]+ N/m measured, nobody's hand on it\n"));
    EXPECT_THAT(free.out,
                ContainsRegex("promised alone +194 N/m by its own damping.*; 0.9 of that or more passes\n"));
    EXPECT_THAT(free.out,
                ContainsRegex("promised held +3105 N/m, the hand's 3 N s/m added: what knurld clamps to\n"));
    EXPECT_THAT(free.out, ContainsRegex("x the model's force .0.7 to 1.4 pass"));
    const Outcome held = knurl({"device", "test", "sim:premium15,seed=2,grip=1", "--virtual"});
    EXPECT_EQ(held.code, 1) << held.out;
    EXPECT_THAT(held.err, Not(HasSubstr("nobody's hand")));
    EXPECT_THAT(held.out, HasSubstr("times as strong as it should be"));
    const auto json =
        knurl::Json::parse(knurl({"device", "test", "sim:cartesian3,seed=2", "--virtual", "--json"}).out);
    EXPECT_EQ(json.at("address"), "sim:cartesian3,seed=2,grip=0");
}

TEST(DeviceTest, ToldToStopItLeavesTheMotorsAtZero) {
    Broken device;
    std::atomic<bool> stop = false;
    try {
        cli::try_device(device, {.virtual_time = true, .stop = &stop},
                        [&](const std::string& line) { stop = line.find("wall") != std::string::npos; });
        ADD_FAILURE() << "it went on";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "interrupted; its motors are at zero");
    }
    EXPECT_TRUE(device.exerted);
    EXPECT_FALSE(device.exerts);
}

TEST(DeviceTest, AnInterruptIsOneLineAndExitCode1) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        Background test({knurl_program(), "device", "test", "sim:cartesian3"});
        ASSERT_TRUE(test.says("pushes of")) << test.said();
        EXPECT_EQ(test.end(signal), 1) << signal;
        EXPECT_THAT(test.said(), HasSubstr("knurl device test: interrupted; its motors are at zero\n"));
    }
}

TEST(DeviceTest, MistakesAreOneLineThatSaysWhatToDo) {
    const Home home;
    const Outcome unknown = knurl({"device", "test", "left"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.err, HasSubstr("\"left\" is no address; write one of sim:"));
    const Outcome real_time = knurl({"device", "test", "motion:x", "--virtual"});
    EXPECT_EQ(real_time.code, 2);
    EXPECT_THAT(real_time.err, HasSubstr("simulated devices"));
    const Servo servo({"--device", "left=sim:premium15"});
    const Outcome held = knurl({"device", "test", "left"});
    EXPECT_EQ(held.code, 2);
    EXPECT_THAT(held.err, HasSubstr("is run by the servo \"default\""));
    EXPECT_THAT(held.err, HasSubstr("knurl device test sim:premium15"));
}

}  // namespace
}  // namespace knurl::test
