// The driver hd: against a counterfeit of OpenHaptics' libHD.

#include <cmath>

#include <knurl/gateway/frames.hpp>

#include "vendor_fixture.hpp"

namespace knurl::drivers {
namespace {

class Hd : public Vendor {
  protected:
    void open(const std::string& what = "") { open_at("hd:" + what); }
};

TEST_F(Hd, DescribesATouchByWhatItsLibraryStates) {
    bench_.device().wrist = 1;
    open();
    const LinkConfig& link = device_->link();
    EXPECT_EQ(link.name, "touch");
    EXPECT_EQ(link.serial, "FIRST");
    EXPECT_EQ(link.sensed_joints, 6);
    EXPECT_EQ(link.actuated_joints, 3);
    EXPECT_TRUE(link.senses_orientation);
    EXPECT_FALSE(link.renders_torque);
    EXPECT_DOUBLE_EQ(link.peak_force, 3.3);
    EXPECT_DOUBLE_EQ(link.continuous_force, 0.88);
    EXPECT_DOUBLE_EQ(link.workspace_radius, 0.035);
    EXPECT_DOUBLE_EQ(link.nominal_rate, 1000);
    EXPECT_FALSE(link.has_watchdog) << "none is documented";
    EXPECT_THAT(link.description, HasSubstr("OpenHaptics 3.40"));
}

// Millimetres (y, z, x): the gateway's map, which has tests of its own.
TEST_F(Hd, HasKnurlsAxesAndMetres) {
    bench_.device().target[0] = 0.01;
    bench_.device().target[1] = 0.02;
    bench_.device().target[2] = -0.03;
    open();
    ASSERT_TRUE(until({}, [&] { return std::abs(sample_.position[2] + 0.03) < 1e-12; }));
    EXPECT_NEAR(sample_.position[0], 0.01, 1e-12);
    EXPECT_NEAR(sample_.position[1], 0.02, 1e-12);
    const Vec3 theirs = gateway::frames::openhaptics.position({0.01, 0.02, -0.03});
    EXPECT_NEAR(theirs.x, 20, 1e-9) << "what the counterfeit gave: y first";
    EXPECT_NEAR(theirs.y, -30, 1e-9);
    EXPECT_NEAR(theirs.z, 10, 1e-9);
    ASSERT_TRUE(gives({1, 2, -3}, [&] { return bench_.device().share_of(0, counterfeit::now_ns()) == 1; }));
    EXPECT_DOUBLE_EQ(bench_.device().force[1].load(), 2);
    EXPECT_DOUBLE_EQ(bench_.device().force[2].load(), -3);
}

TEST_F(Hd, TurnsTheToolAboutKnurlsAxesAndGivesTorque) {
    bench_.device().wrist = bench_.device().active_wrist = 1;
    bench_.device().target[4] = 0.7;
    open();
    EXPECT_TRUE(device_->link().renders_torque);
    ASSERT_TRUE(comes());
    EXPECT_NEAR(sample_.position[3], 0, 1e-12);
    EXPECT_NEAR(sample_.position[4], 0.7, 1e-12) << "their x is Knurl's y";
    EXPECT_NEAR(sample_.position[5], 0, 1e-12);
    TipPose pose;
    Jacobian jacobian;
    ASSERT_TRUE(device_->mechanism().forward({sample_.position.data(), 6}, pose, jacobian));
    const Eigen::Vector3d torque(0.05, -0.04, 0.03);
    const Eigen::Matrix<double, 8, 1> tau = jacobian.bottomRows<3>().transpose() * torque;
    JointEfforts efforts{};
    std::copy_n(tau.data(), 6, efforts.begin());
    ASSERT_TRUE(gives(efforts, [&] { return std::abs(bench_.device().force[3].load() - 0.05) < 1e-12; }));
    EXPECT_NEAR(bench_.device().force[4].load(), -0.04, 1e-12);
    EXPECT_NEAR(bench_.device().force[5].load(), 0.03, 1e-12);
}

TEST_F(Hd, HasTwoButtonsAndTheInkwell) {
    open();
    ASSERT_TRUE(comes());
    bench_.device().buttons = 0x12;
    EXPECT_TRUE(until({}, [&] { return sample_.buttons == 0x12; }));
}

TEST_F(Hd, GivesNoForceBeforeItIsCalibrated) {
    bench_.device().homed = 0;
    open();
    ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::ok; }));
    EXPECT_FALSE(sample_.calibrated);
    const std::uint64_t before = bench_.device().forces.load();
    ASSERT_TRUE(until({2}, [&] { return bench_.device().forces.load() > before + 20; }));
    EXPECT_EQ(bench_.device().largest_now(), 0);
    bench_.device().homed = 1;  // put into its inkwell
    EXPECT_TRUE(pushes());
}

