// A Falcon from plugging in to force: what a user relies on, against an emulation at the level of usbfs.

#include <sys/syscall.h>

#include "../../eventually.hpp"
#include "../../refusal.hpp"
#include "falcon_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

std::string error_of(const std::string& address) {
    return test::refusal_of([&] { open_device(address); });
}

class FalconOnABus : public testing::Test {
  protected:
    Bus bus_;
    TemporaryFile firmware_{made_up_firmware()};

    std::unique_ptr<Device> open(const std::string& what = "") { return open_device("falcon:" + what); }
    std::string with_firmware() const { return ",firmware=" + firmware_.path(); }
    /// Cycles with these efforts until the device has them, or 200 frames have passed.
    bool reaches(Device& device, const Falcon& falcon, const JointEfforts& efforts,
                 const std::array<int, 3>& motors) {
        for (int i = 0; i < 200; ++i) {
            cycles(bus_, device, 1, [&](ReadStatus, const JointSample&) { return efforts; });
            if (bus_.locked([&] { return falcon.motors() == motors; })) return true;
        }
        const auto got = bus_.locked([&] { return falcon.motors(); });
        ADD_FAILURE() << "motors are at " << got[0] << ' ' << got[1] << ' ' << got[2];
        return false;
    }
};

// ------------------------------------------------------------------------------------------------------
// booting

TEST_F(FalconOnABus, IsBootedWithTheFileThatTheUserNames) {
    const auto falcon = falcon_at_centre(false);
    bus_.plug(falcon, {.serial = "FALCON01"});
    EXPECT_EQ(bus_.bound_driver("1-1"), "ftdi_sio");
    {
        const auto device = open(with_firmware());
        bus_.locked([&] {
            EXPECT_TRUE(falcon->running());
            EXPECT_EQ(falcon->boots(), 1);
            EXPECT_EQ(falcon->program().size(), 400U);
        });
        EXPECT_EQ(bus_.bound_driver("1-1"), "");
        EXPECT_EQ(device->link().serial, "FALCON01");
        EXPECT_NE(device->link().description.find("firmware sha256 "), std::string::npos);
        JointSample sample;
        EXPECT_EQ(device->read(0, sample), ReadStatus::ok);
        EXPECT_TRUE(sample.calibrated);
    }
    EXPECT_EQ(bus_.bound_driver("1-1"), "ftdi_sio") << "it is given back to the kernel";
    EXPECT_EQ(bus_.claims("1-1"), 0);
}

TEST_F(FalconOnABus, GoesOnWithFirmwareThatRunsAlready) {
    const auto falcon = falcon_at_centre(true);
    bus_.plug(falcon, {.serial = "FALCON01"});
    const auto device = open("FALCON01" + with_firmware());
    EXPECT_EQ(bus_.locked([&] { return falcon->boots(); }), 0);
}

TEST_F(FalconOnABus, BootsThroughFragmentsAlteredEchoesAndAnImageThatDoesNotRunAtOnce) {
    for (const int fragment : {1, 3, 17}) {
        const auto falcon = falcon_at_centre(false);
        falcon->chip = {.fragment = fragment,
                        .wrong_echoes = 1,
                        .wrong_echo_at = 61,
                        .deaf_loads = 1,
                        .leading_zero = true};
        bus_.plug(falcon, {});
        const auto device = open(with_firmware());
        EXPECT_EQ(bus_.locked([&] { return falcon->boots(); }), 2) << fragment;
        bus_.unplug("1-1");
    }
}

TEST_F(FalconOnABus, SaysWhyItDoesNotBoot) {
    const auto falcon = falcon_at_centre(false);
    bus_.plug(falcon, {.serial = "FALCON01"});
    EXPECT_NE(error_of("falcon:").find(
                  "runs no firmware; name the file that its maker supplies: falcon:FALCON01,firmware=FILE"),
              std::string::npos);
    bus_.locked([&] { falcon->chip = {.wrong_echoes = 1000, .wrong_echo_at = 100}; });
    EXPECT_NE(error_of("falcon:" + with_firmware()).find("does not boot: byte 100 came back altered"),
              std::string::npos);
    bus_.locked([&] { falcon->faults = {.silent = true}; });
    EXPECT_NE(error_of("falcon:" + with_firmware()).find("its boot ROM does not answer"), std::string::npos);
    EXPECT_EQ(bus_.claims("1-1"), 0) << "nothing is left open";
}

