// Faults of a cable, and what the cycle sees then. SAFETY's rows "device unplugged" and "USB time-out, short
// or garbage packets" end in the servo (ReadStatus -> Hand -> Supervisor). This is the driver's half: every
// fault shows as what it is, and no effort outlives it.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include <sched.h>

#include "../../rights.hpp"
#include "motor_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

class Faults : public testing::TestWithParam<MotorDevice> {
  protected:
    Bus bus_;
    std::shared_ptr<MotorModel> model_ = GetParam().make();
    static constexpr JointEfforts push = {0.1, 0.1, 0.1};
    const std::array<int, 3> pushed = GetParam().all(0.1);
    Nanoseconds now_ = 0;

    static std::unique_ptr<Device> open() { return open_device(GetParam().address); }
    void SetUp() override { plug_in(); }
    void plug_in() { usb_emulator::plug_in(bus_, GetParam(), model_); }

    /// One cycle.
    ReadStatus step(Device& device, const JointEfforts& efforts) {
        const ReadStatus status = device.read(now_ += millisecond, sample_);
        device.write(now_, efforts);
        const std::uint64_t frame = bus_.frame();
        bus_.wait(1, [&] { return bus_.frame() > frame; });
        return status;
    }
    /// Cycles until a read says so; false after so many.
    bool until(Device& device, ReadStatus wanted, int most = 3000, const JointEfforts& efforts = {}) {
        for (int i = 0; i < most; ++i)
            if (step(device, efforts) == wanted) return true;
        return false;
    }
    bool pushes(Device& device) {
        for (int i = 0; i < 500; ++i) {
            step(device, push);
            if (bus_.locked([&] { return model_->motors() == pushed; })) return true;
        }
        return false;
    }

    JointSample sample_;
};
INSTANTIATE_TEST_SUITE_P(Devices, Faults, each_motor_device(), name_of);

/// Faults that only its protocol has, or can detect.
class FaultsOfAFalcon : public Faults {};
INSTANTIATE_TEST_SUITE_P(Devices, FaultsOfAFalcon, testing::Values(falcon_device), name_of);

TEST_P(FaultsOfAFalcon, GarbageIsBadAndTheSampleBeforeItStays) {
    const auto device = open();
    ASSERT_TRUE(until(*device, ReadStatus::ok));
    const JointSample before = sample_;
    bus_.locked([&] { model_->faults.garbage_replies = 1 << 20; });
    EXPECT_TRUE(until(*device, ReadStatus::bad));
    int bad = 0;
    for (int i = 0; i < 200; ++i) {
        const ReadStatus status = step(*device, {});
        EXPECT_TRUE(status == ReadStatus::bad || status == ReadStatus::stale);
        bad += status == ReadStatus::bad ? 1 : 0;
    }
    EXPECT_GE(bad, 10) << "as many as the servo faults at";
    EXPECT_EQ(sample_.position, before.position);
    bus_.locked([&] { model_->faults.garbage_replies = 0; });
    EXPECT_TRUE(until(*device, ReadStatus::ok));
}

TEST_P(Faults, ShortPacketsAreBad) {
    const auto device = open();
    ASSERT_TRUE(until(*device, ReadStatus::ok));
    bus_.locked([&] { model_->faults.short_packets = 20; });
    EXPECT_TRUE(until(*device, ReadStatus::bad));
    EXPECT_TRUE(until(*device, ReadStatus::ok));
}

TEST_P(FaultsOfAFalcon, FragmentsAreNoFault) {
    bus_.locked([&] { dynamic_cast<Falcon&>(*model_).chip.fragment = 5; });
    const auto device = open();
    ASSERT_TRUE(until(*device, ReadStatus::ok));
    for (int i = 0; i < 300; ++i) EXPECT_NE(step(*device, {}), ReadStatus::bad);
    EXPECT_TRUE(until(*device, ReadStatus::ok));
}

/// Until the halt is cleared, a stalled endpoint answers every request with a stall.
TEST_P(Faults, AStalledEndpointIsFreedAndCarriesOn) {
    const auto device = open();
    ASSERT_TRUE(pushes(*device));
    for (int i = 0; i < 20; ++i) {
        bus_.locked([&] {
            model_->stalls_out = i % 2;
            model_->stalls_in = 1 - i % 3 % 2;
        });
        const double effort = 0.05 + 0.01 * (i % 2);
        const auto obeyed = [&] { return model_->motors() == GetParam().all(effort); };
        for (int k = 0; k < 500 && !bus_.locked(obeyed); ++k) {
            const ReadStatus status = step(*device, {effort, effort, effort});
            EXPECT_TRUE(status == ReadStatus::ok || status == ReadStatus::stale);
        }
        EXPECT_TRUE(bus_.locked(obeyed)) << "round " << i;
        EXPECT_TRUE(until(*device, ReadStatus::ok, 100, {effort, effort, effort})) << "round " << i;
        EXPECT_EQ(bus_.locked([&] { return model_->stalls_out + model_->stalls_in; }), 0);
    }
}

