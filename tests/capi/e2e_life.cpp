// Deaths and silences: of the program, of its servo, of a fork; and a servo of another build.

#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <knurl/protocol/attach.hpp>

#include "e2e_support.hpp"

namespace capi_test {
namespace {

TEST_F(CHand, outlives_its_servo_and_is_armed_anew) {
    const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(0.2, 0, 0));
    ASSERT_TRUE(did(knurl_arm(hand)));
    feel(0.2);
    servo->end(SIGKILL);
    std::uint32_t connected = 1;
    ASSERT_TRUE(eventually([&] { return knurl_connected(hand, &connected) == KNURL_OK && connected == 0; }));
    knurl_report report = sized<knurl_report>();
    EXPECT_EQ(knurl_next_report(hand, 1 * ms, &report), KNURL_NOTHING);
    EXPECT_EQ(knurl_latest(hand, &report), KNURL_NOTHING);
    EXPECT_TRUE(fails(KNURL_DISCONNECTED, knurl_arm(hand), "has gone"));
    EXPECT_TRUE(fails(KNURL_DISCONNECTED, knurl_device_of(hand, &device)));
    std::int64_t age = 0;
    EXPECT_TRUE(fails(KNURL_DISCONNECTED, knurl_age(hand, 0, &age, nullptr)));
    std::int32_t pid = 1;
    EXPECT_TRUE(did(knurl_servo_pid(client, &pid)));
    EXPECT_EQ(pid, 0);
    const knurl_constant_force more = at_once(0.3, 0, 0);
    EXPECT_TRUE(did(knurl_set(hand, push, KNURL_CONSTANT_FORCE, &more)));
    servo->start();
    ASSERT_TRUE(eventually([&] { return knurl_connected(hand, &connected) == KNURL_OK && connected == 1; }));
    std::uint64_t count = 0;
    ASSERT_TRUE(did(knurl_reattachments(hand, &count)));
    EXPECT_EQ(count, 1u);
    for (int i = 0; i < 50; ++i) {
        ASSERT_TRUE(did(knurl_next_report(hand, 20 * s, &report)));
        ASSERT_EQ(report.sent_force.x, 0) << "nobody has armed it";
    }
    ASSERT_TRUE(did(knurl_arm(hand)));
    feel(0.3);
}

TEST(CLife, without_reattach_the_end_is_an_error) {
    ServoProcess servo;
    knurl_connect_options options;
    knurl_default_connect_options(&options);
    options.wait_ns = 20 * s;
    options.reattach = 0;
    knurl_client* client = nullptr;
    knurl_hand* hand = nullptr;
    ASSERT_TRUE(did(knurl_connect(address(), &options, &client)));
    ASSERT_TRUE(did(knurl_claim(client, nullptr, nullptr, &hand)));
    servo.end(SIGKILL);
    knurl_report report = sized<knurl_report>();
    ASSERT_TRUE(eventually([&] { return knurl_next_report(hand, 1 * ms, &report) == KNURL_DISCONNECTED; }));
    EXPECT_TRUE(one_line(knurl_error(hand)));
    EXPECT_TRUE(did(knurl_close(client)));
}

/// Reports for so many of the servo's cycles, or until `each` has seen enough; without a commit.
template <class Each>
void watch(knurl_hand* hand, std::uint64_t cycles, Each each) {
    knurl_report report = sized<knurl_report>();
    ASSERT_TRUE(did(knurl_latest(hand, &report)));
    for (const std::uint64_t until = report.cycle + cycles; report.cycle < until;) {
        ASSERT_TRUE(did(knurl_next_report(hand, 20 * s, &report)));
        if (each(report)) return;
    }
}

// Silent after 3 x 0.3 s: far more than a busy machine keeps the library's thread from its processor.
constexpr std::int64_t interval = 300 * ms;

TEST_F(CHand, is_kept_alive_while_nobody_commits) {
    claim(interval);
    const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(0.25, 0, 0));
    ASSERT_TRUE(did(knurl_arm(hand)));
    feel(0.25);
    ASSERT_TRUE(did(knurl_keep_alive(hand, 0)));
    knurl_feedback felt = sized<knurl_feedback>();
    watch(hand, 2500, [&](const knurl_report& report) {
        EXPECT_EQ(report.scene_force.x, 0.25) << "cycle " << report.cycle;
        EXPECT_TRUE(did(knurl_feedback_of(hand, push, &felt)));
        EXPECT_EQ(felt.flags & KNURL_FEEDBACK_SILENT, 0u);
        return HasFailure();
    });
    ASSERT_TRUE(did(knurl_keep_alive(hand, -1)));
    bool silent = false;
    watch(hand, 20'000, [&](const knurl_report& report) { return silent = report.scene_force.x == 0; });
    EXPECT_TRUE(silent) << "nobody keeps it alive any more";
}

TEST_F(CHand, is_kept_alive_as_long_as_the_program_makes_progress) {
    claim(interval);
    const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(0.25, 0, 0));
    ASSERT_TRUE(did(knurl_arm(hand)));
    feel(0.25);
    ASSERT_TRUE(did(knurl_keep_alive(hand, 500 * ms)));
    watch(hand, 2500, [&](const knurl_report& report) {
        EXPECT_TRUE(did(knurl_progress(hand)));
        EXPECT_EQ(report.scene_force.x, 0.25) << "cycle " << report.cycle;
        return HasFailure();
    });
    knurl_feedback felt = sized<knurl_feedback>();
    bool silent = false;
    watch(hand, 20'000, [&](const knurl_report& report) {
        return silent = report.scene_force.x == 0 && knurl_feedback_of(hand, push, &felt) == KNURL_OK &&
                        (felt.flags & KNURL_FEEDBACK_SILENT) != 0;
    });
    EXPECT_TRUE(silent) << "progress has ended";
    ASSERT_TRUE(did(knurl_keep_alive(hand, 0)));
    feel(0.25);
    ASSERT_TRUE(did(knurl_close(hand)));  // while it is kept alive
    hand = nullptr;
    claim();
}

