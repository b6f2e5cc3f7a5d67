// WoodenHaptics and SpaceMouse: HID devices through libusb.

#include <gtest/gtest.h>

#include <knurl/drivers/arm_file.hpp>

#include "falcon_bench.hpp"
#include "spacemouse_model.hpp"
#include "wooden_model.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

class WoodenOnABus : public testing::Test {
  protected:
    Bus bus_;
    std::shared_ptr<WoodenModel> wooden_ = std::make_shared<WoodenModel>();
    void SetUp() override { bus_.plug(wooden_, {.serial = "POLHEM1"}); }

    template <class What>
    bool until(Device& device, const JointEfforts& efforts, What&& what) {
        for (int i = 0; i < 2000; ++i) {
            bool so = false;
            cycles(bus_, device, 1, [&](ReadStatus status, const JointSample& sample) {
                so = what(status, sample);
                return efforts;
            });
            if (so) return true;
        }
        return false;
    }
};

// x = cos A (Lb sin B + Lc sin C), y = sin A (...), z = Ln + Lb cos B - Lc cos C, as its makers publish it,
// from counts.
Eigen::Vector3d published(const std::array<int, 6>& counts) {
    constexpr double turn = 2 * M_PI / 2000;
    const double a = counts[0] * turn * 0.010 / 0.160, b = counts[1] * turn * 0.010 / 0.120,
                 c = counts[2] * turn * 0.010 / 0.120;
    const double reach = 0.205 * std::sin(b) + 0.245 * std::sin(c);
    return {std::cos(a) * reach, std::sin(a) * reach, 0.080 + 0.205 * std::cos(b) - 0.245 * std::cos(c)};
}

TEST_F(WoodenOnABus, TheTipIsWhereItsMakersSay) {
    const auto device = open_device("wooden:POLHEM1");
    EXPECT_TRUE(device->link().has_watchdog);
    EXPECT_EQ(device->link().watchdog_time, 0.5);
    EXPECT_EQ(bus_.bound_driver("1-1"), "") << "usbhid is detached";
    const auto tip = [&](const std::array<int, 6>& counts) {
        bus_.locked([&] { wooden_->counts = counts; });
        TipPose pose;
        Jacobian jacobian;
        // The second fresh sample is certainly one of these counts.
        int fresh = 0;
        EXPECT_TRUE(until(*device, {}, [&](ReadStatus status, const JointSample& sample) {
            fresh += status == ReadStatus::ok ? 1 : 0;
            EXPECT_TRUE(device->mechanism().forward(std::span(sample.position).first(3), pose, jacobian));
            return fresh > 8;
        }));
        return pose.position;
    };
    const std::array<int, 6> middle = {0, 2171, 3011, 0, 0, 0};
    const Eigen::Vector3d origin = tip(middle);
    for (const std::array<int, 6>& counts :
         {std::array<int, 6>{1000, 2000, 3000}, {-1500, 2600, 2500}, {300, 1500, 3500}}) {
        const Eigen::Vector3d moved = tip(counts) - origin;
        EXPECT_LT((moved - (published(counts) - published(middle))).norm(), 1e-9) << moved.transpose();
    }
}

TEST_F(WoodenOnABus, ItsHomeMayBeStatedAndDoesNotSurviveItsPower) {
    bus_.locked([&] { wooden_->counts = {77, -5, 12}; });
    const auto device = open_device("wooden:,home=0:32.57:45.16");
    JointSample seen;
    ASSERT_TRUE(until(*device, {}, [&](ReadStatus status, const JointSample& sample) {
        seen = sample;
        return status == ReadStatus::ok;
    }));
    EXPECT_TRUE(seen.calibrated);
    EXPECT_NEAR(seen.position[1], 32.57 * M_PI / 180, 1e-9);
    bus_.unplug("1-1");
    ASSERT_TRUE(until(*device, {},
                      [](ReadStatus status, const JointSample&) { return status == ReadStatus::unplugged; }));
    bus_.plug(wooden_, {.serial = "POLHEM1"});
    ASSERT_TRUE(until(*device, {0.1, 0.1, 0.1}, [&](ReadStatus status, const JointSample& sample) {
        seen = sample;
        return status == ReadStatus::ok;
    }));
    EXPECT_FALSE(seen.calibrated) << "it counts from wherever it was plugged in";
    until(*device, {0.1, 0.1, 0.1}, [n = 0](ReadStatus, const JointSample&) mutable { return ++n > 50; });
    EXPECT_EQ(bus_.locked([&] { return wooden_->motors(); }), (std::array<int, 3>{}));
}