TEST_F(FalconOnABus, RefusesAFileThatIsNoBootStream) {
    bus_.plug(falcon_at_centre(false), {});
    const TemporaryFile text({'h', 'e', 'l', 'l', 'o'});
    EXPECT_NE(error_of("falcon:,firmware=" + text.path()).find("at byte 0 the key 0x08AA was expected"),
              std::string::npos);
}

// ------------------------------------------------------------------------------------------- which one, and
// rights

TEST_F(FalconOnABus, SeveralAreToldApartBySerialNumber) {
    const auto left = falcon_at_centre(), right = falcon_at_centre();
    bus_.plug(left, {.port = "1-1", .serial = "LEFT"});
    bus_.plug(right, {.port = "1-4", .serial = "RIGHT"});
    EXPECT_NE(
        error_of("falcon:").find("2 of Novint Falcon are plugged in; say which: falcon:LEFT, falcon:RIGHT"),
        std::string::npos);
    EXPECT_NE(
        error_of("falcon:MIDDLE").find("no Novint Falcon \"MIDDLE\"; plugged in: falcon:LEFT, falcon:RIGHT"),
        std::string::npos);
    const auto one = open("RIGHT"), other = open("port=1-1");
    EXPECT_EQ(one->link().serial, "RIGHT");
    EXPECT_EQ(other->link().serial, "LEFT");
    EXPECT_TRUE(reaches(*one, *right, {0.1, 0, 0}, {-1000, 0, 0}));
    EXPECT_TRUE(reaches(*other, *left, {0, 0.05, 0}, {0, -500, 0}));
    EXPECT_EQ(bus_.locked([&] { return right->motors()[1]; }), 0);
}

TEST_F(FalconOnABus, TwoWithTheSameSerialNumberAreToldApartByPort) {
    bus_.plug(falcon_at_centre(), {.port = "1-1", .serial = "SAME"});
    bus_.plug(falcon_at_centre(), {.port = "1-2", .serial = "SAME"});
    EXPECT_NE(error_of("falcon:SAME")
                  .find("have the same serial number \"SAME\"; say which by its port: "
                        "falcon:port=1-1, falcon:port=1-2"),
              std::string::npos);
    EXPECT_EQ(open("SAME,port=1-2")->link().serial, "SAME");
}

TEST_F(FalconOnABus, SaysWhenAnotherProgramHoldsIt) {
    const std::string node = bus_.plug(falcon_at_centre(), {.serial = "FALCON01"});
    bus_.hold_by_another("1-1", true);
    EXPECT_NE(error_of("falcon:").find("another program holds " + node +
                                       " (falcon:FALCON01); end it: sudo fuser -v " + node),
              std::string::npos);
    EXPECT_TRUE(usb_devices().at(0).claimed);
    bus_.hold_by_another("1-1", false);
    EXPECT_FALSE(usb_devices().at(0).claimed);
    EXPECT_EQ(open()->link().serial, "FALCON01");
}

TEST_F(FalconOnABus, SaysWhenItIsOpenUnderAnotherName) {
    const std::string node = bus_.plug(falcon_at_centre(), {.serial = "FALCON01"});
    {
        const auto device = open();
        EXPECT_NE(error_of("falcon:port=1-1")
                      .find("falcon:FALCON01 (" + node + ") is open already under another name"),
                  std::string::npos);
    }
    EXPECT_EQ(open()->link().serial, "FALCON01") << "it was closed";
}

