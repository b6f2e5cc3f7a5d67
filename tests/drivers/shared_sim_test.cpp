// The simulated device in a separate process: its log contains what servo and guardian write.

#include "shared_sim.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/drivers/sim_profile.hpp>

#include "../refusal.hpp"

namespace knurl::drivers::shared_sim {
namespace {

class SharedSim : public testing::Test {
  protected:
    static constexpr std::uint64_t capacity = 1 << 14;
    std::string path_ = file_in_memory("knurl-shared-sim", capacity);
    ~SharedSim() override { std::filesystem::remove(path_); }

    FakeDevice::Settings settings(const std::string& profile = "cartesian3") const {
        return {.path = path_, .profile = profile, .capacity = capacity};
    }
    /// Waits (on the device's own clock) for a record that satisfies the predicate.
    template <class Predicate>
    static bool appears(const FakeDevice& fake, Predicate predicate) {
        for (int look = 0; look < 200; ++look) {
            if (std::ranges::any_of(fake.log(), predicate)) {
                return true;
            }
            if (!fake.wait_steps(10)) {
                return false;
            }
        }
        return false;
    }
};

TEST(Words, KeepEveryValueTheyHold) {
    std::mt19937_64 engine(8);
    for (int trial = 0; trial < 10000; ++trial) {
        const std::uint64_t random = engine();
        const EffortWord efforts = EffortWord::unpack(random);
        EXPECT_EQ(efforts.pack(), random);
        std::array<std::int64_t, joints> counts{};
        for (std::int64_t& count : counts) {
            count = static_cast<std::int64_t>(engine() % (1 << 21)) - (1 << 20);
        }
        const std::uint64_t word = pack_counts(counts, trial % 2 == 0);
        EXPECT_EQ(word >> 63, static_cast<std::uint64_t>(trial % 2 == 0));
        for (std::size_t i = 0; i < joints; ++i) {
            EXPECT_EQ(unpack_count(word, i), counts[i]);
        }
    }
    EXPECT_EQ(unpack_count(pack_counts({1 << 30, -(1 << 30), 0}, false), 0), (1 << 20) - 1) << "saturates";
}

TEST_F(SharedSim, IsADeviceLikeAnyOther) {
    enrol();
    const FakeDevice fake(KNURL_FAKE_DEVICE, settings("premium15"));
    const auto device = open_device(fake.address());
    EXPECT_EQ(device->link().name, "premium15");
    EXPECT_EQ(device->link().peak_force, 8.5);
    JointSample sample;
    ASSERT_TRUE(fake.wait_steps(2));
    EXPECT_EQ(device->read(0, sample), ReadStatus::ok);
    TipPose pose;
    Jacobian jacobian;
    ASSERT_TRUE(device->mechanism().forward(sample.position, pose, jacobian));
    EXPECT_LT(pose.position.norm(), 1e-4) << "in the centre, where its hand holds it";
}

TEST_F(SharedSim, MovesUnderAForceAndLogsIt) {
    enrol();
    const FakeDevice fake(KNURL_FAKE_DEVICE, settings());
    const auto device = open_device(fake.address());
    JointSample sample;
    const double effort = 1000.0 / 32767 * 8.5;
    device->read(0, sample);
    EXPECT_TRUE(device->write(0, {effort, 0, -effort}));
    ASSERT_TRUE(appears(fake, [&](const Record& r) {
        return r.event == Event::servo_write && std::abs(r.effort[0] - effort) < 1e-12 &&
               std::abs(r.force[2] + effort) < 1e-12;
    }));
    for (int i = 0; i < 200 && sample.position[0] < 0.5e-3; ++i) {
        ASSERT_TRUE(fake.wait_steps(20));
        device->read(0, sample);
    }
    EXPECT_GT(sample.position[0], 0.5e-3) << "0.26 N against 200 N/m: 1.3 mm in the end";
    const auto log = fake.log();
    EXPECT_TRUE(std::ranges::is_sorted(log, {}, &Record::t));
}

TEST_F(SharedSim, LogsEachChangeOnceAndCountsWritesThatItMissed) {
    enrol();
    const FakeDevice fake(KNURL_FAKE_DEVICE, settings());
    const auto device = open_device(fake.address());
    device->write(0, {1});
    ASSERT_TRUE(fake.wait_steps(3));
    const std::size_t records = fake.log().size();
    for (int i = 0; i < 5; ++i) {
        device->write(0, {1});
        ASSERT_TRUE(fake.wait_steps(3));
    }
    EXPECT_EQ(fake.log().size(), records) << "equal efforts are no change";
    EXPECT_EQ(fake.mapping()->writes.load(), 6U) << "but they are counted";
    // A burst faster than its looks: what it did not see is in `missed`.
    for (int i = 1; i <= 500; ++i) {
        device->write(0, {i % 2 == 0 ? 1.0 : 2.0});
    }
    device->write(0, {3});
    ASSERT_TRUE(appears(fake, [](const Record& r) { return std::abs(r.effort[0] - 3) < 1e-3; }));
    EXPECT_EQ(fake.mapping()->writes.load(), 6U + 501U);
}

TEST_F(SharedSim, AForkedGuardianZeroesItAfterTheServoWasKilled) {
    enrol();
    const FakeDevice fake(KNURL_FAKE_DEVICE, settings());
    int died[2];
    ASSERT_EQ(pipe(died), 0);
    // servo: opens the device, forks the guardian, writes a force, and is killed in the middle of its loop.
    const pid_t servo = fork();
    if (servo == 0) {
        const auto device = open_device(fake.address());
        close(died[0]);
        int lives[2];
        if (pipe(lives) != 0) _exit(1);
        const pid_t guardian = fork();
        if (guardian == 0) {
            close(lives[1]);
            char nothing;
            while (read(lives[0], &nothing, 1) > 0) {  // ends with the servo
            }
            device->make_safe();
            _exit(0);
        }
        for (std::uint64_t i = 0;; ++i) {
            device->write(0, {1 + 0.01 * static_cast<double>(i % 7)});
        }
    }
    close(died[1]);
    ASSERT_TRUE(appears(fake, [](const Record& r) { return r.effort[0] > 0.9; }));
    kill(servo, SIGKILL);
    waitpid(servo, nullptr, 0);
    ASSERT_TRUE(appears(fake, [](const Record& r) { return r.event == Event::guardian_write; }));
    char nothing;
    EXPECT_EQ(read(died[0], &nothing, 1), 0) << "the guardian too is gone";
    close(died[0]);
    ASSERT_TRUE(fake.wait_steps(5));
    const Record last = fake.log().back();
    EXPECT_EQ(last.event, Event::guardian_write);
    EXPECT_EQ(last.effort, (std::array<double, 3>{}));
}

TEST_F(SharedSim, LeavesItsMotorsAtZeroWhenTheServoClosesIt) {
    enrol();
    const FakeDevice fake(KNURL_FAKE_DEVICE, settings());
    {
        const auto device = open_device(fake.address());
        device->write(0, {2});
        ASSERT_TRUE(appears(fake, [](const Record& r) { return r.effort[0] > 1; }));
    }
    ASSERT_TRUE(fake.wait_steps(3));
    EXPECT_EQ(fake.log().back().event, Event::servo_write);
    EXPECT_EQ(fake.log().back().effort, (std::array<double, 3>{}));
}

TEST_F(SharedSim, ATestCanUnplugAndStallIt) {
    enrol();
    FakeDevice fake(KNURL_FAKE_DEVICE, settings());
    const auto device = open_device(fake.address());
    JointSample sample;
    device->write(0, {1});
    ASSERT_TRUE(appears(fake, [](const Record& r) { return r.effort[0] > 0.9; }));
    fake.control(control_unplug);
    ASSERT_TRUE(fake.wait_steps(3));
    EXPECT_EQ(device->read(0, sample), ReadStatus::unplugged);
    EXPECT_FALSE(device->write(0, {1}));
    EXPECT_EQ(fake.log().back().event, Event::unplugged);
    fake.control(0);
    ASSERT_TRUE(fake.wait_steps(3));
    EXPECT_EQ(device->read(0, sample), ReadStatus::ok);
    fake.control(control_stall);
    while (fake.mapping()->obeyed.load(std::memory_order_acquire) != control_stall) sched_yield();
    device->read(0, sample);  // the last one
    EXPECT_EQ(device->read(0, sample), ReadStatus::stale);
}

TEST_F(SharedSim, PassesNoticesToItsHand) {
    enrol();
    const std::string hand = path_ + ".csv";
    std::ofstream(hand) << "0,0.02,0,0\n5,0.06,0,0\n";
    FakeDevice::Settings with_hand = settings();
    with_hand.hand_file = hand;
    const FakeDevice fake(KNURL_FAKE_DEVICE, with_hand);
    const auto device = open_device(fake.address());
    device->notify(Notice::claim_active);
    EXPECT_TRUE(appears(fake, [](const Record& r) { return r.event == Event::hand_begins; }));
    device->notify(Notice::disabled);
    EXPECT_TRUE(appears(fake, [](const Record& r) { return r.event == Event::hand_rests; }));
    std::filesystem::remove(hand);
}

TEST_F(SharedSim, ItsWatchdogIsInTheLog) {
    enrol();
    const FakeDevice fake(KNURL_FAKE_DEVICE, settings("cartesian3,watchdog=0.02"));
    const auto device = open_device(fake.address());
    EXPECT_TRUE(device->link().has_watchdog);
    device->write(0, {1});
    EXPECT_TRUE(
        appears(fake, [](const Record& r) { return r.event == Event::watchdog && r.effort[0] == 0; }));
}

TEST_F(SharedSim, ItsLogSurvivesItsOwnKill) {
    enrol();
    const FakeDevice fake(KNURL_FAKE_DEVICE, settings());
    const auto device = open_device(fake.address());
    device->write(0, {1});
    ASSERT_TRUE(appears(fake, [](const Record& r) { return r.effort[0] > 0.9; }));
    kill(fake.pid(), SIGKILL);
    waitpid(fake.pid(), nullptr, 0);
    const Mapping again(path_);
    EXPECT_GT(read_log(again).back().effort[0], 0.9);
}

TEST_F(SharedSim, SaysWhatIsMissing) {
    enrol();
    const auto refusal = [](const std::string& address) -> std::string {
        return test::refusal_of([&] { open_device(address); });
    };
    EXPECT_EQ(refusal("shared-sim:" + path_),
              path_ + ": No such file or directory; start knurl-fake-device " + path_);
    std::ofstream(path_) << std::string(100'000, 'x');
    EXPECT_EQ(refusal("shared-sim:" + path_), path_ + " is not the file of a knurl-fake-device");
    EXPECT_THROW(FakeDevice(KNURL_FAKE_DEVICE, settings("generic6")), std::runtime_error)
        << "six joints do not fit";
}

}  // namespace
}  // namespace knurl::drivers::shared_sim
