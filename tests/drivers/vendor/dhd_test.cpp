// The driver dhd: against a counterfeit of its maker's library. knurl-device runs as it does for a servo; the test is the
// servo.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include <knurl/drivers/cartesian_tool.hpp>

#include "vendor_fixture.hpp"

namespace knurl::drivers {
namespace {

class Dhd : public Vendor {
  protected:
    void open(const std::string& what = "") { open_at("dhd:" + what); }
};

TEST_F(Dhd, DescribesAnOmega3) {
    open();
    const LinkConfig& link = device_->link();
    EXPECT_EQ(link.name, "omega3");
    EXPECT_EQ(link.serial, "12345");
    EXPECT_EQ(link.sensed_joints, 3);
    EXPECT_EQ(link.actuated_joints, 3);
    EXPECT_EQ(link.peak_force, 12);
    EXPECT_FALSE(link.senses_orientation);
    EXPECT_TRUE(link.has_watchdog);
    EXPECT_DOUBLE_EQ(link.watchdog_time, 5e-3);
    EXPECT_TRUE(link.has_brake);
    EXPECT_THAT(link.description, HasSubstr("SDK 3.17"));
    EXPECT_THAT(link.description, HasSubstr("not known"));
}

TEST_F(Dhd, LeavesGravityCompensationOnAndTakesTheBrakesOff) {
    open();
    ASSERT_TRUE(comes());
    EXPECT_EQ(bench_.device().gravity.load(), 1u);
    EXPECT_TRUE(until({}, [&] { return bench_.device().braked.load() == 0; }));
    device_.reset();
    EXPECT_EQ(bench_.device().braked.load(), 1u) << "closed, its motors brake";
    EXPECT_EQ(bench_.device().opened_by.load(), 0u);
}

TEST_F(Dhd, PassesOnHowTheBaseStandsAndWhatTheToolWeighs) {
    open(",base_x=30,base_z=-45,tool=0.1");
    EXPECT_EQ(bench_.device().base_x.load(), 30);
    EXPECT_EQ(bench_.device().base_z.load(), -45);
    EXPECT_EQ(bench_.device().tool.load(), 0.1);
}

TEST_F(Dhd, ReadsWhereTheTipIsAndTheButtons) {
    bench_.device().target[0] = 0.01;
    bench_.device().target[2] = -0.02;
    bench_.device().buttons = 5;
    open();
    ASSERT_TRUE(until({}, [&] { return sample_.position[0] == 0.01; }));
    EXPECT_DOUBLE_EQ(sample_.position[1], 0);
    EXPECT_DOUBLE_EQ(sample_.position[2], -0.02);
    EXPECT_TRUE(until({}, [&] { return sample_.buttons == 5; }));
}

TEST_F(Dhd, GivesForcesAndNoneBeforeItIsHomed) {
    bench_.device().homed = 0;
    open();
    ASSERT_TRUE(until({3, 2, 1}, [&] { return status_ == ReadStatus::ok; }));
    EXPECT_FALSE(sample_.calibrated);
    const std::uint64_t before = bench_.device().forces.load();
    ASSERT_TRUE(until({3, 2, 1}, [&] { return bench_.device().forces.load() > before + 20; }));
    EXPECT_EQ(bench_.device().largest_now(), 0);
    bench_.device().homed = 1;
    ASSERT_TRUE(gives({3, 2, 1}, [&] { return bench_.device().share_of(0, counterfeit::now_ns()) == 3; }));
    EXPECT_EQ(bench_.device().force[1].load(), 2);
    EXPECT_EQ(bench_.device().force[2].load(), 1);
}

TEST_F(Dhd, HasAWristAndAGripperOnASigma7) {
    auto& device = bench_.device();
    device.type = 104;
    device.wrist = device.active_wrist = device.gripper = device.active_gripper = 1;
    device.target[3] = 0.4;
    device.target[4] = -0.3;
    device.target[5] = 0.2;
    device.target[6] = 0.015;
    open();
    const LinkConfig& link = device_->link();
    EXPECT_EQ(link.name, "sigma7");
    EXPECT_EQ(link.sensed_joints, 7);
    EXPECT_EQ(link.actuated_joints, 7);
    EXPECT_TRUE(link.renders_torque);
    ASSERT_TRUE(comes());
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(sample_.position[3 + i], device.target[3 + i].load(), 1e-12);
    EXPECT_DOUBLE_EQ(sample_.position[6], 0.015);

    // A wrench through J^T and back is the wrench.
    TipPose pose;
    Jacobian jacobian;
    ASSERT_TRUE(device_->mechanism().forward({sample_.position.data(), 7}, pose, jacobian));
    const Eigen::Vector3d torque(0.05, -0.04, 0.03);
    Eigen::Matrix<double, 8, 1> tau = jacobian.bottomRows<3>().transpose() * torque;
    tau[0] = 1;
    tau[6] = 2;  // the gripper's own force
    JointEfforts efforts;
    std::copy_n(tau.data(), 8, efforts.begin());
    ASSERT_TRUE(gives(efforts, [&] { return bench_.device().share_of(6, counterfeit::now_ns()) == 2; }));
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(device.force[static_cast<std::size_t>(3 + i)].load(), torque[i], 1e-12);
}

TEST_F(Dhd, DrivesTheGripperOfAnOmega7WhoseWristIsPassive) {
    auto& device = bench_.device();
    device.type = 35;
    device.wrist = device.gripper = device.active_gripper = 1;
    device.target[4] = 0.5;
    device.target[6] = 0.01;
    open();
    EXPECT_EQ(device_->link().actuated_joints, 4);
    EXPECT_TRUE(device_->link().senses_orientation);
    EXPECT_FALSE(device_->link().renders_torque);
    ASSERT_TRUE(comes());
    EXPECT_DOUBLE_EQ(sample_.position[3], 0.01) << "driven joints come first";
    EXPECT_NEAR(sample_.position[5], 0.5, 1e-12);
    ASSERT_TRUE(
        gives({0, 0, 0, -4}, [&] { return bench_.device().share_of(6, counterfeit::now_ns()) == -4; }));
}

TEST_F(Dhd, OpensTheDeviceThatTheSerialNumberNamesAndTwoAtOnce) {
    bench_->devices = 2;
    bench_.device(1).serial = 777;
    bench_.device(1).target[0] = 0.03;
    open("777");
    EXPECT_EQ(device_->link().serial, "777");
    const auto other = open_device("dhd:0");
    EXPECT_EQ(other->link().serial, "12345");
    ASSERT_TRUE(comes());
    EXPECT_DOUBLE_EQ(sample_.position[0], 0.03);
    JointSample sample;
    ASSERT_TRUE(test::eventually([&] { return other->read(0, sample) == ReadStatus::ok; }));
    EXPECT_EQ(sample.position[0], 0);
    EXPECT_THAT(refusal("dhd:777"), HasSubstr("another program has it open"));
}

// ------------------------------------------------------------------------------- what must end the force

TEST_F(Dhd, GivesZeroWhenTheServoIsSilent) {
    open(",watchdog=0.03");
    ASSERT_TRUE(pushes());
    const std::uint64_t before = bench_.device().forces.load();
    // Its loop goes on: it is told zero, its watchdog has nothing to do.
    ASSERT_TRUE(test::eventually([&] { return bench_.device().force[0].load() == 0; }));
    ASSERT_TRUE(test::eventually([&] { return bench_.device().forces.load() > before + 100; }));
    EXPECT_EQ(bench_.device().enabled.load(), 1u);
    EXPECT_TRUE(pushes()) << "and goes on when the servo does";
}

TEST_F(Dhd, GivesZeroAfterTheGuardiansActUntilTheServoHasReadASample) {
    open();
    ASSERT_TRUE(pushes());
    device_->make_safe();
    ASSERT_TRUE(test::eventually([&] {
        device_->write(0, {2});  // a servo that was stopped between its read and its write goes on
        return bench_.device().force[0].load() == 0;
    }));
    const std::uint64_t before = bench_.device().forces.load();
    ASSERT_TRUE(test::eventually([&] {
        device_->write(0, {2});
        EXPECT_EQ(bench_.device().force[0].load(), 0);
        return bench_.device().forces.load() > before + 50;
    }));
    EXPECT_TRUE(pushes());
}

TEST_F(Dhd, GoesOnAfterACrashInTheLibrary) {
    open();
    ASSERT_TRUE(pushes());
    bench_->set(Fault::crash_in_position);
    ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::unplugged; }));
    EXPECT_FALSE(device_->write(0, {2}));
    ASSERT_TRUE(test::eventually([&] { return bench_.device().largest_now() == 0; })) << "its watchdog";
    bench_->set(Fault::none);
    ASSERT_TRUE(comes());
    EXPECT_EQ(bench_.device().largest_now(), 0) << "no order from before reaches it";
    EXPECT_TRUE(pushes());
}