TEST_P(Faults, AZeroThatMetAStallIsSentAgain) {
    const auto device = open();
    ASSERT_TRUE(pushes(*device));
    bus_.locked([&] { model_->stalls_out = 1; });
    device->make_safe();
    EXPECT_TRUE(bus_.wait(1000, [&] { return model_->motors() == std::array<int, 3>{}; }));
    EXPECT_EQ(bus_.locked([&] { return model_->stalls_out; }), 0);
}

TEST_P(Faults, AZeroThatMeetsAStallAtTheEndIsSentAgain) {
    auto device = open();
    ASSERT_TRUE(pushes(*device));
    bus_.freeze(true);
    bus_.locked([&] { model_->stalls_out = 1; });
    std::thread closing([&] { device.reset(); });
    while (bus_.in_flight("1-1") > 1) std::this_thread::yield();  // it cancels its requests in flight
    bus_.freeze(false);
    closing.join();
    EXPECT_TRUE(bus_.wait(1000, [&] { return model_->motors() == std::array<int, 3>{}; }));
    bus_.locked(
        [&] { EXPECT_TRUE(model_->requests().back().is_zero()) << "it was not told: its watchdog did it"; });
}

TEST_P(Faults, OneThatStallsForEverIsOpenedAnew) {
    const auto device = open();
    ASSERT_TRUE(pushes(*device));
    bus_.locked([&] { model_->stalls_in = 1 << 20; });
    EXPECT_TRUE(until(*device, ReadStatus::unplugged, 3000, push));
    bus_.locked([&] { model_->stalls_in = 0; });
    EXPECT_TRUE(until(*device, ReadStatus::ok));
}

/// As left by a program that died during a stall, or by an earlier session of this one.
TEST_P(Faults, OneThatWasLeftHaltedIsOpened) {
    bus_.locked([&] { model_->stalls_in = model_->stalls_out = 1; });
    const auto device = open();
    EXPECT_TRUE(until(*device, ReadStatus::ok));
    EXPECT_TRUE(pushes(*device));
}

TEST_P(Faults, SilenceIsStale) {
    const auto device = open();
    ASSERT_TRUE(until(*device, ReadStatus::ok));
    bus_.locked([&] { model_->faults.silent = true; });
    ASSERT_TRUE(until(*device, ReadStatus::stale));
    constexpr int on_their_way = 4;  // at most, however late this machine runs the driver
    int fresh = 0;
    for (int i = 0; i < 100; ++i) {
        const ReadStatus status = step(*device, {});
        fresh += status == ReadStatus::ok ? 1 : 0;
        EXPECT_TRUE(status == ReadStatus::stale || status == ReadStatus::ok);
    }
    EXPECT_LE(fresh, on_their_way);
    EXPECT_EQ(step(*device, {}), ReadStatus::stale);
    bus_.locked([&] { model_->faults.silent = false; });
    EXPECT_TRUE(until(*device, ReadStatus::ok));
}

TEST_P(Faults, OrdersDoNotPileUpBeforeADeviceThatTakesNone) {
    const auto device = open();
    ASSERT_TRUE(until(*device, ReadStatus::ok));
    bus_.locked([&] { model_->faults.stuck = true; });
    for (int i = 0; i < 200; ++i) step(*device, {0.001 * (i + 1), 0, 0});
    std::size_t before = 0;
    bus_.locked([&] {
        before = model_->requests().size();
        model_->faults.stuck = false;
    });
    // Those that were in flight, then the newest: nothing of what lies between.
    const std::size_t in_flight = kept_of_efforts(*model_);
    step(*device, {0.2, 0, 0});
    ASSERT_TRUE(bus_.wait(2000, [&] { return model_->requests().size() > before + in_flight; }));
    bus_.locked([&] {
        const auto& requests = model_->requests();
        for (std::size_t i = before; i < before + in_flight; ++i)
            EXPECT_LT(std::abs(requests[i].motors[0]), std::abs(pushed[0]));
        const int next = requests[before + in_flight].motors[0];
        EXPECT_TRUE(next == GetParam().all(0.2)[0] || next == 0)
            << next << " (0: the cycle has been silent for 10 ms)";
    });
}

