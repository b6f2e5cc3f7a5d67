// Without a servo: what is no handle, where nobody listens, and what a call leaves as it was.

#include <cfenv>
#include <clocale>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include <unistd.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "../temp_folder.hpp"
#include "kinds_table.h"
#include "support.hpp"

namespace capi_test {
namespace {

/// Nobody listens in this folder.
struct CHandles : testing::Test {
    void SetUp() override { ::setenv("KNURL_RUNTIME_DIR", folder.path().c_str(), 1); }
    int connect(const char* address) {
        knurl_connect_options options;
        knurl_default_connect_options(&options);
        options.wait_ns = 0;
        return knurl_connect(address, &options, &client);
    }
    knurl::test::TempFolder folder;
    knurl_client* client = nullptr;
};

TEST_F(CHandles, version_and_layout_are_told) {
    EXPECT_STREQ(knurl_version(), KNURL_VERSION);
    EXPECT_NE(knurl_layout(), 0u);
    EXPECT_EQ(connect_in_c("knurl:nobody"), KNURL_BAD_HANDLE);
    EXPECT_EQ(force_in_c(), 0.8);
}

TEST_F(CHandles, without_a_servo_one_line_says_so_and_nothing_is_given) {
    EXPECT_TRUE(fails(KNURL_NO_SERVO, connect(nullptr), "default"));
    EXPECT_EQ(client, nullptr);
    EXPECT_TRUE(fails(KNURL_NO_SERVO, connect("knurl:no such one"), "no such one"));
    const std::string handle_line = knurl_error(nullptr);
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(nullptr)));
    EXPECT_STRNE(knurl_error(nullptr), handle_line.c_str());
    EXPECT_EQ(knurl_holder(), 0);
    for (const char* address :
         {"", "knurl:", "knurl:a\nb", "knurl:../../etc", "knurl://", "knurl://localhost", "knurl://:1",
          "knurl://127.0.0.1:1", "knurl://127.0.0.1:99999", "knurl://127.0.0.1:x", "http://x:1",
          "\xff\x01\t"}) {
        const int code = connect(address);
        EXPECT_LT(code, 0) << address;
        EXPECT_TRUE(one_line(knurl_error(nullptr))) << address;
        EXPECT_EQ(client, nullptr);
    }
    // Longer than a socket's name can be.
    EXPECT_LT(connect(("knurl:" + std::string(100'000, 'x')).c_str()), 0);
    EXPECT_TRUE(one_line(knurl_error(nullptr)));
}

TEST_F(CHandles, options_of_other_sizes_are_refused_or_understood) {
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_connect("knurl:x", nullptr, nullptr)));
    knurl_connect_options options;
    knurl_default_connect_options(&options);
    options.wait_ns = 0;
    for (const std::uint64_t size : wrong_sizes<knurl_connect_options>()) {
        options.size = size;
        EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_connect("knurl:x", &options, &client))) << size;
    }
    options.size = sizeof options;
    Later<knurl_connect_options> later(options);
    EXPECT_TRUE(fails(KNURL_NO_SERVO, knurl_connect("knurl:x", &later.known, &client)));
    later.tail[2] = 1;
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_connect("knurl:x", &later.known, &client), "newer libknurl"));
    options.wait_ns = -5;  // as 0
    EXPECT_TRUE(fails(KNURL_NO_SERVO, knurl_connect("knurl:x", &options, &client)));
    options.key_file = "/does/not\n/exist";
    EXPECT_LT(knurl_connect("knurl://127.0.0.1:1", &options, &client), 0);
    EXPECT_TRUE(one_line(knurl_error(nullptr)));
    knurl_default_connect_options(&options);
    EXPECT_EQ(options.hints, 0u) << "it prints nothing unless it is told to";
    EXPECT_EQ(options.reattach, 1u);
    knurl_default_connect_options(nullptr);
    knurl_default_claim_options(nullptr);
    knurl_default_add_options(nullptr);
    knurl_claim_options claim;
    knurl_default_claim_options(&claim);
    EXPECT_EQ(claim.size, sizeof claim);
    EXPECT_EQ(claim.representations, 128u);
    knurl_add_options add;
    knurl_default_add_options(&add);
    EXPECT_EQ(add.size, sizeof add);
    EXPECT_EQ(add.feedback, 1u);
    EXPECT_EQ(add.silence_time, 0.1);
}