TEST_F(CHand, lets_no_signal_into_the_librarys_threads) {
    ASSERT_TRUE(did(knurl_keep_alive(hand, 0)));
    int threads = 0;
    const auto look = [&] {
        threads = 0;
        for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
            if (task.path().filename() == std::to_string(::getpid())) continue;
            std::ifstream status(task.path() / "status");
            std::string line, name;
            std::uint64_t blocked = 0;
            while (std::getline(status, line)) {
                if (line.starts_with("Name:")) name = line.substr(6);
                if (line.starts_with("SigBlk:")) blocked = std::stoull(line.substr(8), nullptr, 16);
            }
            if (!name.starts_with("knurl")) continue;
            ++threads;
            for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGCHLD, SIGUSR1, SIGPROF, SIGPIPE})
                EXPECT_NE(blocked >> (number - 1) & 1, 0u) << name << " takes signal " << number;
        }
        return threads >= 1;
    };
    EXPECT_TRUE(eventually(look));
}

TEST_F(CHand, works_in_a_thread_with_all_signals_blocked) {
    sigset_t all, after;
    sigfillset(&all);
    std::thread([&] {
        ::pthread_sigmask(SIG_SETMASK, &all, nullptr);
        const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(0.2, 0, 0));
        ASSERT_TRUE(did(knurl_arm(hand)));
        feel(0.2);
        ASSERT_TRUE(did(knurl_remove(hand, push)));
        knurl_client* other = connect();
        ASSERT_TRUE(did(knurl_close(other)));
        ::pthread_sigmask(SIG_SETMASK, nullptr, &after);
        EXPECT_NE(sigismember(&after, SIGINT), 0);
    }).join();
}

