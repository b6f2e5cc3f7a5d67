// The life of a peer's claim: the test plays the clock, the servo and the peer.

#include <gtest/gtest.h>

#include <knurl/client/error.hpp>

#include "peer_life.hpp"

namespace {

using namespace knurl;
using namespace knurl::gateway;
using namespace std::chrono_literals;

/// What the servo is told, a word each.
class Recorder final : public PeerPort {
  public:
    void open() override {
        if (!refuse_open.empty()) throw Error(Error::Kind::device_held, refuse_open);
        did("open");
    }
    void close() noexcept override { did("close"); }
    Seen look() override { return seen; }
    void arm() override {
        if (!refuse_arm.empty()) throw Error(Error::Kind::refused, refuse_arm);
        did("arm");
    }
    void push(const Push& push, double fade) override {
        did("push " + number(push.force.x) + (fade < 0 ? "" : " over " + number(fade)));
    }
    void pull(const Vec3& from, const Vec3& to, double duration) override {
        did("pull " + number(from.x) + " to " + number(to.x) + " in " + number(duration));
    }
    void let_go() override { did("let go"); }
    void change(const ItemChange& change) override {
        const char* words[] = {"add ", "set ", "remove "};
        did(words[static_cast<int>(change.what)] + change.name);
    }
    void commit() override { ++commits; }
    std::map<std::string, PeerFeedback> feedback() override { return {}; }

    std::vector<std::string> calls() { return std::exchange(calls_, {}); }

    Seen seen{
        .connected = true, .servos = 0, .state = DeviceState::idle, .faults = 0, .position = Vec3{0.1, 0, 0}};
    std::string refuse_open, refuse_arm;
    int commits = 0;

  private:
    void did(std::string what) { calls_.push_back(std::move(what)); }
    static std::string number(double value) {
        char text[32];
        std::snprintf(text, sizeof text, "%g", value);
        return text;
    }
    std::vector<std::string> calls_;
};

using Calls = std::vector<std::string>;

class PeerLifeTest : public ::testing::Test {
  protected:
    Calls push(double x) {
        return step({.push = Push{{x, 0, 0}, {}}, .target = {}, .changes = {}, .alive = true});
    }
    Calls pull(double x) { return step({.push = {}, .target = Vec3{x, 0, 0}, .changes = {}, .alive = true}); }
    Calls change(ItemChange::What what, const std::string& name) {
        Orders orders{.push = {}, .target = {}, .changes = {}, .alive = true};
        orders.changes.push_back({.what = what, .name = name, .kind = 0, .params = {}, .options = {}});
        return step(orders);
    }
    Calls poll() { return step({.push = {}, .target = {}, .changes = {}, .alive = true}); }
    Calls wait(std::chrono::nanoseconds time) {
        now += time;
        return step({});
    }
    Calls step(Orders orders) {
        orders.at = now;
        again = life.step(now, orders);
        for (const Said& line : life.said()) said.push_back(line.text);
        return port.calls();
    }