TEST_F(WoodenOnABus, EffortsBecomeMilliamperesScaledTogetherAndTheWatchdogHearsThem) {
    {
        const auto device = open_device("wooden:");
        const auto& limit = device->link().effort_limit;
        const auto reaches = [&](const JointEfforts& efforts, const std::array<int, 3>& milliamperes) {
            return until(*device, efforts, [&](ReadStatus, const JointSample&) {
                return bus_.locked([&] { return wooden_->motors() == milliamperes; });
            });
        };
        EXPECT_TRUE(reaches({414.4e-6 * 100, -310.8e-6 * 200, 0}, {100, -200, 0}));
        EXPECT_TRUE(reaches({2 * limit[0], limit[1], 0}, {3000, 1500, 0}));
        EXPECT_TRUE(reaches({std::nan(""), 310.8e-6, 0}, {0, 1, 0}));
        until(*device, {0.1}, [n = 0](ReadStatus, const JointSample&) mutable { return ++n > 700; });
        EXPECT_EQ(bus_.locked([&] { return wooden_->tripped_at(); }), 0U);
    }
    EXPECT_EQ(bus_.locked([&] { return wooden_->motors(); }), (std::array<int, 3>{}));
}

TEST_F(WoodenOnABus, ShortReportsAreBadAndACableThatIsPulledIsSeen) {
    const auto device = open_device("wooden:");
    bus_.locked([&] { wooden_->faults.short_packets = 5; });
    const auto is = [](ReadStatus wanted) {
        return [wanted](ReadStatus status, const JointSample&) { return status == wanted; };
    };
    EXPECT_TRUE(until(*device, {}, is(ReadStatus::bad)));
    EXPECT_TRUE(until(*device, {}, is(ReadStatus::ok)));
    bus_.locked([&] { wooden_->faults.silent = true; });
    EXPECT_TRUE(until(*device, {}, is(ReadStatus::stale)));
    bus_.unplug("1-1");
    EXPECT_TRUE(until(*device, {}, is(ReadStatus::unplugged)));
}

// Nothing in a report of the right length tells noise from counts.
TEST_F(WoodenOnABus, NoiseInPlaceOfReportsMovesItForAsLongAsItLasts) {
    bus_.locked([&] { wooden_->counts = {32000, -32000, 100}; });
    const auto device = open_device("wooden:,home=0:20:38");
    const auto seen = [&] {
        JointSample last;
        int fresh = 0;
        EXPECT_TRUE(until(*device, {}, [&](ReadStatus status, const JointSample& sample) {
            last = sample;
            fresh += status == ReadStatus::ok ? 1 : 0;
            return fresh > 8;  // the eighth is certainly newer than what was done to the model before
        }));
        return last.position;
    };
    const JointArray before = seen();
    for (int i = 0; i < 8; ++i) {
        bus_.locked([&] { wooden_->faults.garbage_replies = 5 + i; });
        ASSERT_TRUE(bus_.wait(1000, [&] { return wooden_->faults.garbage_replies == 0; }));
        EXPECT_EQ(seen(), before);
    }
    bus_.locked([&] { wooden_->counts = {33000 - 65536, 65536 - 33000, 100}; });
    const JointArray after = seen();
    const auto& link = device->link();
    EXPECT_NEAR(after[0] - before[0], 1000 * link.radians_per_count[0], 1e-12) << "over the end of 16 bits";
    EXPECT_NEAR(after[1] - before[1], -1000 * link.radians_per_count[1], 1e-12);
}

TEST_F(WoodenOnABus, ATeensyThatIsNoPolhemIsRefused) {
    bus_.locked([&] { wooden_->faults.silent = true; });
    EXPECT_THROW(open_device("wooden:"), std::runtime_error);
    EXPECT_THROW(open_device("wooden:,home=1:2"), std::runtime_error);
    EXPECT_THROW(open_device("wooden:,arm=generic6"), std::runtime_error);
}

class SpaceMouseOnABus : public testing::TestWithParam<bool> {
  protected:
    Bus bus_;
    std::shared_ptr<SpaceMouseModel> mouse_ = std::make_shared<SpaceMouseModel>(GetParam());
    void SetUp() override { bus_.plug(mouse_, {}); }

