// A real knurld that owns a device on the emulated bus, an application with a floor, and seeded faults of
// cable, device and servo. The oracle uses only the efforts that the device received. This is the USB part of
// the chaos runner (tests/chaos has those of applications, network and servo), in a separate program because
// umockdev must be preloaded. Long form: KNURL_USB_FAULTS=200 (scripts/usb); KNURL_SEED repeats a run.

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <sys/syscall.h>

#include "../../rights.hpp"
#include "chances.hpp"
#include "knurld_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;
using testing::HasSubstr;

int number_in(const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text != nullptr ? std::atoi(text) : otherwise;
}

class DeviceUnderKnurld : public testing::TestWithParam<MotorDevice> {
  public:
    static constexpr int promised = 5;  // ms of the bus's clock, from the servo's death or stop to zero
    static constexpr int guardian_priority = 85;  // the servo's 80, and five above

    void SetUp() override {
        if (not_here != nullptr) GTEST_SKIP() << not_here;
        const std::string loaded = std::getenv("LD_PRELOAD");  // umockdev's, at least
        if (loaded.find(KNURL_USB_HANDED_OVER) == std::string::npos)
            setenv("LD_PRELOAD", (KNURL_USB_HANDED_OVER ":" + loaded).c_str(), 1);
        plug_in(bus_, GetParam(), device_);
        servo_ = std::make_unique<client_test::ServoProcess>(
            std::vector<std::string>{"--device", std::string("right=") + GetParam().address});
        client_.emplace(client_test::connect());
        hand_.emplace(client_->claim("right"));
        floor_.emplace(hand_->add(felt_floor));
        ASSERT_TRUE(pushes());
        steady_ = largest_since(requests() - 1);
        ASSERT_GT(steady_, 0);
    }

    void TearDown() override {
        if (!servo_) return;
        bus_.freeze(false);
        if (servo_->pid() > 0)
            servo_->end(SIGTERM);  // in order: a kill would have to wait for the bus, as below
    }

    /// Resets faults and arms, until the motors push.
    bool pushes() {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (std::chrono::steady_clock::now() < deadline) {
            const bool active = try_to_arm() == DeviceState::active;
            if (active && bus_.locked([&] { return device_->motors() != std::array<int, 3>{}; })) return true;
        }
        return false;
    }
    std::optional<DeviceState> try_to_arm() { return usb_emulator::try_to_arm(*hand_); }
    void start_anew() {
        servo_->end(SIGTERM);
        servo_->start();
        ASSERT_TRUE(pushes());
    }
    /// Reads on, committing, until the state is that one.
    bool comes_to(DeviceState state) {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (std::chrono::steady_clock::now() < deadline) {
            const auto report = hand_->next_report(100ms);
            if (hand_->connected()) hand_->commit();
            if (report && report->state == state) return true;
        }
        return false;
    }
    std::size_t requests() {
        return bus_.locked([&] { return device_->requests().size(); });
    }
    int largest_since(std::size_t first) {
        return bus_.locked([&] {
            int largest = 0;
            for (std::size_t i = first; i < device_->requests().size(); ++i)
                for (const int motor : device_->requests()[i].motors)
                    largest = std::max(largest, std::abs(motor));
            return largest;
        });
    }
    /// From now on it does not push until somebody arms it.
    void expect_rest_from(std::size_t first) {
        const std::uint64_t later = bus_.frame() + 100;
        ASSERT_TRUE(bus_.wait(10000, [&] { return bus_.frame() > later; }));
        EXPECT_EQ(largest_since(first), 0);
    }
    void trouble(const std::function<void()>& begin, const std::function<void()>& end) {
        bus_.locked(begin);
        ASSERT_TRUE(comes_to(DeviceState::fault));
        ASSERT_TRUE(bus_.wait(10000, [&] { return device_->motors() == std::array<int, 3>{}; }));
        bus_.locked(end);
        expect_rest_from(requests());
    }