TEST_F(FalconOnABus, SaysWhichRuleGivesTheRights) {
    const std::string node = bus_.plug(falcon_at_centre(), {});
    // The mock's own files must stay readable.
    std::filesystem::permissions(bus_.real_path(""), std::filesystem::perms(0777));
    for (const auto& entry : std::filesystem::recursive_directory_iterator(bus_.real_path("/ioctl")))
        std::filesystem::permissions(entry.path(), std::filesystem::perms(0777));
    std::filesystem::permissions(bus_.real_path(node), std::filesystem::perms::none);
    // This thread becomes nobody, for files only, since root may open anything. A user without that right is
    // refused already.
    syscall(SYS_setfsuid, 65534);
    const std::string error = error_of("falcon:");
    syscall(SYS_setfsuid, getuid());
    EXPECT_NE(error.find(node + ": no right to open it"), std::string::npos) << error;
    // Where Knurl's rule is installed, only the group is missing.
    EXPECT_TRUE(error.find("echo 'SUBSYSTEM==\"usb\", ATTR{idVendor}==\"0403\", ATTR{idProduct}==\"cb48\", "
                           "TAG+=\"uaccess\"'") != std::string::npos ||
                error.find("usermod --append --groups haptics") != std::string::npos)
        << error;
}

TEST_F(FalconOnABus, IsListedWithoutBeingOpened) {
    const std::string node = bus_.plug(falcon_at_centre(), {.serial = "FALCON01"});
    const std::uint64_t calls = bus_.calls();
    const std::vector<UsbDevice> all = usb_devices();
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].address(), "falcon:FALCON01");
    EXPECT_EQ(all[0].name, "FALCON HAPTIC");
    EXPECT_EQ(all[0].node, node);
    EXPECT_TRUE(all[0].accessible);
    EXPECT_EQ(bus_.calls(), calls);
}

TEST_F(FalconOnABus, IsWaitedForWhereItsAddressSaysSo) {
    const auto device = open("?wait");
    EXPECT_NE(device->link().description.find("waited for"), std::string::npos);
    JointSample sample;
    EXPECT_EQ(device->read(0, sample), ReadStatus::unplugged);
    EXPECT_FALSE(device->write(0, {0.1}));
    const auto falcon = falcon_at_centre();
    bus_.plug(falcon, {.serial = "FALCON01"});
    EXPECT_TRUE(reaches(*device, *falcon, {0.1, 0.1, 0.1}, {-1000, -1000, -1000}) ||
                reaches(*device, *falcon, {0.1, 0.1, 0.1}, {-1000, -1000, -1000}));
    EXPECT_TRUE(test::eventually([&] { return device->read(0, sample) == ReadStatus::ok; }))
        << "samples come";
    EXPECT_NE(error_of("falcon:?later").find("there is only wait"), std::string::npos);
}

TEST_F(FalconOnABus, SaysWhatAnAddressMayBe) {
    EXPECT_NE(error_of("falcon:").find("no Novint Falcon is plugged in"), std::string::npos);
    EXPECT_NE(error_of("falcon:,lowpass=3").find("no option lowpass; there are port, force, low_pass"),
              std::string::npos)
        << error_of("falcon:,lowpass=3");
    EXPECT_NE(error_of("falcon:,low_pass=-3").find("cannot use low_pass=-3; give 0 to 5000 Hz"),
              std::string::npos);
    EXPECT_NE(error_of("falcon:,event_char=1").find("give on or off"), std::string::npos);
    EXPECT_NE(error_of("falcon:A,B").find("B is no option; write NAME=VALUE"), std::string::npos);
    EXPECT_NE(error_of("falcon:,lag=0,lag=0").find("lag is there twice"), std::string::npos);
}

// ------------------------------------------------------------------------------------------------ hand and
// force