TEST_F(Dhd, IsNotHeldUpByACallThatNeverReturns) {
    open();
    for (const Fault fault : {Fault::hang_in_position, Fault::hang_in_force}) {
        ASSERT_TRUE(pushes());
        bench_->set(fault);
        ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::stale; }));
        ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::unplugged; })) << "its process was ended";
        EXPECT_EQ(bench_.device().largest_now(), 0) << "its watchdog";
        bench_->set(Fault::none);
    }
    ASSERT_TRUE(pushes());
    bench_->set(Fault::hang_in_close);
    device_.reset();  // returns
    EXPECT_EQ(bench_.device().largest_now(), 0);
}

TEST_F(Dhd, IsUnpluggedAndComesBackWithTheSameSerialNumber) {
    bench_->devices = 2;
    bench_.device(1).serial = 777;
    open("777");
    ASSERT_TRUE(comes());
    bench_.device(1).plugged = 0;
    ASSERT_TRUE(until({}, [&] { return status_ == ReadStatus::unplugged; }));
    for (int i = 0; i < 20; ++i) {
        cycle();
        EXPECT_EQ(status_, ReadStatus::unplugged);
    }
    bench_.device(1).target[1] = 0.02;
    bench_.device(1).plugged = 1;
    ASSERT_TRUE(comes());
    EXPECT_DOUBLE_EQ(sample_.position[1], 0.02);
    EXPECT_EQ(bench_.device(0).opened_by.load(), 0u);
}