    void unplug() {
        bus_.unplug("1-1");
        ASSERT_TRUE(comes_to(DeviceState::fault));
        const std::size_t before = requests();
        plug_in(bus_, GetParam(), device_);
        ASSERT_TRUE(bus_.wait(20000, [&] { return device_->requests().size() > before + 3; }));
        expect_rest_from(before);
        if (GetParam().homed_after_replug) return;
        // Its counters have restarted, wherever the arm is: arming must fail.
        for (int i = 0; i < 20; ++i) EXPECT_NE(try_to_arm(), DeviceState::active);
        expect_rest_from(before);
        start_anew();
    }
    void garbage() {
        trouble([&] { device_->faults.garbage_replies = 1 << 20; },
                [&] { device_->faults.garbage_replies = 0; });
    }
    void short_packets() {
        trouble([&] { device_->faults.short_packets = 1 << 20; }, [&] { device_->faults.short_packets = 0; });
    }
    void silence() {
        bus_.locked([&] { device_->faults.silent = true; });
        ASSERT_TRUE(comes_to(DeviceState::fault));
        bus_.locked([&] { device_->faults.silent = false; });
        ASSERT_TRUE(bus_.wait(10000, [&] { return device_->motors() == std::array<int, 3>{}; }));
        expect_rest_from(requests());
    }
    void slip() {
        trouble([&] { device_->slip(1, 4000); }, [&] { device_->slip(1, -4000); });
    }
    /// The OUT endpoint answers NAK: the motors hold their last command until the device accepts packets
    /// again.
    void takes_no_packet() {
        bus_.locked([&] { device_->faults.stuck = true; });
        ASSERT_TRUE(comes_to(DeviceState::fault));
        const std::size_t before = requests();
        bus_.locked([&] { device_->faults.stuck = false; });
        // The two packets that waited are as old as the fault. The next ones are zero.
        ASSERT_TRUE(bus_.wait(10000, [&] { return device_->requests().size() > before + 2; }));
        expect_rest_from(before + 2);
    }
    /// The states of the next `frames` ms, a bit each.
    unsigned states_during(std::uint64_t frames) {
        unsigned seen = 0;
        for (const std::uint64_t end = bus_.frame() + frames; bus_.frame() < end;) {
            const auto report = hand_->next_report(100ms);
            hand_->commit();
            if (report) seen |= bit(report->state);
        }
        return seen;
    }
    static unsigned bit(DeviceState state) { return 1U << static_cast<unsigned>(state); }
    void two_bad_packets() {
        bus_.locked([&] { device_->faults.short_packets = 2; });
        EXPECT_EQ(states_during(200) &
                      (bit(DeviceState::ramp_down) | bit(DeviceState::idle) | bit(DeviceState::fault)),
                  0U);
        EXPECT_EQ(bus_.locked([&] { return device_->faults.short_packets; }), 0) << "they were sent";
        EXPECT_TRUE(bus_.wait(1000, [&] { return device_->motors() != std::array<int, 3>{}; }));
    }
    /// Three bad reads in a row ramp down, ten are a fault. Six packets cause the first and never the second,
    /// unless the servo is so late that it meets several at once (then it may see no three in a row), or the
    /// machine also stood still for 20 ms (then there are ten). In these cases the test repeats.
    void a_few_bad_packets() {
        constexpr int attempts = 10;
        for (int i = 0; i < attempts; ++i) {
            bus_.locked([&] { device_->faults.short_packets = 6; });
            const unsigned seen = states_during(300);
            if ((seen & bit(DeviceState::fault)) != 0 || (seen & bit(DeviceState::idle)) == 0) {
                ASSERT_TRUE(pushes());
                continue;
            }
            expect_rest_from(requests());
            return;
        }
        FAIL() << "it never ramped down, or never without a fault";
    }