TEST_F(FalconOnABus, FollowsTheHand) {
    for (const char* option : {"", ",event_char=on"}) {
        const auto falcon = falcon_at_centre();
        bus_.plug(falcon, {});
        bus_.locked([&] { falcon->hand = [](double t) { return legs_at(circling(t)); }; });
        const std::uint64_t before = bus_.frame();
        bus_.wait(1000, [&] { return bus_.frame() > before + 1; });
        const auto device = open(option);
        double worst = 0;
        int fresh = 0;
        cycles(bus_, *device, 300, [&](ReadStatus status, const JointSample& sample) {
            fresh += status == ReadStatus::ok ? 1 : 0;
            TipPose pose;
            Jacobian jacobian;
            EXPECT_TRUE(device->mechanism().forward(std::span(sample.position).first(3), pose, jacobian));
            // On the circle, whenever it was: an encoder's count is 65 um at worst.
            worst = std::max(worst, std::abs(pose.position.tail<2>().norm() - 0.02));
            worst = std::max(worst, std::abs(pose.position.x()));
            return JointEfforts{};
        });
        EXPECT_LT(worst, 130e-6);
        EXPECT_GT(fresh, 0);
        std::printf("%s: %d of 300 samples were new, worst %.0f um off the path\n", option, fresh,
                    worst * 1e6);
        EXPECT_EQ(bus_.locked([&] { return falcon->event_character(); }), *option != 0);
        bus_.unplug("1-1");
    }
}

TEST_F(FalconOnABus, EffortsReachTheMotorsScaledTogetherAtTheLimit) {
    const auto falcon = falcon_at_centre();
    bus_.plug(falcon, {});
    auto device = open(",low_pass=0");
    EXPECT_TRUE(reaches(*device, *falcon, {0.1, -0.2, 0.0001}, {-1000, 2000, -1}));
    EXPECT_TRUE(reaches(*device, *falcon, {0.8192, -0.4096, 0.2048}, {-4096, 2048, -1024}))
        << "its direction stays";
    EXPECT_TRUE(reaches(*device, *falcon, {std::nan(""), HUGE_VAL, 0.1}, {0, 0, -1000}));
    device.reset();
    bus_.unplug("1-1");
    const auto strong = falcon_at_centre();
    bus_.plug(strong, {});
    const auto calibrated = open(",low_pass=0,force=20000");
    EXPECT_TRUE(reaches(*calibrated, *strong, {0.1, 0, 0}, {-2000, 0, 0}));
    EXPECT_NEAR(calibrated->link().effort_limit[0], 0.2048, 1e-12);
}

TEST_F(FalconOnABus, AForceAtTheTipPushesTheHandThatWay) {
    const auto falcon = falcon_at_centre();
    bus_.plug(falcon, {});
    bus_.locked([&] { falcon->compliant = true; });
    const auto device = open();
    TipPose pose;
    Jacobian jacobian;
    for (const Eigen::Vector3d& force :
         {Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(0, 2, 0), Eigen::Vector3d(0, 0, 2)}) {
        cycles(bus_, *device, 150, [&](ReadStatus, const JointSample& sample) {
            EXPECT_TRUE(device->mechanism().forward(std::span(sample.position).first(3), pose, jacobian));
            const Eigen::Vector3d torque = jacobian.topLeftCorner<3, 3>().transpose() * force;
            return JointEfforts{torque[0], torque[1], torque[2]};
        });
        EXPECT_GT(pose.position.normalized().dot(force.normalized()), 0.9) << pose.position.transpose();
    }
}

TEST_F(FalconOnABus, TheLowPassIsOnAt300HzUnlessToldOtherwiseAndNeverDelaysAZero) {
    struct {
        const char* option;
        double frequency;  // Hz
    } const cases[] = {{"", 300}, {",low_pass=20", 20}};
    for (const auto& [option, frequency] : cases) {
        SCOPED_TRACE(frequency);
        const auto falcon = falcon_at_centre();
        bus_.plug(falcon, {});
        auto device = open(option);
        EXPECT_NEAR(device->link().lag, 3e-3 + 1 / (2 * M_PI * frequency), 1e-12);
        JointSample sample;
        Nanoseconds now = 0;
        std::size_t looked_at = 0;
        const auto came = [&](double share) {
            const int wanted = -static_cast<int>(std::lround(1000 * share));
            return bus_.wait(200, [&] {
                const auto& requests = falcon->requests();
                while (looked_at < requests.size() && requests[looked_at].motors[0] != wanted) ++looked_at;
                return looked_at < requests.size();
            });
        };
        for (int i = 1; i <= 3; ++i) {
            device->read(now += millisecond, sample);
            device->write(now, {0.1, 0, 0});
            // 1 - exp(-2 pi f t), whatever the bus does meanwhile: time is the caller's.
            EXPECT_TRUE(came(1 - std::exp(-2 * M_PI * frequency * 1e-3 * i))) << i;
        }
        device->read(now += millisecond, sample);
        device->write(now, {});
        EXPECT_TRUE(came(0));
        device.reset();
        bus_.unplug("1-1");
    }
}

