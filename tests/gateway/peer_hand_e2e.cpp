// A PeerHand against a real servo with a simulated device.

#include <gtest/gtest.h>

#include <knurl/gateway/peer_hand.hpp>
#include <knurl/reps/plane.hpp>

#include "../client/servo_process.hpp"

namespace {

using namespace knurl;
using namespace knurl::gateway;
using namespace client_test;

PeerOptions options() {
    PeerOptions made;
    made.peer = "peer";
    return made;
}

/// What the device is sent, seen from outside.
struct Watch {
    Client client = connect();
    Observer observer = client.observe();

    /// Reads until a report is as wanted, and does `meanwhile` before each.
    template <class Wanted, class Meanwhile>
    bool until(Wanted wanted, Meanwhile meanwhile) {
        return eventually([&] {
            meanwhile();
            const auto report = observer.latest();
            return report && wanted(*report);
        });
    }
};

void push(PeerHand& hand, const Vec3& force) {
    EXPECT_EQ(hand.push(force, "force"), "");
    hand.sent();
}

TEST(PeerHandServo, a_force_is_felt_while_it_is_commanded_and_fades_when_it_is_not) {
    ServoProcess servo;
    Watch watch;
    PeerHand hand(options());
    ASSERT_TRUE(
        watch.until([](const HandReport& r) { return is_active(r) && std::abs(r.sent_force.x - 0.2) < 1e-9; },
                    [&] {
                        push(hand, {0.2, 0, 0});
                    }));
    EXPECT_TRUE(hand.status().claimed && hand.status().armed);
    ASSERT_TRUE(watch.until([](const HandReport& r) { return r.sent_force == Vec3{}; }, [] {}))
        << "it lapses by itself";
    EXPECT_TRUE(hand.status().claimed) << "and is held for the next one";
    ASSERT_TRUE(watch.until([](const HandReport& r) { return r.sent_force.x > 0.1; },
                            [&] {
                                push(hand, {0.2, 0, 0});
                            }));
    EXPECT_TRUE(hand.said().empty());
}

TEST(PeerHandServo, the_fade_has_no_jump) {
    ServoProcess servo;
    Watch watch;
    PeerHand hand(options());
    ASSERT_TRUE(
        watch.until([](const HandReport& r) { return is_active(r) && std::abs(r.sent_force.x - 0.4) < 1e-9; },
                    [&] {
                        push(hand, {0.4, 0, 0});
                    }));
    while (watch.observer.next_report(0ns)) {
    }
    double last = 0.4;
    int between = 0;
    for (;;) {
        const auto report = watch.observer.next_report(10s);
        ASSERT_TRUE(report);
        EXPECT_LT(std::abs(report->sent_force.x - last), 0.4 * 0.06) << "of a fade over 50 cycles";
        last = report->sent_force.x;
        between += last > 0 && last < 0.4 ? 1 : 0;
        if (last == 0) break;
    }
    EXPECT_GT(between, 30);
    EXPECT_EQ(watch.observer.missed(), 0u);
}

TEST(PeerHandServo, its_end_releases_the_device_at_once) {
    ServoProcess servo;
    Watch watch;
    auto hand = std::make_unique<PeerHand>(options());
    ASSERT_TRUE(watch.until(is_active, [&] { push(*hand, {0.2, 0, 0}); }));
    EXPECT_THROW(watch.client.claim(), Error) << "it is shared, and this one is not";
    hand.reset();
    claim_when_free(watch.client);
}

TEST(PeerHandServo, a_device_that_is_held_is_said_and_claimed_when_it_is_free) {
    ServoProcess servo;
    Watch watch;
    std::optional<Claim> other = watch.client.claim();
    PeerHand hand(options());
    std::vector<Said> said;
    ASSERT_TRUE(eventually([&] {
        push(hand, {0.2, 0, 0});
        for (Said& line : hand.said()) said.push_back(line);
        return !said.empty();
    }));
    EXPECT_EQ(said[0].subject, "claim");
    EXPECT_NE(said[0].text.find(std::to_string(::getpid())), std::string::npos) << said[0].text;
    other.reset();
    EXPECT_TRUE(watch.until(is_active, [&] { push(hand, {0.2, 0, 0}); }));
    EXPECT_TRUE(hand.said().empty());
}

TEST(PeerHandServo, after_a_restart_of_the_servo_the_force_is_back_if_it_is_commanded) {
    ServoProcess servo;
    Watch watch;
    PeerHand hand(options());
    const auto felt = [](const HandReport& r) {
        return is_active(r) && std::abs(r.sent_force.x - 0.2) < 1e-9;
    };
    ASSERT_TRUE(watch.until(felt, [&] { push(hand, {0.2, 0, 0}); }));
    servo.end(SIGKILL);
    ASSERT_TRUE(eventually([&] {
        push(hand, {0.2, 0, 0});
        return !hand.status().armed;
    }));
    servo.start();
    EXPECT_TRUE(watch.until(felt, [&] { push(hand, {0.2, 0, 0}); }));
}

TEST(PeerHandServo, after_a_restart_of_the_servo_nothing_is_armed_for_who_has_stopped) {
    ServoProcess servo;
    Watch watch;
    PeerHand hand(options());
    ASSERT_TRUE(watch.until(is_active, [&] { push(hand, {0.2, 0, 0}); }));
    servo.end(SIGKILL);
    ASSERT_TRUE(eventually([&] { return !hand.status().armed && !hand.status().commands; }));
    servo.start();
    ASSERT_TRUE(eventually([&] { return watch.observer.connected(); }));
    for (int i = 0; i < 500; ++i) {
        const auto report = watch.observer.next_report(10s);
        ASSERT_TRUE(report);
        ASSERT_EQ(report->sent_force, Vec3{});
        ASSERT_TRUE(report->state == DeviceState::idle) << static_cast<int>(report->state);
    }
}

TEST(PeerHandServo, a_target_draws_the_hand_and_a_plane_is_felt) {
    ServoProcess servo;
    Watch watch;
    PeerHand hand(options());
    const Vec3 start = watch.observer.newest(10s)->position;
    const Vec3 target{start.x + 0.01, start.y, start.z};
    // The simulated hand holds with a force of its own; the spring draws it some of the way.
    ASSERT_TRUE(watch.until([&](const HandReport& r) { return is_active(r) && r.sent_force.x > 0.05; },
                            [&] {
                                EXPECT_EQ(hand.pull(target, "position"), "");
                                hand.sent();
                            }));
    // Lets go; then a floor of which the hand is 5 mm inside.
    ASSERT_TRUE(watch.until([](const HandReport& r) { return std::abs(r.sent_force.x) < 1e-3; }, [] {}));
    const Plane plane{.normal = {0, 0, 1}, .offset = start.z + 0.005, .stiffness = 200, .recovery = 0};
    std::vector<std::byte> bytes(sizeof plane);
    std::memcpy(bytes.data(), &plane, sizeof plane);
    EXPECT_EQ(hand.add("floor", kind_number<Plane>(), bytes), "");
    hand.sent();
    ASSERT_TRUE(watch.until([](const HandReport& r) { return r.sent_force.z > 0.05; }, [&] { hand.sent(); }));
    ASSERT_TRUE(eventually([&] {
        hand.sent();
        const auto all = hand.status().representations;
        return all.contains("floor") && all.at("floor").force.z > 0.05 && all.at("floor").stiffness == 200;
    }));
    EXPECT_EQ(hand.remove("floor"), "");
    hand.sent();
    ASSERT_TRUE(
        watch.until([](const HandReport& r) { return r.sent_force == Vec3{}; }, [&] { hand.sent(); }));
}

TEST(PeerHandServo, without_a_servo_nothing_waits_and_the_end_does_not_either) {
    const knurl::test::TempFolder folder;
    ::setenv("KNURL_RUNTIME_DIR", folder.path().c_str(), 1);
    PeerHand hand(options());
    std::vector<Said> said;
    ASSERT_TRUE(eventually([&] {
        push(hand, {0.2, 0, 0});
        for (Said& line : hand.said()) said.push_back(line);
        return !said.empty();
    }));
    EXPECT_NE(said[0].text.find("default"), std::string::npos) << said[0].text;
}

}  // namespace