TEST_F(Dhd, SaysBadWhereTheLibraryGivesNonsense) {
    bench_.device().wrist = 1;
    bench_.device().type = 34;
    open();
    for (const Fault fault : {Fault::nan, Fault::no_rotation, Fault::refuse_once}) {
        ASSERT_TRUE(comes());
        bench_->set(fault);
        EXPECT_TRUE(until({}, [&] { return status_ == ReadStatus::bad; })) << static_cast<int>(fault);
        for (double joint : sample_.position) EXPECT_TRUE(std::isfinite(joint));
        bench_->set(Fault::none);
    }
    ASSERT_TRUE(comes());
    bench_->set(Fault::time_guard);
    ASSERT_TRUE(until({}, [&] { return status_ == ReadStatus::stale; }));
    bench_->set(Fault::none);
    EXPECT_TRUE(comes());
}

TEST_F(Dhd, OpensADeviceAnewThatRefusesEverything) {
    open();
    for (const Fault fault : {Fault::com_error, Fault::refuse_force, Fault::device_error}) {
        ASSERT_TRUE(pushes());
        bench_->set(fault);
        ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::unplugged; })) << static_cast<int>(fault);
        bench_->set(Fault::none);
    }
    EXPECT_TRUE(pushes());
}

TEST_F(Dhd, SaysBadWhileForcesAreSwitchedOffAndComesBackFromRestOnly) {
    open();
    ASSERT_TRUE(pushes());
    bench_.device().forces_allowed = 0;  // the button of the base
    ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::bad; }));
    bench_.device().forces_allowed = 1;
    ASSERT_TRUE(pushes());
    bench_.device().off_cause = 2;  // too fast: its own guard
    bench_.device().enabled = 0;
    ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::bad; }));
    const int before = bad_;
    ASSERT_TRUE(until({2}, [&] { return bad_ > before + 200; })) << "as long as the servo pushes";
    EXPECT_EQ(bench_.device().enabled.load(), 0u);
    ASSERT_TRUE(until({}, [&] { return bench_.device().enabled.load() == 1; })) << "after a rest";
    EXPECT_TRUE(pushes());
}

TEST_F(Dhd, SaysSoWhereTheDeviceHasNoWatchdog) {
    bench_.device().no_watchdog = 1;
    open();
    EXPECT_FALSE(device_->link().has_watchdog);
    EXPECT_EQ(device_->link().watchdog_time, 0);
}

// --------------------------------------------------------------------------------------------- refusals

TEST_F(Dhd, NamesWhatIsWrongWithALibraryInOneLine) {
    const std::filesystem::path folder = bench_.folder();
    const auto with = [&](const std::filesystem::path& path) {
        setenv("KNURL_LIBDHD", path.c_str(), 1);
        return refusal("dhd:");
    };
    EXPECT_THAT(with(folder / "none.so"), HasSubstr("No such file"));
    EXPECT_THAT(with(folder), HasSubstr("has no libdhd.so.3"));
    std::ofstream(folder / "text.so") << "version https://git-lfs.github.com/spec/v1\n";
    EXPECT_THAT(with(folder / "text.so"), HasSubstr("no shared library"));
    std::ofstream(folder / "empty.so") << "";
    EXPECT_THAT(with(folder / "empty.so"), HasSubstr("no shared library"));
    std::string elf("\177ELF\1\1\1\0\0\0\0\0\0\0\0\0\3\0\3\0", 20);
    std::ofstream(folder / "small.so") << elf;
    EXPECT_THAT(with(folder / "small.so"), HasSubstr("32 bits"));
    elf[4] = 2;
    elf[18] = 40;
    std::ofstream(folder / "arm.so") << elf;
    EXPECT_THAT(with(folder / "arm.so"), HasSubstr("another processor"));
    elf[18] = 62;
    std::ofstream(folder / "head.so") << elf;
    EXPECT_THAT(with(folder / "head.so"), HasSubstr("cannot load"));
    EXPECT_THAT(with(KNURL_COUNTERFEIT_DHD_LACKING), HasSubstr("has no function dhdGetPosition"));
    EXPECT_THAT(with("/proc/self/exe"), HasSubstr("cannot load")) << "a program is no library";
    if (geteuid() != 0) {
        std::filesystem::copy(KNURL_COUNTERFEIT_DHD, folder / "mine.so");
        std::filesystem::permissions(folder / "mine.so", std::filesystem::perms::none);
        EXPECT_THAT(with(folder / "mine.so"), HasSubstr("chmod a+r"));
    }
}