    PeerOptions options{.device = "right"};
    Recorder port;
    PeerLife life{port, options};
    TimePoint now{1h};
    std::optional<TimePoint> again;
    std::vector<std::string> said;
};

TEST_F(PeerLifeTest, nothing_is_claimed_for_a_peer_that_only_looks) {
    EXPECT_EQ(poll(), Calls{});
    EXPECT_EQ(push(0), Calls{}) << "no force is how some clients ask for a position";
    EXPECT_EQ(poll(), Calls{});
    EXPECT_FALSE(life.status().claimed);
    EXPECT_FALSE(again) << "there is nothing to come back for";
}

TEST_F(PeerLifeTest, the_first_force_claims_arms_and_is_held_until_the_lapse) {
    EXPECT_EQ(push(2), (Calls{"open", "push 2", "arm"}));
    EXPECT_TRUE(life.status().claimed && life.status().armed && life.status().commands);
    EXPECT_EQ(again, now + options.lapse);
    EXPECT_EQ(wait(options.lapse - 1ns), Calls{});
    EXPECT_EQ(wait(1ns), Calls{"push 0 over 0.05"});
    EXPECT_FALSE(life.status().commands);
    EXPECT_EQ(wait(1s), Calls{}) << "once";
    EXPECT_EQ(push(3), Calls{"push 3"}) << "still claimed and armed";
}

TEST_F(PeerLifeTest, a_force_that_goes_on_is_told_once_and_committed_each_time) {
    push(2);
    const int before = port.commits;
    for (int i = 0; i < 10; ++i) {
        now += 5ms;
        EXPECT_EQ(push(2), Calls{});
    }
    EXPECT_EQ(port.commits, before + 10) << "each says: I am alive";
    EXPECT_EQ(wait(options.lapse - 1ns), Calls{}) << "the lapse counts from the last one";
    EXPECT_EQ(wait(1ns), Calls{"push 0 over 0.05"});
}

TEST_F(PeerLifeTest, free_space_in_a_force_loop_neither_lapses_nor_releases) {
    push(2);
    for (int i = 0; i < 2000; ++i) {
        now += 5ms;
        EXPECT_EQ(push(0), i == 0 ? Calls{"push 0"} : Calls{});
    }
    EXPECT_EQ(push(1), Calls{"push 1"});
}

TEST_F(PeerLifeTest, a_message_without_a_command_does_not_prolong_the_force) {
    push(2);
    now += 99ms;
    EXPECT_EQ(poll(), Calls{});
    now += 1ms;
    EXPECT_EQ(poll(), Calls{"push 0 over 0.05"});
}

TEST_F(PeerLifeTest, the_device_is_released_some_seconds_after_the_last_command) {
    push(2);
    EXPECT_EQ(wait(options.lapse), Calls{"push 0 over 0.05"});
    EXPECT_EQ(again, now - options.lapse + options.release_after);
    EXPECT_EQ(wait(*again - now), Calls{"close"});
    EXPECT_FALSE(life.status().claimed);
    EXPECT_FALSE(again);
    EXPECT_EQ(push(1), (Calls{"open", "push 1", "arm"})) << "and claimed again by the next one";
}

TEST_F(PeerLifeTest, representations_hold_the_device) {
    EXPECT_EQ(change(ItemChange::What::add, "floor"), (Calls{"open", "add floor", "arm"}));
    EXPECT_EQ(wait(1h), Calls{}) << "the servo itself fades those of a silent claim";
    EXPECT_EQ(change(ItemChange::What::set, "floor"), Calls{"set floor"});
    EXPECT_EQ(change(ItemChange::What::remove, "floor"), Calls{"remove floor"});
    EXPECT_EQ(wait(options.release_after), Calls{"close"});
}

TEST_F(PeerLifeTest, a_target_begins_at_the_hand_and_moves_at_a_speed) {
    EXPECT_EQ(pull(0.15), (Calls{"open", "pull 0.1 to 0.15 in 0.2", "arm"}));
    now += 5ms;
    EXPECT_EQ(pull(0.15), Calls{});
    EXPECT_EQ(pull(0.14), Calls{"pull 0.15 to 0.14 in 0.04"});
    EXPECT_EQ(wait(options.lapse), Calls{"let go"});
}

TEST_F(PeerLifeTest, a_device_that_is_held_is_tried_again_and_said_once) {
    port.refuse_open = "device 'right' is held by process 7";
    for (int i = 0; i < 300; ++i) {
        EXPECT_EQ(push(2), Calls{});
        now += 10ms;
    }
    EXPECT_EQ(said, std::vector<std::string>{port.refuse_open});
    port.refuse_open.clear();
    EXPECT_EQ(wait(0ms), (Calls{"open", "push 2", "arm"})) << "of three seconds ago, less than a lapse old";
}

TEST_F(PeerLifeTest, a_claim_that_comes_too_late_is_not_made) {
    port.refuse_open = "held";
    push(2);
    port.refuse_open.clear();
    EXPECT_EQ(wait(options.retry), Calls{}) << "the command has lapsed meanwhile";
}

TEST_F(PeerLifeTest, a_hand_that_is_too_fast_is_armed_later_and_it_is_said_once) {
    port.refuse_arm = "cannot arm device 'right': the hand is too fast";
    EXPECT_EQ(push(2), (Calls{"open", "push 2"}));
    for (int i = 0; i < 150; ++i) {
        now += 10ms;
        EXPECT_EQ(push(2), Calls{});
    }
    EXPECT_EQ(said, std::vector<std::string>{port.refuse_arm});
    port.refuse_arm.clear();
    now += options.retry;
    EXPECT_EQ(push(2), Calls{"arm"});
}

TEST_F(PeerLifeTest, a_fault_is_said_once_and_armed_again_after_the_reset) {
    push(2);
    port.seen.state = DeviceState::fault;
    port.seen.faults = fault::speed;
    for (int i = 0; i < 500; ++i) {
        now += 10ms;
        EXPECT_EQ(push(2), Calls{});
    }
    ASSERT_EQ(said.size(), 1u);
    EXPECT_NE(said[0].find("in fault (speed)"), std::string::npos) << said[0];
    EXPECT_FALSE(life.status().armed);
    port.seen.state = DeviceState::idle;
    EXPECT_EQ(push(2), Calls{"arm"});
}

TEST_F(PeerLifeTest, after_a_restart_of_the_servo_it_is_armed_again_if_the_peer_goes_on) {
    push(2);
    port.seen.connected = false;
    now += 10ms;
    EXPECT_EQ(push(2), Calls{});
    EXPECT_EQ(said.size(), 1u);
    port.seen.connected = true;
    port.seen.servos = 1;
    now += 10ms;
    EXPECT_EQ(push(2), Calls{"arm"}) << "the client library has brought the force itself";
}

TEST_F(PeerLifeTest, after_a_restart_nothing_is_armed_for_a_peer_that_has_stopped) {
    push(2);
    port.seen.connected = false;
    now += 10ms;
    push(2);
    EXPECT_EQ(wait(1s), Calls{});
    port.seen.connected = true;
    port.seen.servos = 1;
    EXPECT_EQ(wait(1ms), Calls{"push 0 over 0.05"}) << "the force that was brought is taken away";
    EXPECT_FALSE(life.status().armed);
}

TEST_F(PeerLifeTest, who_may_not_arm_does_not) {
    options.may_arm = false;
    EXPECT_EQ(push(2), (Calls{"open", "push 2"}));
    EXPECT_EQ(wait(50ms), Calls{});
    EXPECT_FALSE(life.status().armed);
}

TEST_F(PeerLifeTest, the_end_releases) {
    push(2);
    life.end();
    EXPECT_EQ(port.calls(), Calls{"close"});
    life.end();
    EXPECT_EQ(port.calls(), Calls{});
}

TEST(PeerHandRefusal, what_is_no_force_is_refused_with_field_and_range) {
    PeerHand hand({.device = "right"});
    const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
    EXPECT_EQ(hand.push({1, 2, 1000}, "f"), "");
    EXPECT_EQ(hand.push({1, 2, 1000.5}, "f"), "f.z is 1000.5 N; it must be -1000 to 1000 N");
    EXPECT_EQ(hand.push({nan, 0, 0}, "f"), "f.x is nan; it must be a finite number, -1000 to 1000 N");
    EXPECT_EQ(hand.push({0, -inf, 0}, "f"), "f.y is -inf; it must be a finite number, -1000 to 1000 N");
    EXPECT_EQ(hand.push({}, {0, 0, 101}, "t"), "t.z is 101 N m; it must be -100 to 100 N m");
    EXPECT_EQ(hand.pull({0, 0, 11}, "p"), "p.z is 11 m; it must be -10 to 10 m");
    EXPECT_NE(hand.set("floor", {}), "");
    EXPECT_NE(hand.remove("floor"), "");
}

}  // namespace
