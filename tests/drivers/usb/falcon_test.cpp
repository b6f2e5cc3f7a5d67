// A Falcon from plug to force: what a user relies on, against an emulation at the level of usbfs.

#include "falcon_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

class FalconOnABus : public testing::Test {
  protected:
    Bus bus_;
    TemporaryFile firmware_{made_up_firmware()};

    std::unique_ptr<Device> open(const std::string& what = "") { return open_device("falcon:" + what); }
    std::string with_firmware() const { return ",firmware=" + firmware_.path(); }

    static std::string error_of(const std::string& address) {
        try {
            open_device(address);
        } catch (const std::exception& error) {
            return error.what();
        }
        return "(no error)";
    }
};

TEST_F(FalconOnABus, IsBootedWithTheFileThatTheUserNames) {
    const auto falcon = falcon_at_centre(false);
    bus_.plug(falcon, {.serial = "FALCON01"});
    EXPECT_EQ(bus_.bound_driver("1-1"), "ftdi_sio");
    const auto device = open(with_firmware());
    bus_.locked([&] {
        EXPECT_TRUE(falcon->running());
        EXPECT_EQ(falcon->boots(), 1);
        EXPECT_EQ(falcon->program().size(), 400U);
    });
    EXPECT_EQ(device->link().serial, "FALCON01");
    JointSample sample;
    EXPECT_EQ(device->read(0, sample), ReadStatus::ok);
    EXPECT_TRUE(sample.calibrated);
}

TEST_F(FalconOnABus, GoesOnWithFirmwareThatRunsAlready) {
    const auto falcon = falcon_at_centre(true);
    bus_.plug(falcon, {.serial = "FALCON01"});
    const auto device = open("FALCON01");
    EXPECT_EQ(bus_.locked([&] { return falcon->boots(); }), 0);
    EXPECT_NE(device->link().description.find("as it was running"), std::string::npos);
}

TEST_F(FalconOnABus, FollowsTheHand) {
    const auto falcon = falcon_at_centre();
    bus_.plug(falcon, {});
    bus_.locked([&] { falcon->hand = [](double t) { return legs_at(circling(t)); }; });
    const auto device = open();
    double worst = 0;
    int fresh = 0;
    cycles(bus_, *device, 500, [&](ReadStatus status, const JointSample& sample) {
        fresh += status == ReadStatus::ok ? 1 : 0;
        TipPose pose;
        Jacobian jacobian;
        EXPECT_TRUE(device->mechanism().forward(std::span(sample.position).first(3), pose, jacobian));
        // On the circle, whenever it was: 65 um are the encoders' worst.
        worst = std::max(worst, std::abs(pose.position.head<2>().norm() - 0.02));
        worst = std::max(worst, std::abs(pose.position.z() - falcon_centre));
        return JointEfforts{};
    });
    EXPECT_LT(worst, 130e-6);
    EXPECT_GT(fresh, 100);
    std::printf("%d of 500 samples were new, worst %.0f um off the path\n", fresh, worst * 1e6);
}

}  // namespace
}  // namespace knurl::drivers