TEST_F(Dhd, NamesWhatIsWrongWithTheDeviceInOneLine) {
    bench_->minor = 12;
    EXPECT_THAT(refusal("dhd:"), HasSubstr("3.12.1; Knurl knows 3.14 to 3.17"));
    bench_->minor = 17;
    EXPECT_THAT(refusal("dhd:4"), HasSubstr("there is no device 4; the library sees 1"));
    EXPECT_THAT(refusal("dhd:4711"), HasSubstr("device 4711"));
    bench_.device().plugged = 0;
    EXPECT_THAT(refusal("dhd:"), HasSubstr("sees no Force Dimension device"));
    bench_.device().plugged = 1;
    bench_->set(Fault::crash_in_open);
    EXPECT_THAT(refusal("dhd:"), HasSubstr("killed by signal 11"));
    bench_->set(Fault::none);
    EXPECT_THAT(refusal("dhd:left"), HasSubstr("neither a serial number nor an index"));
    EXPECT_THAT(refusal("dhd:,rate=7"), HasSubstr("500 to 8000 Hz"));
    EXPECT_THAT(refusal("dhd:,rat=7"), HasSubstr("no option rat"));
    EXPECT_THAT(refusal("dhd:,port=1-1"), HasSubstr("port="));
    setenv("KNURL_DEVICE_PROGRAM", "/no/such/program", 1);
    EXPECT_THAT(refusal("dhd:"), HasSubstr("knurl-server"));
}

TEST_F(Dhd, TakesFiguresFromTheAddress) {
    open(",limit=6,damping=2,lag=0.001,mass=0.3,max_stiffness=900");
    const LinkConfig& link = device_->link();
    EXPECT_EQ(link.peak_force, 6);
    EXPECT_EQ(link.continuous_force, 6);
    EXPECT_EQ(link.effort_limit[0], 6);
    EXPECT_EQ(link.damping, 2);
    EXPECT_EQ(link.lag, 0.001);
    EXPECT_EQ(link.apparent_mass, 0.3);
    EXPECT_EQ(link.measured_max_stiffness, 900);
}

// --------------------------------------------------------------------------------------------- mechanism

TEST(CartesianTool, ItsJacobianIsTheDerivativeOfItsPose) {
    const CartesianTool tool(true, 6);
    std::mt19937 random(20261129);
    SCOPED_TRACE("seed 20261129");
    std::uniform_real_distribution<double> any(-2.5, 2.5);
    for (int trial = 0; trial < 300; ++trial) {
        std::array<double, 7> q{};
        for (double& joint : q) joint = any(random);
        if (Eigen::Map<Eigen::Vector3d>(q.data() + 3).norm() > 6) continue;
        TipPose pose, before, after;
        Jacobian jacobian, unused;
        ASSERT_TRUE(tool.forward(q, pose, jacobian));
        for (std::size_t joint = 3; joint < 6; ++joint) {
            constexpr double h = 1e-5;
            std::array<double, 7> less = q, more = q;
            less[joint] -= h;
            more[joint] += h;
            ASSERT_TRUE(tool.forward(less, before, unused));
            ASSERT_TRUE(tool.forward(more, after, unused));
            Eigen::Quaterniond turn = after.orientation * before.orientation.conjugate();
            if (turn.w() < 0) turn.coeffs() *= -1;
            const Eigen::Vector3d rate = turn.vec() / h;
            EXPECT_LT((rate - jacobian.block<3, 1>(3, static_cast<Eigen::Index>(joint))).norm(), 1e-8);
        }
    }
}

TEST(CartesianTool, FollowsAHandPastHalfATurnWithoutALeap) {
    const CartesianTool tool(true);
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -1).normalized();
    for (double angle = 0; angle < 6; angle += 0.01) {
        const Eigen::Vector3d next =
            CartesianTool::rotation_near(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), last);
        EXPECT_LT((next - last).norm(), 0.011);
        EXPECT_NEAR(next.norm(), angle, 1e-9);
        last = next;
    }
}

}  // namespace
}  // namespace knurl::drivers