TEST_F(CHandles, that_were_never_given_are_refused) {
    const unsigned seed = std::random_device{}();
    std::mt19937_64 random(seed);
    std::uint32_t connected = 0;
    int fd = 0;
    knurl_report report = sized<knurl_report>();
    for (int i = 0; i < 10'000; ++i) {
        std::uint64_t number = random();
        if (i % 3 == 0) number &= 0xff;
        if (i % 5 == 0) number |= 1;
        void* const made_up = reinterpret_cast<void*>(number);
        const auto refused = [&](int code) { return code == KNURL_BAD_HANDLE || code == KNURL_AFTER_FORK; };
        ASSERT_TRUE(refused(knurl_close(made_up))) << "seed " << seed << " handle " << number;
        ASSERT_TRUE(one_line(knurl_error(nullptr))) << "seed " << seed << " handle " << number;
        ASSERT_TRUE(refused(knurl_connected(made_up, &connected)));
        ASSERT_TRUE(refused(knurl_latest(static_cast<knurl_hand*>(made_up), &report)));
        ASSERT_TRUE(refused(knurl_sending_fd(static_cast<knurl_sending*>(made_up), &fd)));
    }
    int local = 0;
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(&local), "no handle"));
    EXPECT_EQ(local, 0);
}

TEST_F(CHandles, of_the_offline_library_are_its_own) {
    knurl_offline* servo = nullptr;
    ASSERT_TRUE(did(knurl_offline_open(nullptr, nullptr, &servo)));
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(servo), "an offline servo"));
    EXPECT_TRUE(did(knurl_offline_step(servo, std::begin({knurl_pose KNURL_POSE_INIT}), nullptr)))
        << "it is still there";
    EXPECT_TRUE(did(knurl_offline_close(servo)));
    EXPECT_TRUE(fails_offline(KNURL_BAD_HANDLE, knurl_offline_close(servo), "closed"));
    EXPECT_TRUE(fails_offline(KNURL_BAD_HANDLE, knurl_offline_close(nullptr)));
}

TEST_F(CHandles, lines_are_each_threads_own) {
    EXPECT_TRUE(fails(KNURL_NO_SERVO, connect("knurl:mine")));
    std::thread([] {
        EXPECT_STREQ(knurl_error(nullptr), "");
        EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(nullptr)));
    }).join();
    EXPECT_NE(std::string(knurl_error(nullptr)).find("mine"), std::string::npos);
    // The line of one handle stays, though another one has failed since.
    void *const a = reinterpret_cast<void*>(0x11), *const b = reinterpret_cast<void*>(0x20);
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(a)));
    const std::string line = knurl_error(a);
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(b)));
    EXPECT_EQ(knurl_error(a), line);
    EXPECT_STREQ(knurl_error(reinterpret_cast<void*>(0x30)), "") << "it has not failed";
}

