// The servo is killed or stopped with force on. Its guardian, a forked process that holds the node, zeroes
// the device. The servo is a separate process here (servo_process.cpp); the test owns the bus and its clock.

#include <csignal>
#include <cstring>
#include <functional>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include "../../rights.hpp"
#include "chances.hpp"
#include "motor_bench.hpp"
#include "usb/zero_line.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

/// The process, and its guardian.
class Servo {
  public:
    explicit Servo(const std::string& address) {
        int in[2], out[2];
        if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
        std::string program = KNURL_USB_SERVO, what = address;
        char* arguments[] = {program.data(), what.data(), nullptr};
        const int error = posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments, environ);
        posix_spawn_file_actions_destroy(&actions);
        close(in[0]);
        close(out[1]);
        if (error != 0) throw std::runtime_error(std::strerror(error));
        ask_ = in[1];
        hear_ = fdopen(out[0], "r");
    }
    ~Servo() {
        // First the guardian, while its servo lives: killed inside a call to the mock, that would leave it
        // half an exchange.
        close(ask_);
        if (guardian_stopped_) {
            syscall(SYS_pidfd_send_signal, guardian_, SIGCONT, nullptr, 0);
            kill(pid_, SIGCONT);
        }
        if (guardian_ >= 0) {
            pollfd gone{.fd = guardian_, .events = POLLIN, .revents = 0};
            poll(&gone, 1, -1);
            close(guardian_);
        }
        end();
        std::fclose(hear_);
    }
    Servo(const Servo&) = delete;
    Servo& operator=(const Servo&) = delete;

    bool ready() {
        int guardian = 0;
        const std::string said = line();
        if (std::sscanf(said.c_str(), "ready %d", &guardian) != 1) return false;
        real_time_ = said.find("real-time") != std::string::npos;
        guardian_ = static_cast<int>(syscall(SYS_pidfd_open, guardian, 0));
        return guardian_ >= 0;
    }
    std::string line() {
        char text[128] = {};
        return std::fgets(text, sizeof text, hear_) != nullptr ? text : "";
    }
    void tell_guardian() { ASSERT_EQ(write(ask_, "z", 1), 1); }
    void signal(int number) { kill(pid_, number); }
    void stop_both() {
        kill(pid_, SIGSTOP);
        int status = 0;
        waitpid(pid_, &status, WUNTRACED);
        syscall(SYS_pidfd_send_signal, guardian_, SIGSTOP, nullptr, 0);
        guardian_stopped_ = true;
    }
    void end() {
        if (pid_ > 0) {
            kill(pid_, SIGKILL);
            waitpid(pid_, nullptr, 0);
        }
        pid_ = -1;
    }
    pid_t pid() const { return pid_; }
    bool real_time() const { return real_time_; }

  private:
    pid_t pid_ = -1;
    int guardian_ = -1;  // pidfd
    bool guardian_stopped_ = false;
    bool real_time_ = false;
    int ask_ = -1;
    FILE* hear_ = nullptr;
};

constexpr int promised = 5;  // ms of the bus's clock

class Guardian : public testing::TestWithParam<MotorDevice> {
  protected:
    const std::array<int, 3> pushed = GetParam().all(0.1), pushed_half = GetParam().all(0.05);

    void SetUp() override {
        plug_in(bus_, GetParam(), device_);
        start();
    }
    void start() {
        servo_.reset();  // its guardian holds the node
        servo_ = std::make_unique<Servo>(GetParam().address);
        ASSERT_TRUE(servo_->ready());
        ASSERT_TRUE(bus_.wait(10000, [&] { return device_->motors() == pushed; }));
    }

    /// Waits until the servo waits for the bus, with efforts in flight. If it were killed inside a call to
    /// the mock, half an exchange would stay in the socket that its guardian shares: a problem of the mock,
    /// not of a kernel.
    void let_it_run_dry() {
        bus_.freeze(true);
        while (bus_.in_flight("1-1") < kept_for_samples + on_their_way_) bus_.wait_until_quiet();
        bus_.wait_until_quiet();
    }
    /// From now on the bus's clock runs: at once, so that the guardian has no free frames. (A servo that was
    /// sent SIGKILL no longer runs, whenever its parent learns of it.)
    void run_on(std::uint64_t& since) {
        const std::size_t before = bus_.locked([&] { return device_->requests().size(); });
        since = bus_.frame();
        bus_.freeze(false);
        ASSERT_TRUE(bus_.wait(1000, [&] { return device_->requests().size() >= before + on_their_way_; }));
        bus_.locked([&] {
            EXPECT_EQ(device_->requests()[before + on_their_way_ - 1].motors, pushed)
                << "what was on its way arrives first";
        });
    }
    /// `act` stops the servo in some way, and lets the bus's clock run from `since` on.
    void expect_zero_in_time_after(const std::function<void(std::uint64_t& since)>& act) {
        for (Chances chances(promised);; start()) {
            ASSERT_FALSE(HasFatalFailure());
            std::uint64_t since = 0;
            chances.begin();
            act(since);
            ASSERT_FALSE(HasFatalFailure());
            ASSERT_TRUE(bus_.wait(1000, [&] { return device_->motors() == std::array<int, 3>{}; }));
            const MotorRequest last = bus_.locked([&] { return device_->requests().back(); });
            ASSERT_TRUE(last.is_zero()) << "it was not told: its watchdog did it";
            const int late = static_cast<int>(last.frame - since);
            std::printf("zero after %d ms of the bus's clock\n", late);
            if (!servo_->real_time()) GTEST_SKIP() << test::missing_real_time(50);  // all the rest was right
            if (!chances.is_the_last(late)) continue;
            EXPECT_LE(late, promised);
            return;
        }
    }