TEST_P(Faults, AnEncoderThatSlipsIsReportedAsItIs) {
    const auto device = open();
    ASSERT_TRUE(until(*device, ReadStatus::ok));
    const double before = sample_.position[0];
    bus_.locked([&] { model_->slip(0, 400); });
    for (int i = 0; i < 200 && sample_.position[0] == before; ++i) step(*device, {});
    EXPECT_NEAR(sample_.position[0] - before, 400 * device->link().radians_per_count[0], 1e-9)
        << "to reject it is the servo's";
}

TEST_P(Faults, UnpluggedIsSeenAndPluggedInAgainItIsFoundWithMotorsAtZero) {
    const auto device = open();
    ASSERT_TRUE(pushes(*device));
    bus_.unplug("1-1");
    ASSERT_TRUE(until(*device, ReadStatus::unplugged, 500, push));
    EXPECT_FALSE(device->write(now_, push));
    EXPECT_FALSE(sample_.calibrated);

    const auto stranger = GetParam().make();
    usb_emulator::plug_in(bus_, GetParam(), stranger, "1-1", "OTHER");
    std::size_t heard = 0;
    bus_.locked([&] { heard = model_->requests().size(); });
    usb_emulator::plug_in(bus_, GetParam(), model_, "1-3");
    ASSERT_TRUE(until(*device, ReadStatus::ok, 5000)) << "by its serial number, wherever it is";
    EXPECT_EQ(sample_.calibrated, GetParam().homed_after_replug);
    EXPECT_TRUE(stranger->requests().empty());
    for (int i = 0; i < 50; ++i) step(*device, {});
    bus_.locked([&] {
        for (std::size_t i = heard; i < model_->requests().size(); ++i)
            EXPECT_TRUE(model_->requests()[i].is_zero()) << "nothing of what was ordered before";
    });
    EXPECT_EQ(pushes(*device), GetParam().homed_after_replug) << "and otherwise never";
}

/// Searching for a device takes milliseconds at a time, which another device may need.
TEST_P(Faults, WhoLooksForALostDeviceStandsBelowTheServo) {
    constexpr int priority = 56;
    KNURL_NEEDS(test::missing_real_time(priority));
    const auto device =
        open_device(GetParam().address, {.hand_file = "", .seed = 1, .io_priority = priority});
    const auto now_at = [] {
        for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
            std::string name;
            std::ifstream(task.path() / "comm") >> name;
            sched_param of{};
            if (name == "knurl-usb" && sched_getparam(std::stoi(task.path().filename()), &of) == 0)
                return of.sched_priority;
        }
        return -1;
    };
    ASSERT_TRUE(pushes(*device));
    ASSERT_EQ(now_at(), priority);
    bus_.unplug("1-1");
    ASSERT_TRUE(until(*device, ReadStatus::unplugged));
    EXPECT_TRUE(bus_.wait(5000, [&] { return now_at() == 1; }));
    plug_in();
    ASSERT_TRUE(until(*device, ReadStatus::ok, 5000));
    EXPECT_TRUE(bus_.wait(5000, [&] { return now_at() == priority; }));
}

TEST_P(Faults, GoneAndBackBetweenTwoReadsIsStillSaid) {
    const auto device = open();
    ASSERT_TRUE(pushes(*device));
    bus_.unplug("1-1");
    plug_in();
    // Until it has been opened again, which takes no read.
    std::size_t heard = 0;
    bus_.locked([&] { heard = model_->requests().size(); });
    ASSERT_TRUE(bus_.wait(5000, [&] { return model_->requests().size() > heard + 3; }));
    // A cycle that was running at that time writes an effort for the old device.
    EXPECT_FALSE(device->write(now_, push));
    const std::uint64_t soon = bus_.frame() + 30;
    bus_.wait(5000, [&] { return bus_.frame() > soon; });
    bus_.locked([&] {
        for (std::size_t i = heard; i < model_->requests().size(); ++i)
            EXPECT_TRUE(model_->requests()[i].is_zero());
    });
    EXPECT_EQ(step(*device, push), ReadStatus::unplugged);
    EXPECT_TRUE(until(*device, ReadStatus::ok));
}