TEST_F(CHand, is_refused_in_the_child_of_a_fork_which_may_connect_anew) {
#if defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "its child connects, and ThreadSanitizer allows no new thread in the child of a fork";
#endif
    const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(0.1, 0, 0));
    ASSERT_TRUE(did(knurl_arm(hand)));
    ASSERT_TRUE(did(knurl_keep_alive(hand, 0)));
    feel(0.1);
    const pid_t child = ::fork();
    if (child == 0) {
        int wrong = 0;
        const auto refused = [&](int code) {
            wrong += code == KNURL_AFTER_FORK && one_line(knurl_error(nullptr)) ? 0 : 1;
        };
        knurl_report report = sized<knurl_report>();
        const knurl_constant_force more = at_once(9, 9, 9);
        knurl_hand* claimed = nullptr;
        std::uint32_t connected = 0;
        refused(knurl_commit(hand, nullptr));
        refused(knurl_next_report(hand, 1 * ms, &report));
        refused(knurl_set(hand, push, KNURL_CONSTANT_FORCE, &more));
        refused(knurl_disarm(hand));
        refused(knurl_keep_alive(hand, 0));
        refused(knurl_claim(client, nullptr, nullptr, &claimed));
        refused(knurl_connected(hand, &connected));
        refused(knurl_close(hand));
        refused(knurl_close(client));
        knurl_client* own = nullptr;
        knurl_hand* observer = nullptr;
        knurl_connect_options options;
        knurl_default_connect_options(&options);
        options.wait_ns = 20 * s;
        wrong += knurl_connect(address(), &options, &own) == KNURL_OK ? 0 : 100;
        wrong += knurl_observe(own, nullptr, &observer) == KNURL_OK ? 0 : 100;
        wrong += knurl_next_report(observer, 20 * s, &report) == KNURL_OK ? 0 : 100;
        wrong += knurl_close(own) == KNURL_OK ? 0 : 100;
        ::_exit(wrong);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    for (int i = 0; i < 50; ++i) {
        knurl_report report = sized<knurl_report>();
        ASSERT_TRUE(did(knurl_commit(hand, nullptr)));
        ASSERT_TRUE(did(knurl_next_report(hand, 20 * s, &report)));
        ASSERT_EQ(report.scene_force.x, 0.1);
        ASSERT_TRUE(is_active(report));
    }
}

TEST_F(CHand, child_of_a_fork_may_leave_through_exit) {
    ASSERT_TRUE(did(knurl_keep_alive(hand, 0)));
    const pid_t child = ::fork();
    if (child == 0) std::quick_exit(0);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    apply();
}

/// Stands before the servo's socket and changes what a client says of its build.
class OtherBuild {
  public:
    OtherBuild(const std::string& at, const std::string& servo) : servo_(servo) {
        listening_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
        const sockaddr_un name = name_of(at);
        if (::bind(listening_, reinterpret_cast<const sockaddr*>(&name), sizeof name) != 0 ||
            ::listen(listening_, 8) != 0)
            throw std::runtime_error("no socket for the test");
        thread_ = std::thread([this] { run(); });
    }
    ~OtherBuild() {
        ::shutdown(listening_, SHUT_RDWR);
        thread_.join();
        ::close(listening_);
    }

  private:
    static sockaddr_un name_of(const std::string& path) {
        sockaddr_un name{};
        name.sun_family = AF_UNIX;
        path.copy(name.sun_path, sizeof name.sun_path - 1);
        return name;
    }
    void run() const {
        for (int client; (client = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;
             ::close(client)) {
            std::vector<char> bytes(4096);
            const ssize_t got = ::recv(client, bytes.data(), bytes.size(), 0);
            if (got < static_cast<ssize_t>(sizeof(knurl::protocol::Hello))) continue;
            knurl::protocol::Hello hello;
            std::memcpy(&hello, bytes.data(), sizeof hello);
            EXPECT_EQ(hello.layout, knurl_layout()) << "the library says its build";
            hello.layout ^= 1;
            std::memcpy(bytes.data(), &hello, sizeof hello);
            const int servo = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
            const sockaddr_un name = name_of(servo_);
            if (::connect(servo, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0 &&
                ::send(servo, bytes.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL) == got) {
                const ssize_t answered = ::recv(servo, bytes.data(), bytes.size(), 0);
                if (answered > 0)
                    ::send(client, bytes.data(), static_cast<std::size_t>(answered), MSG_NOSIGNAL);
            }
            ::close(servo);
        }
    }
    std::string servo_;
    int listening_ = -1;
    std::thread thread_;
};

TEST(CLife, a_servo_of_another_build_is_told_in_one_line) {
    if (ServoProcess::through_bridge()) GTEST_SKIP() << "the bridge has its own: the local way is tried";
    ServoProcess servo;
    ASSERT_TRUE(did(knurl_close(connect())));
    const std::filesystem::path folder = servo.socket().parent_path();
    const OtherBuild between((folder / "other.sock").string(), servo.socket().string());
    knurl_connect_options options;
    knurl_default_connect_options(&options);
    options.wait_ns = 0;
    knurl_client* client = nullptr;
    EXPECT_TRUE(fails(KNURL_INCOMPATIBLE, knurl_connect("knurl:other", &options, &client), "build"));
    EXPECT_EQ(client, nullptr);
}

}  // namespace
}  // namespace capi_test