/// Calls of all sorts, of which some fail.
void call_some() {
    knurl_offline* servo = nullptr;
    knurl_id id = 0;
    knurl_plane floor = plane(0, 800), bad = plane(0.5, -0.25);
    ASSERT_TRUE(did(knurl_offline_open(nullptr, nullptr, &servo)));
    ASSERT_TRUE(did(knurl_offline_add(servo, KNURL_PLANE, &floor, nullptr, &id)));
    EXPECT_TRUE(
        fails_offline(KNURL_BAD_PARAMETERS, knurl_offline_set(servo, id, KNURL_PLANE, &bad), "-0.25 N/m"));
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_validate(KNURL_PLANE, &bad), "-0.25 N/m"));
    knurl_pose pose = KNURL_POSE_INIT;
    pose.position.z = -0.0015;
    knurl_cycle felt = sized<knurl_cycle>();
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(did(knurl_offline_step(servo, &pose, &felt)));
    EXPECT_NEAR(felt.force.z, 1.2, 1e-12);
    ASSERT_TRUE(did(knurl_offline_close(servo)));
    knurl_connect_options options;
    knurl_default_connect_options(&options);
    options.wait_ns = 0;
    knurl_client* client = nullptr;
    EXPECT_TRUE(fails(KNURL_NO_SERVO, knurl_connect("knurl:nobody", &options, &client)));
}

TEST_F(CHandles, calls_leave_the_floating_point_modes_alone) {
#if defined(__x86_64__)
    const unsigned usual = _mm_getcsr();
    _mm_setcsr(usual | 0x8040);  // flush to zero, denormals are zero
    ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
    call_some();
    EXPECT_EQ(std::fegetround(), FE_UPWARD);
    EXPECT_EQ(_mm_getcsr() & 0xffc0u, (usual | 0x8040u | 0x4000u) & 0xffc0u);
    _mm_setcsr(usual);
#endif
    ASSERT_EQ(std::fesetround(FE_TOWARDZERO), 0);
    call_some();
    EXPECT_EQ(std::fegetround(), FE_TOWARDZERO);
    std::fesetround(FE_TONEAREST);
}

TEST_F(CHandles, numbers_in_lines_have_a_point_in_any_locale) {
    // Where no locale with a comma is installed, one is compiled.
    const std::string made = (folder.path() / "locales").string();
    std::filesystem::create_directory(made);
    const char* found = nullptr;
    const auto look = [&] {
        for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "de_AT.utf8"})
            if (found == nullptr && std::setlocale(LC_ALL, name) != nullptr) found = name;
    };
    look();
    if (found == nullptr) {
        const std::string make = "localedef -i de_DE -f UTF-8 " + made + "/de_DE.UTF-8 >/dev/null 2>&1";
        if (std::system(make.c_str()) == 0) {
            ::setenv("LOCPATH", made.c_str(), 1);
            look();
        }
    }
    if (found == nullptr) GTEST_SKIP() << "no locale with a decimal comma here";
    ASSERT_STREQ(std::localeconv()->decimal_point, ",");
    call_some();
    EXPECT_STREQ(std::localeconv()->decimal_point, ",") << "and the locale is as it was";
    EXPECT_STREQ(std::setlocale(LC_ALL, nullptr), found);
    std::setlocale(LC_ALL, "C");
    ::unsetenv("LOCPATH");
}

TEST_F(CHandles, calls_leave_signals_alone) {
    sigset_t all, before, after;
    sigfillset(&all);
    struct sigaction handlers[32] = {};
    for (int number = 1; number < 32; ++number) ::sigaction(number, nullptr, &handlers[number]);
    ASSERT_EQ(::pthread_sigmask(SIG_SETMASK, &all, &before), 0);
    call_some();
    ASSERT_EQ(::pthread_sigmask(SIG_SETMASK, &before, &after), 0);
    for (int number = 1; number < 32; ++number)
        EXPECT_EQ(sigismember(&after, number), number == SIGKILL || number == SIGSTOP ? 0 : 1) << number;
    call_some();
    ASSERT_EQ(::pthread_sigmask(SIG_SETMASK, nullptr, &after), 0);
    for (int number = 1; number < 32; ++number) {
        EXPECT_EQ(sigismember(&after, number), sigismember(&before, number)) << number;
        struct sigaction action {};
        ::sigaction(number, nullptr, &action);
        EXPECT_EQ(action.sa_handler, handlers[number].sa_handler) << number;
    }
}

}  // namespace
}  // namespace capi_test