TEST_P(Faults, OnceMadeSafeItIsNotPushedByWhatWasOrderedBefore) {
    const auto device = open();
    ASSERT_TRUE(pushes(*device));
    bus_.freeze(true);
    const std::size_t on_their_way = kept_of_efforts(*model_);  // so that the next order has to wait
    while (bus_.in_flight("1-1") < kept_for_samples + on_their_way) {
        device->read(now_ += millisecond, sample_);
        device->write(now_, push);
    }
    const std::size_t before = bus_.locked([&] { return model_->requests().size(); });
    device->read(now_ += millisecond, sample_);
    device->write(now_, {0.2, 0.2, 0.2});
    device->make_safe();
    bus_.freeze(false);
    ASSERT_TRUE(bus_.wait(5000, [&] { return model_->requests().size() > before + 4; }));
    bus_.locked([&] {
        EXPECT_EQ(model_->requests()[before].motors, pushed);
        for (std::size_t i = before + on_their_way; i < model_->requests().size(); ++i)
            EXPECT_TRUE(model_->requests()[i].is_zero()) << "packet " << i - before;
    });
    EXPECT_TRUE(pushes(*device)) << "orders after it count again";
}

TEST_P(FaultsOfAFalcon, AFalconThatLostItsFirmwareWithThePowerIsBootedAgain) {
    bus_.unplug("1-1");
    const TemporaryFile firmware(made_up_firmware());
    model_ = falcon_at_centre(false);
    plug_in();
    const auto device = open_device("falcon:,low_pass=0,firmware=" + firmware.path());
    ASSERT_TRUE(pushes(*device));
    bus_.unplug("1-1");
    ASSERT_TRUE(until(*device, ReadStatus::unplugged));
    plug_in();
    ASSERT_TRUE(until(*device, ReadStatus::ok, 10000));
    EXPECT_EQ(bus_.locked([&] { return dynamic_cast<Falcon&>(*model_).boots(); }), 2);
}

// The long form: KNURL_USB_UNPLUGS=1000 (scripts/usb).
TEST_P(Faults, ThePlugMayBePulledInTheMiddleOfAnyTransfer) {
    const char* asked = std::getenv("KNURL_USB_UNPLUGS");
    const int times = asked != nullptr ? std::atoi(asked) : 50;
    const unsigned seed = 20240607;
    std::mt19937 random(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    bus_.unplug("1-1");
    int closed_at_once = 0;
    for (int i = 0; i < times; ++i) {
        model_ = GetParam().make();
        const bool stuck = random() % 3 == 0;  // with packets on their way to it
        plug_in();
        const auto device = open();
        const auto cycles = static_cast<int>(random() % 6);
        for (int k = 0; k < cycles; ++k) step(*device, push);
        if (stuck) bus_.locked([&] { model_->faults.stuck = true; });
        for (int k = 0; k < 2; ++k) {
            device->read(now_ += millisecond, sample_);
            device->write(now_, push);
        }
        bus_.unplug("1-1");
        if (random() % 4 == 0) {  // and the program ends as well
            ++closed_at_once;
            continue;
        }
        ASSERT_TRUE(until(*device, ReadStatus::unplugged, 5000)) << "time " << i;
        if (random() % 4 != 0) continue;
        model_ = GetParam().make();
        plug_in();
        ASSERT_TRUE(until(*device, ReadStatus::ok, 5000)) << "time " << i;
        bus_.unplug("1-1");
    }
    std::printf("%d times unplugged, %d of them closed at once\n", times, closed_at_once);
}

TEST_P(Faults, OneThatFailsLeavesTheOtherAlone) {
    const auto other = GetParam().make();
    usb_emulator::plug_in(bus_, GetParam(), other, "1-2", "OTHER");
    const auto failing = open();
    const auto working = open_device(GetParam().other);
    ASSERT_TRUE(until(*failing, ReadStatus::ok));
    ASSERT_TRUE(until(*working, ReadStatus::ok));
    bus_.locked([&] { model_->faults = {.garbage_replies = 100, .stuck = true}; });
    constexpr int half = 20, most = 20000;
    int fresh = 0;
    bool pulled = false;
    for (int i = 0; i < most && fresh < 2 * half; ++i) {
        if (!pulled && fresh == half) {
            bus_.unplug("1-1");
            pulled = true;
        }
        failing->read(now_, sample_);
        failing->write(now_, push);
        const ReadStatus status = step(*working, push);
        EXPECT_TRUE(status == ReadStatus::ok || status == ReadStatus::stale);
        fresh += status == ReadStatus::ok ? 1 : 0;
    }
    EXPECT_EQ(fresh, 2 * half);
    EXPECT_TRUE(bus_.wait(1000, [&] { return other->motors() == pushed; }));
}

}  // namespace
}  // namespace knurl::drivers
