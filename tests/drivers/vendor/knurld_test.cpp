// A real knurld whose device is behind knurl-device and a counterfeit of its maker's library; an application renders a
// wall through it. Then each of the processes dies. The oracle is the counterfeit's own log, by its own clock.

#include <cmath>
#include <csignal>
#include <cstdio>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../../client/servo_process.hpp"
#include "../../rights.hpp"
#include "../usb/chances.hpp"
#include "vendor_bench.hpp"

namespace knurl::counterfeit {
namespace {

using namespace std::chrono_literals;
using usb_chances = drivers::usb_emulator::Chances;

constexpr Plane wall = {.normal = {0, 0, 1}, .offset = 0, .stiffness = 60};
constexpr double reach = -0.004;  // m: the hand wants to be so deep in it

class Wall : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        hardware().rigid = 0;
        hardware().target[2] = 0.01;
        servo_ = std::make_unique<client_test::ServoProcess>(
            std::vector<std::string>{"--device", std::string("right=") + GetParam()});
        client_.emplace(client_test::connect());
        hand_.emplace(client_->claim("right"));
        surface_.emplace(hand_->add(wall));
        hardware().target[2] = reach;
        ASSERT_TRUE(pushes());
    }
    void TearDown() override {
        bench_->set(Fault::none);
        if (servo_ && servo_->pid() > 0) servo_->end(SIGTERM);
    }

    Device& hardware() { return bench_.device(); }
    double force_now() { return hardware().share_of(2, now_ns()); }
    std::optional<Report> report() {
        try {
            const auto report = hand_->next_report(100ms);
            hand_->commit();
            if (report && report->state == DeviceState::fault) hand_->reset_fault();
            if (report && report->state == DeviceState::idle) hand_->arm();
            return report;
        } catch (const Error&) {
            return {};  // not back yet, or its state forbids it still
        }
    }
    bool comes_to(DeviceState state) {
        const auto deadline = std::chrono::steady_clock::now() + test::patience;
        while (std::chrono::steady_clock::now() < deadline) {
            const auto seen = report();
            if (seen && seen->state == state) return true;
        }
        return false;
    }
    /// Resets, arms, until the motors push.
    bool pushes() {
        const auto deadline = std::chrono::steady_clock::now() + test::patience;
        while (std::chrono::steady_clock::now() < deadline) {
            const auto seen = report();
            if (seen && seen->state == DeviceState::active && force_now() > 0.1) return true;
        }
        return false;
    }
    pid_t driver_process() { return static_cast<pid_t>(hardware().opened_by.load()); }

    /// When the last force that was not zero reached the device, ns.
    std::int64_t last_push() {
        const std::uint64_t end = hardware().records.load(std::memory_order_acquire);
        for (std::uint64_t i = end; i > 0 && i + log_size > end; --i) {
            const Record& record = hardware().log[(i - 1) % log_size];
            for (const double force : record.force)
                if (force != 0) return record.t;
        }
        return 0;
    }
    /// `act` ends the servo. The device is told zero in time: not by its watchdog, but by the process.
    template <class Act>
    void expect_zero_in_time_after(Act act) {
        constexpr int promised = 6;  // ms: 5 of silence, and one loop
        for (usb_chances chances(promised);;) {
            chances.begin();
            const std::int64_t since = now_ns();
            act();
            ASSERT_TRUE(test::eventually([&] { return hardware().largest_now() == 0; }));
            const std::int64_t late_ns = std::max<std::int64_t>(0, last_push() - since);
            std::printf("%s: zero %.2f ms after\n", GetParam(), static_cast<double>(late_ns) * 1e-6);
            const int late = static_cast<int>(late_ns / 1'000'000);
            if (const test::Missing missing = test::missing_real_time(86); !missing.empty())
                GTEST_SKIP() << missing;
            if (chances.is_the_last(late)) {
                EXPECT_LE(late, promised);
                return;
            }
            servo_->end(SIGKILL);
            servo_->start();
            ASSERT_TRUE(pushes());
        }
    }

    Bench bench_;
    std::unique_ptr<client_test::ServoProcess> servo_;
    std::optional<Client> client_;
    std::optional<Claim> hand_;
    std::optional<Handle<Plane>> surface_;
};

// The hand's spring of 200 N/m wants 4 mm into a wall of 60 N/m (what an unknown device may have): together they rest where both forces are equal.
TEST_P(Wall, IsFelt) {
    const double depth = reach * 200 / (200 + wall.stiffness);
    ASSERT_TRUE(test::eventually([&] {
        report();
        return std::abs(hardware().position[2].load() - depth) < 1e-4 &&
               std::abs(hardware().velocity[2].load()) < 1e-3;
    })) << hardware().position[2].load();
    EXPECT_NEAR(force_now(), -wall.stiffness * hardware().position[2].load(), 0.02);
    const auto seen = hand_->newest(1s);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->position.z, depth, 2e-4);
}

TEST_P(Wall, GivesZeroWhenTheServoIsKilled) {
    expect_zero_in_time_after([&] { kill(servo_->pid(), SIGKILL); });
    ASSERT_TRUE(test::eventually([&] { return hardware().opened_by.load() == 0; })) << "closed in order";
    servo_->end(SIGKILL);
    servo_->start();
    EXPECT_TRUE(pushes());
}

TEST_P(Wall, GivesZeroWhileTheServoIsStoppedAndGoesOn) {
    expect_zero_in_time_after([&] { servo_->stop(); });
    servo_->go_on();
    EXPECT_TRUE(pushes());
}

TEST_P(Wall, GoesOnWhenTheDriverProcessIsKilled) {
    const pid_t killed = driver_process();
    kill(killed, SIGKILL);
    ASSERT_TRUE(test::eventually([&] { return hardware().largest_now() == 0; })) << "its watchdog";
    ASSERT_TRUE(test::eventually([&] {
        const std::uint32_t other = hardware().opened_by.load();
        report();
        return other != 0 && static_cast<pid_t>(other) != killed;
    }));
    EXPECT_TRUE(pushes());
}

TEST_P(Wall, FaultsWhenACallHangsOrCrashesAndCanBeArmedAgain) {
    for (const Fault fault :
         {Fault::hang_in_position, Fault::hang_in_force, Fault::crash_in_position, Fault::nan}) {
        const pid_t hung = driver_process();
        bench_->set(fault);
        // A Touch has no watchdog of its own: it is at zero once the next process has opened it, whose calls must return.
        if (std::string(GetParam()) == "hd:" &&
            (fault == Fault::hang_in_position || fault == Fault::hang_in_force)) {
            ASSERT_TRUE(test::eventually([&] { return kill(hung, 0) != 0; })) << static_cast<int>(fault);
            bench_->set(Fault::none);
        }
        ASSERT_TRUE(test::eventually([&] { return hardware().largest_now() == 0; }))
            << static_cast<int>(fault);
        bench_->set(Fault::none);
        EXPECT_TRUE(pushes()) << static_cast<int>(fault);
    }
}

INSTANTIATE_TEST_SUITE_P(Vendors, Wall, testing::Values("dhd:", "hd:"), [](const auto& name) {
    return std::string(name.param).substr(0, std::string(name.param).find(':'));
});

}  // namespace
}  // namespace knurl::counterfeit