    /// Waits until the servo's I/O thread waits for the bus with efforts in flight. Stopped or killed inside
    /// a call to the mock it would leave half an exchange there, which no kernel does. The servo considers the
    /// device silent after 20 ms: if this process comes too late for that, it begins anew.
    void let_it_run_dry() {
        constexpr int attempts = 20;
        for (int i = 0; i < attempts; ++i) {
            bus_.freeze(true);
            const auto silent = std::chrono::steady_clock::now() + 20ms;
            while (std::chrono::steady_clock::now() < silent) {
                if (bus_.in_flight("1-1") >= kept_for_samples + kept_of_efforts(*device_) &&
                    io_thread_waits())
                    return;
                std::this_thread::yield();
            }
            bus_.freeze(false);
            ASSERT_TRUE(pushes());
        }
        FAIL() << bus_.in_flight("1-1") << " in flight, I/O thread in call " << io_thread_call();
    }
    bool io_thread_waits() const { return io_thread_call() == std::to_string(SYS_poll); }
    /// The number of the system call in which it is.
    std::string io_thread_call() const {
        const std::filesystem::path tasks = "/proc/" + std::to_string(servo_->pid()) + "/task";
        const auto word = [](const std::filesystem::path& file) {
            std::string text;
            std::ifstream(file) >> text;
            return text;
        };
        for (const auto& task : std::filesystem::directory_iterator(tasks))
            if (word(task.path() / "comm") == "knurl-usb") return word(task.path() / "syscall");
        return "none";
    }
    /// The number of frames from `since` to the first zero at or after request `first`.
    std::optional<int> zero_after(std::size_t first, std::uint64_t since) {
        std::optional<std::uint64_t> zero;
        const bool came = bus_.wait(1000, [&] {
            for (std::size_t i = first; i < device_->requests().size() && !zero; ++i)
                if (device_->requests()[i].is_zero()) zero = device_->requests()[i].frame;
            return zero.has_value();
        });
        if (!came) return {};
        EXPECT_EQ(bus_.locked([&] { return device_->motors(); }), (std::array<int, 3>{}));
        std::printf("  zero after %d ms\n", static_cast<int>(*zero - since));
        return static_cast<int>(*zero - since);
    }
    /// Required only if the guardian is real-time, and the servo's end takes no longer than usual: the kernel
    /// needs milliseconds to free a sanitizer's memory.
    void expect_in_time(int late) const {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
        std::printf("  a sanitizer's build: %d ms are not held against it\n", late);
#else
        KNURL_NEEDS(test::missing_real_time(guardian_priority));  // all the rest was as it should be
        EXPECT_LE(late, promised);
#endif
    }

    /// The bus runs from the moment of the kill: what the kernel takes to end the process counts.
    void kill_servo() {
        for (Chances chances(promised);;) {
            let_it_run_dry();
            ASSERT_FALSE(HasFatalFailure());
            const std::uint64_t since = bus_.frame();
            const std::size_t before = requests();
            ASSERT_NE(bus_.locked([&] { return device_->motors(); }), (std::array<int, 3>{}));
            chances.begin();
            ::kill(servo_->pid(), SIGKILL);  // none of its threads returns to its program from now on
            bus_.freeze(false);
            const std::optional<int> late = zero_after(before, since);
            ASSERT_TRUE(late.has_value());
            const bool judged = chances.is_the_last(*late);
            servo_->end(SIGKILL);
            expect_rest_from(requests());
            servo_->start();
            if (judged) return expect_in_time(*late);
            ASSERT_TRUE(pushes());
        }
    }
    /// The guardian sends to a node that it received later: the servo opened it long after the fork.
    void unplug_and_kill_servo() {
        unplug();
        ASSERT_FALSE(HasFatalFailure());
        ASSERT_TRUE(pushes());
        kill_servo();
    }
    void stop_servo() {
        start_anew();  // its claim lives, and under the mock the guardian shares only what it inherited
        for (Chances chances(promised);;) {
            std::uint64_t since = 0;
            stop_it_while_active(chances, since);
            ASSERT_FALSE(HasFatalFailure());
            const std::size_t before = requests();
            bus_.freeze(false);
            const std::optional<int> late = zero_after(before, since);
            ASSERT_TRUE(late.has_value());
            const bool judged = chances.is_the_last(*late);
            expect_rest_from(requests());
            const std::size_t zeroed = requests();
            servo_->go_on();
            ASSERT_TRUE(pushes());
            expect_it_began_at_zero(zeroed);
            if (judged) return expect_in_time(*late);
        }
    }
    /// A test that is delayed while the bus is frozen makes the servo consider the device silent: repeats
    /// then.
    void stop_it_while_active(Chances& chances, std::uint64_t& since) {
        constexpr int attempts = 20;
        for (int i = 0; i < attempts; ++i) {
            let_it_run_dry();
            ASSERT_FALSE(HasFatalFailure());
            ASSERT_NE(bus_.locked([&] { return device_->motors(); }), (std::array<int, 3>{}));
            since = bus_.frame();
            chances.begin();
            servo_->stop();
            const auto report = hand_->latest();
            if (report && report->state == DeviceState::active) return;
            servo_->go_on();
            bus_.freeze(false);
            ASSERT_TRUE(pushes());
        }
        FAIL() << "it was never active when it was stopped";
    }
    /// No effort computed before: it begins at gain 0.
    void expect_it_began_at_zero(std::size_t zeroed) {
        bus_.locked([&] {
            int first = 0;
            for (std::size_t i = zeroed; i < device_->requests().size() && first == 0; ++i)
                for (const int motor : device_->requests()[i].motors)
                    first = std::max(first, std::abs(motor));
            EXPECT_LT(first, steady_ / 2);
        });
    }

