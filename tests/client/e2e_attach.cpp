// Connecting: what a user sees when something is wrong, in one line each.

#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "../rights.hpp"
#include "refusal.hpp"
#include "servo_process.hpp"

namespace {

using namespace knurl;
using namespace client_test;

TEST(Attach, waits_for_a_servo_that_is_still_starting) {
    ServoProcess servo;  // just forked: it listens later
    Client client = connect();
    ASSERT_EQ(client.devices().size(), 1u);
    EXPECT_EQ(client.devices()[0].name, "cartesian3");
    EXPECT_EQ(client.devices()[0].rate, 1000);
    EXPECT_EQ(client.servo_pid(), servo.pid());
}

TEST(Attach, without_a_servo_names_the_socket_and_the_command_that_starts_one) {
    ServoProcess servo;
    const Error error = refusal([] { Client::connect("knurl:other", {.wait = 30ms}); });
    EXPECT_EQ(error.kind, Error::Kind::no_servo);
    says(error.what(), "other.sock");
    says(error.what(), "knurld --name other");
}

TEST(Attach, without_the_right_says_whose_socket_it_is_and_what_to_do) {
    ServoProcess servo;
    connect();
    const pid_t child = ::fork();
    if (child == 0) {
        // Root may open everything, so another user has to try; a socket of mode 0 stops any other user.
        const auto leave_root = [] {
            return ::setgroups(0, nullptr) == 0 && ::setgid(65534) == 0 && ::setuid(65534) == 0;
        };
        if (!leave_root() && ::chmod(servo.socket().c_str(), 0) != 0) ::_exit(2);
        try {
            Client::connect("knurl:default", {.wait = 0ms});
        } catch (const Error& error) {
            const std::string text = error.what();
            ::_exit(error.kind == Error::Kind::permission && text.find("usermod -aG") != std::string::npos
                        ? 0
                        : 3);
        }
        ::_exit(4);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    if (WEXITSTATUS(status) == 4 && ::geteuid() == 0) KNURL_NEEDS(knurl::test::missing_other_user());
    EXPECT_EQ(WEXITSTATUS(status), 0) << "2: could not become somebody else, 3: wrong error, 4: let in";
}

TEST(Attach, one_process_leaves_others_as_many_places_as_it_takes) {
    ServoProcess servo;
    connect_beside();
    std::vector<Client> all;
    const auto one_more = [&] { all.push_back(Client::connect("knurl:default", {.wait = 0ms})); };
    const Error error = refusal([&] {
        for (;;) one_more();
    });
    EXPECT_EQ(error.kind, Error::Kind::refused);
    says(error.what(), "and nobody may hold more than he leaves, of its 320 connections");
#if !defined(__SANITIZE_THREAD__)  // which allows no new thread in the child of a fork
    const pid_t other = ::fork();
    ASSERT_GE(other, 0);
    if (other == 0) {
        try {
            Client::connect("knurl:default", {.wait = 0ms});
            ::_exit(0);
        } catch (const Error&) {
            ::_exit(1);
        }
    }
    int status = 0;
    ::waitpid(other, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0) << "another process is let in";
#endif
    all.pop_back();
    EXPECT_TRUE(connect_beside().connected());
}

TEST(Attach, a_device_that_does_not_exist_is_answered_with_those_that_do) {
    ServoProcess servo({"--device", "left=sim:cartesian3", "--device", "right=sim:premium15"});
    Client client = connect();
    const Error unknown = refusal([&] { client.claim("middle"); });
    EXPECT_EQ(unknown.kind, Error::Kind::no_such_device);
    says(unknown.what(), "left, right");
    const Error which = refusal([&] { client.claim(); });
    EXPECT_EQ(which.kind, Error::Kind::no_such_device);
    says(which.what(), "say which one: left, right");
    EXPECT_EQ(client.claim("right").device().profile, "premium15");
}

TEST(Attach, the_second_claim_is_told_who_holds_the_device) {
    ServoProcess servo;
    Client client = connect();
    Claim first = client.claim();
    const Error error = refusal([&] { connect().claim(); });
    EXPECT_EQ(error.kind, Error::Kind::device_held);
    EXPECT_EQ(error.holder, servo.claimant());
    says(error.what(), std::to_string(servo.claimant()));
    EXPECT_TRUE(first.next_report(10s));
}

TEST(Attach, a_released_device_can_be_claimed_again) {
    ServoProcess servo;
    Client client = connect();
    {
        Claim first = client.claim();
        auto id = first.add(ConstantForce{.force = {1, 0, 0}});
        first.release();
        EXPECT_EQ(refusal([&] { first.commit(); }).kind, Error::Kind::stale_handle);
        EXPECT_EQ(refusal([&] { id.set({}); }).kind, Error::Kind::stale_handle);
    }
    claim_when_free(client);  // its force fades first
}

TEST(Attach, observers_need_no_claim_and_disturb_none) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim("", {.workspace_radius = 1.0, .workspace_centre = {5, 6, 7}});
    Observer observer = client.observe();
    const auto seen = observer.next_report(10s);
    ASSERT_TRUE(seen);
    // The same cycle, in the world of one claim and in the device's frame of the other.
    auto mine = hand.next_report(10s);
    while (mine && mine->cycle < seen->cycle) mine = hand.next_report(10s);
    ASSERT_TRUE(mine);
    ASSERT_EQ(mine->cycle, seen->cycle);
    const DeviceDescription device = hand.device();
    const double scale = 1.0 / device.workspace_radius;
    EXPECT_NEAR(mine->position.x, scale * (seen->position.x - device.workspace_centre.x) + 5, 1e-12);
    EXPECT_NEAR(mine->position.y, scale * (seen->position.y - device.workspace_centre.y) + 6, 1e-12);
    EXPECT_NEAR(mine->position.z, scale * (seen->position.z - device.workspace_centre.z) + 7, 1e-12);
    EXPECT_NEAR(hand.limits().max_stiffness * scale, device.max_stiffness, 1e-6 * device.max_stiffness);
}

}  // namespace