TEST_F(Hd, OpensTheDeviceOfAName) {
    bench_->devices = 2;
    bench_.device(1).target[0] = 0.02;
    open("second");
    EXPECT_EQ(device_->link().serial, "SECOND");
    const auto other = open_device("hd:");
    ASSERT_TRUE(comes());
    EXPECT_DOUBLE_EQ(sample_.position[0], 0.02);
    EXPECT_THAT(refusal("hd:"), HasSubstr("another program has it open"));
    EXPECT_THAT(refusal("hd:third"), HasSubstr("device \"third\": there is no such device"));
}

TEST_F(Hd, GivesZeroWhenTheServoIsSilentAndAfterTheGuardiansAct) {
    open();
    ASSERT_TRUE(pushes());
    ASSERT_TRUE(test::eventually([&] { return bench_.device().force[0].load() == 0; })) << "silent";
    ASSERT_TRUE(pushes());
    device_->make_safe();
    ASSERT_TRUE(test::eventually([&] {
        device_->write(0, {2});
        return bench_.device().force[0].load() == 0;
    }));
    EXPECT_TRUE(pushes());
}

// No watchdog of a Touch is documented: what zeroes it is the next process, which is started at once.
TEST_F(Hd, IsZeroedByTheNextProcessAfterACrash) {
    open();
    for (const Fault fault : {Fault::crash_in_position, Fault::hang_in_position, Fault::hang_in_force}) {
        ASSERT_TRUE(pushes());
        bench_->set(fault);
        ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::unplugged; }));
        bench_->set(Fault::none);
        ASSERT_TRUE(until({}, [&] { return bench_.device().largest_now() == 0; }));
        ASSERT_TRUE(comes());
    }
}

TEST_F(Hd, SaysBadWhereTheLibraryGivesNonsenseOrCutsTheForce) {
    bench_.device().wrist = 1;
    open();
    for (const Fault fault : {Fault::nan, Fault::no_rotation}) {
        ASSERT_TRUE(comes());
        bench_->set(fault);
        EXPECT_TRUE(until({}, [&] { return status_ == ReadStatus::bad; }));
        bench_->set(Fault::none);
    }
    ASSERT_TRUE(pushes());
    bench_->set(Fault::refuse_once);
    EXPECT_TRUE(until({2}, [&] { return status_ == ReadStatus::bad; }));
    bench_->set(Fault::none);
    ASSERT_TRUE(pushes());
    bench_.device().enabled = 0;  // cut by the library
    ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::bad; }));
    const int before = bad_;
    ASSERT_TRUE(until({2}, [&] { return bad_ > before + 100; })) << "as long as the servo pushes";
    EXPECT_EQ(bench_.device().enabled.load(), 0u);
    ASSERT_TRUE(until({}, [&] { return bench_.device().enabled.load() == 1; })) << "after a rest";
    EXPECT_TRUE(pushes());
}

TEST_F(Hd, WarnsOfWarmMotorsAndGoesOn) {
    open();
    ASSERT_TRUE(pushes());
    bench_->set(Fault::warm);
    const std::uint64_t before = bench_.device().forces.load();
    ASSERT_TRUE(until({2}, [&] { return bench_.device().forces.load() > before + 100; }));
    EXPECT_EQ(status_ == ReadStatus::unplugged, false);
    bench_->set(Fault::none);
    EXPECT_TRUE(pushes());
}

TEST_F(Hd, OpensADeviceAnewThatIsGone) {
    open();
    for (const Fault fault : {Fault::com_error, Fault::device_error}) {
        ASSERT_TRUE(pushes());
        bench_->set(fault);
        ASSERT_TRUE(until({2}, [&] { return status_ == ReadStatus::unplugged; }));
        bench_->set(Fault::none);
    }
    EXPECT_TRUE(pushes());
}

}  // namespace
}  // namespace knurl::drivers