    const unsigned long seed_ = static_cast<unsigned long>(number_in("KNURL_SEED", 20260117));
    Bus bus_;
    std::shared_ptr<MotorModel> device_ = GetParam().make();
    std::unique_ptr<client_test::ServoProcess> servo_;
    std::optional<Client> client_;
    std::optional<Claim> hand_;
    std::optional<Handle<Plane>> floor_;
    int steady_ = 0;  // of the strongest motor, in the device's unit, with the floor felt
};

TEST_P(DeviceUnderKnurld, WhateverFailsItIsAtRestUntilItIsArmedAgainAndNeverPushesHarderThanTheFloor) {
    const struct {
        const char* name;
        void (DeviceUnderKnurld::*happens)();
    } faults[] = {{"unplugged", &DeviceUnderKnurld::unplug},
                  {"garbage", &DeviceUnderKnurld::garbage},
                  {"short packets", &DeviceUnderKnurld::short_packets},
                  {"silence", &DeviceUnderKnurld::silence},
                  {"an encoder slips", &DeviceUnderKnurld::slip},
                  {"takes no packet", &DeviceUnderKnurld::takes_no_packet},
                  {"two bad packets", &DeviceUnderKnurld::two_bad_packets},
                  {"a few bad packets", &DeviceUnderKnurld::a_few_bad_packets},
                  {"servo stopped", &DeviceUnderKnurld::stop_servo},
                  {"servo killed", &DeviceUnderKnurld::kill_servo},
                  {"unplugged and back, then servo killed", &DeviceUnderKnurld::unplug_and_kill_servo}};
    SCOPED_TRACE("KNURL_SEED=" + std::to_string(seed_));
    std::mt19937_64 random(seed_);
    const int rounds = number_in("KNURL_USB_FAULTS", static_cast<int>(std::size(faults)));
    for (int i = 0; i < rounds; ++i) {
        // Each once, then as chance has it.
        const auto& fault =
            faults[static_cast<std::size_t>(i) < std::size(faults) ? static_cast<std::size_t>(i)
                                                                   : random() % std::size(faults)];
        std::printf("%s\n", fault.name);
        SCOPED_TRACE(fault.name);
        const std::size_t before = requests();
        (this->*fault.happens)();
        ASSERT_FALSE(HasFatalFailure());
        ASSERT_TRUE(pushes());
        EXPECT_LE(largest_since(before), steady_ + 2) << "of a motor, in its unit";
    }
}

TEST_P(DeviceUnderKnurld, KnurlDevicesSaysWhichServoRunsItAndWhetherAnotherProgramHoldsIt) {
    const auto list = [] {
        std::string text;
        FILE* pipe = ::popen(KNURL " devices", "r");
        for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
        EXPECT_EQ(::pclose(pipe), 0);
        return text;
    };
    EXPECT_THAT(list(),
                HasSubstr("run as right of knurl:default (pid " + std::to_string(servo_->pid()) + ")"));
    servo_->end(SIGTERM);
    EXPECT_THAT(list(), HasSubstr("): ready"));
    bus_.hold_by_another("1-1", true);
    EXPECT_THAT(list(), HasSubstr("): another program holds it\n  mend it: sudo fuser -v /dev/bus/usb/001/"));
}

INSTANTIATE_TEST_SUITE_P(Devices, DeviceUnderKnurld, each_motor_device(), name_of);

}  // namespace
}  // namespace knurl::drivers