    Bus bus_;
    std::shared_ptr<MotorModel> device_ = GetParam().make();
    const std::size_t on_their_way_ = kept_of_efforts(*device_);
    std::unique_ptr<Servo> servo_;
};

TEST_P(Guardian, ZeroesItWhenTheServoIsKilled) {
    expect_zero_in_time_after([&](std::uint64_t& since) {
        let_it_run_dry();
        servo_->signal(SIGKILL);
        run_on(since);
    });
    servo_->end();
    EXPECT_EQ(servo_->line(), "safe\n");
}

TEST_P(Guardian, ZeroesItThroughAnEndpointThatTheServoLeftHalted) {
    expect_zero_in_time_after([&](std::uint64_t& since) {
        let_it_run_dry();
        servo_->signal(SIGKILL);
        bus_.locked([&] { device_->stalls_out = 1; });  // the servo's requests in flight meet them
        since = bus_.frame();
        bus_.freeze(false);
    });
    servo_->end();
    EXPECT_EQ(servo_->line(), "safe\n");
}

TEST_P(Guardian, ZeroesItWhenTheServoStandsStillAndNothingOldFollowsWhenItGoesOn) {
    expect_zero_in_time_after([&](std::uint64_t& since) {
        let_it_run_dry();
        servo_->signal(SIGSTOP);
        int status = 0;
        waitpid(servo_->pid(), &status, WUNTRACED);
        ASSERT_TRUE(WIFSTOPPED(status));
        servo_->tell_guardian();
        run_on(since);
    });
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_EQ(servo_->line(), "safe\n");
    const std::size_t zeroed = bus_.locked([&] { return device_->requests().size(); });
    const std::uint64_t stopped_for = bus_.frame() + 600;
    bus_.wait(10000, [&] { return bus_.frame() > stopped_for; });
    servo_->signal(SIGCONT);
    // The efforts from before the stop have no effect. Efforts after a new read are allowed: the servo has
    // seen the guardian's act.
    ASSERT_TRUE(bus_.wait(5000, [&] { return device_->motors() == pushed_half; }));
    bus_.locked([&] {
        for (std::size_t i = zeroed; i < device_->requests().size(); ++i)
            EXPECT_LE(std::abs(device_->requests()[i].motors[0]), std::abs(pushed_half[0]))
                << "packet " << i - zeroed;
    });
}

INSTANTIATE_TEST_SUITE_P(Devices, Guardian, each_motor_device(), name_of);

/// Devices that switch their amplifiers off by themselves.
class Watchdog : public Guardian {};
INSTANTIATE_TEST_SUITE_P(Devices, Watchdog, testing::Values(wooden_device), name_of);

TEST_P(Watchdog, IsTheLastWhenServoAndGuardianStandStill) {
    let_it_run_dry();
    servo_->stop_both();
    std::uint64_t since = 0;
    run_on(since);
    ASSERT_FALSE(HasFatalFailure());
    ASSERT_TRUE(bus_.wait(10000, [&] { return device_->motors() == std::array<int, 3>{}; }));
    bus_.locked([&] {
        const MotorRequest& last = device_->requests().back();
        EXPECT_EQ(last.motors, pushed) << "nobody told it";
        EXPECT_LE(last.frame, since + promised) << "what was on its way";
        EXPECT_EQ(dynamic_cast<WoodenModel&>(*device_).tripped_at(),
                  last.frame + WoodenModel::watchdog_frames);
    });
}

TEST(ZeroLine, AForkedCopySendsToTheNodeThatWasOpenedLast) {
    const auto node = [](const char* name) { return memfd_create(name, MFD_CLOEXEC); };
    const auto is = [](int a, int b) {
        struct stat one {
        }, other{};
        return fstat(a, &one) == 0 && fstat(b, &other) == 0 && one.st_ino == other.st_ino;
    };
    const std::uint8_t packet[4] = {};
    usb::ZeroLine line(packet);
    const int first = node("first"), second = node("second"), third = node("third");
    line.hold(first, 2);
    int to_child[2];
    ASSERT_EQ(pipe(to_child), 0);
    const pid_t child = fork();
    if (child == 0) {
        char byte = 0;
        const bool inherited = line.forked() && is(line.node(), first);
        if (read(to_child[0], &byte, 1) != 1) _exit(2);
        line.take_newest();
        // A memfd does not accept such a call: it fails, and the other process sees the count.
        const bool counted = !line.zero() && line.acts() == 1;
        _exit(inherited && is(line.node(), third) && counted ? 0 : 1);
    }
    line.let_go();  // unplugged, and plugged in twice
    line.hold(second, 2);
    line.let_go();
    line.hold(third, 2);
    EXPECT_EQ(write(to_child[1], "x", 1), 1);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    EXPECT_EQ(line.acts(), 1U);
    EXPECT_FALSE(line.forked());
    for (const int fd : {first, second, third, to_child[0], to_child[1]}) close(fd);
}

}  // namespace
}  // namespace knurl::drivers