    /// The probe after so many milliseconds of the caller's clock.
    TipPose after(Device& device, int ms) {
        TipPose pose;
        Jacobian jacobian;
        for (int i = 0; i < ms; ++i) {
            EXPECT_EQ(device.read(now_ += millisecond, sample_), ReadStatus::ok) << "silence is no fault";
            EXPECT_TRUE(device.mechanism().forward(sample_.position, pose, jacobian));
            EXPECT_TRUE(device.write(now_, {}));
            EXPECT_LE(Eigen::Map<Eigen::Vector3d>(sample_.velocity.data()).norm(), 0.5 + 1e-9);
        }
        return pose;
    }
    /// Waits until reads have seen the cap's last report.
    void push(Device& device, const std::array<int, 3>& translation, const std::array<int, 3>& rotation) {
        static std::uint8_t buttons = 0;
        bus_.locked([&] {
            mouse_->push(translation, rotation);
            mouse_->press(++buttons);
        });
        EXPECT_TRUE(bus_.wait(2000, [&] {
            device.read(now_, sample_);
            return sample_.buttons == buttons;
        }));
    }

    Nanoseconds now_ = 0;
    JointSample sample_;
};

INSTANTIATE_TEST_SUITE_P(Reports, SpaceMouseOnABus, testing::Bool(), [](const auto& all_in_one) {
    return all_in_one.param ? "AllInOne" : "TranslationAndRotation";
});

TEST_P(SpaceMouseOnABus, TheCapsPlaceIsTheProbes) {
    const auto device = open_device("spacemouse:,range=0.05,turn=0.5");
    EXPECT_TRUE(device->link().senses_orientation);
    EXPECT_EQ(device->link().actuated_joints, 0);
    EXPECT_TRUE(after(*device, 10).position.isZero());
    push(*device, {350, 0, 0}, {0, 0, -175});
    TipPose pose = after(*device, 1000);
    EXPECT_TRUE(pose.position.isApprox(Eigen::Vector3d(0.05, 0, 0), 1e-6)) << pose.position.transpose();
    EXPECT_NEAR(Eigen::AngleAxisd(pose.orientation).angle(), 0.25, 1e-6);
    EXPECT_GT(pose.orientation.z(), 0) << "the device's z points down";
    push(*device, {0, 350, -350}, {0, 0, 0});
    pose = after(*device, 1000);
    EXPECT_TRUE(pose.position.isApprox(0.05 * Eigen::Vector3d(0, -1, 1).normalized(), 1e-6))
        << pose.position.transpose();
    push(*device, {0, 0, 0}, {0, 0, 0});
    EXPECT_LT(after(*device, 1000).position.norm(), 1e-9) << "let go, it comes back";
}

TEST_P(SpaceMouseOnABus, AsARateTheProbeStaysWhereItIsLetGo) {
    const auto device = open_device("spacemouse:,rate=on,speed=0.1,range=0.05");
    after(*device, 2);
    push(*device, {0, 0, -175}, {0, 0, 0});
    after(*device, 400);
    push(*device, {0, 0, 0}, {0, 0, 0});
    const TipPose pose = after(*device, 100);
    EXPECT_NEAR(pose.position.z(), 0.02, 1e-9);
    EXPECT_NEAR(sample_.velocity[2], 0, 1e-12);
    push(*device, {0, 0, -350}, {0, 0, 0});
    EXPECT_NEAR(after(*device, 2000).position.norm(), 0.05, 1e-9) << "the edge of its workspace";
}

TEST_P(SpaceMouseOnABus, ReportsThatAreNotItsOwnDoNoHarm) {
    const auto device = open_device("spacemouse:");
    after(*device, 5);
    bus_.locked([&] {
        mouse_->send({1, 2});
        mouse_->send({});
        mouse_->send({23, 80});
        mouse_->send({3});
    });
    for (int i = 0; i < 300; ++i) {
        device->read(now_ += millisecond, sample_);
        EXPECT_TRUE(std::isfinite(sample_.position[0]));
    }
    push(*device, {0, 0, 0}, {0, 0, 0});
    bus_.unplug("1-1");
    EXPECT_TRUE(bus_.wait(2000, [&] { return device->read(now_, sample_) == ReadStatus::unplugged; }));
    bus_.plug(mouse_, {});
    EXPECT_TRUE(bus_.wait(2000, [&] { return device->read(now_, sample_) == ReadStatus::ok; }))
        << "one without a serial number is known by its port";
}

}  // namespace
}  // namespace knurl::drivers
