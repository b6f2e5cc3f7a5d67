// Deaths: of the servo, of the application, and of an application that has forked.

#include <gtest/gtest.h>
#include <poll.h>

#include "servo_process.hpp"

namespace {

using namespace knurl;
using namespace client_test;

TEST(Survival, a_claim_outlives_its_servo_and_force_stays_off_until_armed_again) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    Observer observer = client.observe();
    const int fd = observer.fd();
    auto force = hand.add(at_once({0.1, 0, 0}));
    auto removed = hand.add(at_once({0, 9, 0}));
    hand.place_probe(3, {.offset = {0, 0, 0.01}, .radius = 0});
    removed.remove();
    hand.arm();
    read_until(hand, is_active);
    force.set(at_once({0.2, 0, 0}));
    ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
    force.set(at_once({0.3, 0, 0}));  // not committed

    while (observer.next_report(0ns)) {
    }
    servo.end(SIGKILL);
    ASSERT_TRUE(eventually([&] { return !hand.connected(); }));
    EXPECT_FALSE(hand.next_report(1ms));
    EXPECT_FALSE(hand.latest());
    EXPECT_EQ(client.servo_pid(), 0);
    pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&ready, 1, 10'000), 1) << "an event loop hears of it";
    while (observer.next_report(0ns)) {
    }
    EXPECT_EQ(::poll(&ready, 1, 0), 0) << "once";
    try {
        hand.arm();
        ADD_FAILURE() << "armed without a servo";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind, Error::Kind::disconnected) << error.what();
        // Through a bridge, too, the servo has to be started.
        EXPECT_NE(std::string(error.what()).find("' has gone"), std::string::npos) << error.what();
    }
    auto late = hand.add(at_once({0, 0.4, 0}));  // kept for its return

    servo.start();
    ASSERT_TRUE(eventually([&] { return hand.connected() && observer.connected(); }));
    EXPECT_EQ(hand.reattachments(), 1u);
    EXPECT_EQ(client.servo_pid(), servo.pid());
    EXPECT_EQ(::poll(&ready, 1, 10'000), 1) << "the same descriptor";
    EXPECT_TRUE(observer.next_report(0ns));
    for (int i = 0; i < 100; ++i) {
        const auto report = hand.next_report(10s);
        ASSERT_TRUE(report);
        ASSERT_EQ(report->sent_force, (Vec3{})) << "nobody has armed it";
    }
    hand.arm();
    const HandReport report = read_until(hand, is_active);
    EXPECT_NEAR(report.scene_force.x, 0.3, 1e-12)
        << "what was committed at last, then what this commit brought";
    EXPECT_NEAR(report.scene_force.y, 0.4, 1e-12) << "and what was removed is not back";
    EXPECT_EQ(late.params().force.y, 0.4);
    force.set(at_once({0.5, 0, 0}));
    ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s)) << "the handles are the same";
}

TEST(Survival, without_reattach_the_end_is_an_error) {
    ServoProcess servo;
    Client client = connect(false);
    Claim hand = client.claim();
    servo.end(SIGKILL);
    ASSERT_TRUE(eventually([&] { return !hand.connected(); }));
    EXPECT_TRUE(eventually([&] {
        try {
            hand.next_report(1ms);
        } catch (const Error& error) {
            return error.kind == Error::Kind::disconnected;
        }
        return false;
    }));
}

TEST(Survival, a_servo_that_ends_orderly_is_found_again_too) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    for (std::uint64_t round = 1; round <= 3; ++round) {
        servo.end(SIGTERM);
        ASSERT_TRUE(eventually([&] { return !hand.connected(); }));
        servo.start();
        ASSERT_TRUE(eventually([&] { return hand.connected(); }));
        EXPECT_EQ(hand.reattachments(), round);
        EXPECT_TRUE(hand.next_report(10s));
    }
}

TEST(Survival, the_child_of_a_fork_is_inert) {
    ServoProcess servo;
    Client client = connect();
    std::optional<Claim> hand = client.claim();
    auto force = hand->add(at_once({0.1, 0, 0}));
    hand->arm();
    read_until(*hand, is_active);
    const pid_t child = ::fork();
    if (child == 0) {
        int refused = 0;
        const auto expect_refusal = [&](auto call) {
            try {
                call();
            } catch (const Error& error) {
                refused += error.kind == Error::Kind::after_fork ? 1 : 0;
            }
        };
        expect_refusal([&] { hand->commit(); });
        expect_refusal([&] { hand->next_report(1ms); });
        expect_refusal([&] { force.set(at_once({9, 9, 9})); });
        expect_refusal([&] { hand->disarm(); });
        expect_refusal([&] { client.claim(); });
        hand.reset();  // its destructor releases nothing of the parent's
        ::_exit(refused == 5 ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0);
    for (int i = 0; i < 50; ++i) {
        hand->commit();
        const auto report = hand->next_report(10s);
        ASSERT_TRUE(report);
        ASSERT_EQ(report->state, DeviceState::active);
        ASSERT_EQ(report->scene_force.x, 0.1);
    }
}

TEST(Survival, an_application_that_is_killed_frees_the_device_though_its_child_lives) {
    ServoProcess servo;
    int ready[2], test_lives[2];
    ASSERT_EQ(::pipe(ready), 0);
    ASSERT_EQ(::pipe(test_lives), 0);
    const pid_t application = ::fork();
    if (application == 0) {
        ::close(test_lives[1]);
        Client client = connect();
        Claim hand = client.claim();
        const pid_t child = ::fork();
        if (child == 0) {
            // Keeps every descriptor that a careless child would keep, for the duration of the test.
            ::close(test_lives[1]);
            char nothing;
            while (::read(test_lives[0], &nothing, 1) < 0) {
            }
            ::_exit(0);
        }
        [[maybe_unused]] const ssize_t told = ::write(ready[1], &child, sizeof child);
        for (;;) hand.next_report(1s);
    }
    pid_t child = 0;
    ASSERT_EQ(::read(ready[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
    Client client = connect();
    EXPECT_THROW(client.claim(), Error);
    ::kill(application, SIGKILL);
    ::waitpid(application, nullptr, 0);
    claim_when_free(client);
    ::kill(child, SIGKILL);
    for (const int fd : {ready[0], ready[1], test_lives[0], test_lives[1]}) ::close(fd);
}

}  // namespace