TEST_F(FalconOnABus, PushesNothingUntilItIsHomed) {
    const auto falcon = falcon_at_centre(true, false);
    bus_.plug(falcon, {});
    const auto device = open(",low_pass=0");
    JointSample seen;
    const auto push = [&](ReadStatus, const JointSample& sample) {
        seen = sample;
        return JointEfforts{0.1, 0.1, 0.1};
    };
    cycles(bus_, *device, 50, push);
    EXPECT_FALSE(seen.calibrated);
    bus_.locked([&] {
        EXPECT_TRUE(falcon->homing());
        EXPECT_EQ(falcon->leds(), 0x08) << "red";
        for (const MotorRequest& request : falcon->requests()) EXPECT_TRUE(request.is_zero());
        falcon->home();
    });
    EXPECT_TRUE(reaches(*device, *falcon, {0.1, 0.1, 0.1}, {-1000, -1000, -1000}));
    cycles(bus_, *device, 20, push);
    EXPECT_TRUE(seen.calibrated);
    EXPECT_FALSE(bus_.locked([&] { return falcon->homing(); }));
    bus_.locked([&] { falcon->lose_homing(); });
    EXPECT_TRUE(bus_.wait(500, [&] {
        JointSample sample;
        device->read(0, sample);
        device->write(0, {0.1, 0.1, 0.1});
        return falcon->requests().back().is_zero() && !sample.calibrated;
    }));
}

TEST_F(FalconOnABus, ShowsItsButtonsAndLightsItsLeds) {
    const auto falcon = falcon_at_centre();
    bus_.plug(falcon, {});
    const auto device = open();
    bus_.locked([&] { falcon->set_buttons(5); });
    JointSample seen;
    const auto rest = [&](ReadStatus, const JointSample& sample) {
        seen = sample;
        return JointEfforts{};
    };
    cycles(bus_, *device, 50, rest);
    EXPECT_EQ(seen.buttons, 5U);
    EXPECT_EQ(bus_.locked([&] { return falcon->leds(); }), 0x04) << "blue: at rest";
    device->notify(Notice::enabled);
    cycles(bus_, *device, 50, rest);
    EXPECT_EQ(bus_.locked([&] { return falcon->leds(); }), 0x02) << "green: force may come";
}

TEST_F(FalconOnABus, IsLeftAtZeroHoweverItIsLeft) {
    const auto falcon = falcon_at_centre();
    bus_.plug(falcon, {});
    {
        const auto device = open();
        EXPECT_TRUE(reaches(*device, *falcon, {0.1, 0.1, 0.1}, {-1000, -1000, -1000}));
        // A cycle that has stopped while its process lives.
        EXPECT_TRUE(bus_.wait(500, [&] { return falcon->motors() == std::array<int, 3>{}; }));
        EXPECT_TRUE(reaches(*device, *falcon, {0.1, 0.1, 0.1}, {-1000, -1000, -1000}));
        device->make_safe();
        EXPECT_TRUE(bus_.wait(500, [&] { return falcon->motors() == std::array<int, 3>{}; }));
        EXPECT_TRUE(reaches(*device, *falcon, {0.1, 0.1, 0.1}, {-1000, -1000, -1000}));
    }
    EXPECT_EQ(bus_.locked([&] { return falcon->motors(); }), (std::array<int, 3>{}));
}

}  // namespace
}  // namespace knurl::drivers
