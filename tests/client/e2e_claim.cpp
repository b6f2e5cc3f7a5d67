// The guarantees of a claim: related changes arrive together, bad ones never; silence and forks do no harm.

#include <limits>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include <knurl/reps/spring.hpp>

#include "servo_process.hpp"

namespace {

using namespace knurl;
using namespace client_test;

TEST(Claim, bad_parameters_throw_at_the_call_and_change_nothing) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    const auto refused = [](auto call, const std::string& field, const std::string& value) {
        try {
            call();
            ADD_FAILURE() << field << " = " << value << " was accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind, Error::Kind::bad_parameters);
            EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(value), std::string::npos) << error.what();
        }
    };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    refused([&] { hand.add(Plane{.stiffness = -5}); }, "plane.stiffness", "-5 N/m");
    refused([&] { hand.add(Plane{.normal = {0, 0, 0}, .stiffness = 5}); }, "plane.normal", "0");
    refused([&] { hand.add(Spring{.rest_length = -1, .stiffness = 1}); }, "spring.rest_length", "-1 m");
    refused([&] { hand.add(ConstantForce{.force = {nan, 0, 0}}); }, "constant_force.force", "nan");
    refused([&] { hand.add(ConstantForce{}, {.probe = 16}); }, "probe", "16");
    refused([&] { hand.add(ConstantForce{}, {.silence_time = -1}); }, "silence_time", "-1");
    refused([&] { hand.place_probe(0, {.offset = {}, .radius = -1}); }, "radius", "-1");

    auto floor = hand.add(Plane{.offset = 0.25, .stiffness = 300});
    refused([&] { floor.set({.offset = nan, .stiffness = 300}); }, "plane.offset", "nan");
    EXPECT_EQ(floor.params().offset, 0.25);
    EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s)) << "and spoilt nothing that was sent with it";
    EXPECT_EQ(hand.timing().refused, 0u);
}

TEST(Claim, all_representations_of_a_claim_that_states_nothing_fit_into_one_commit) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    std::vector<Handle<Plane>> planes;
    for (std::uint32_t i = 0; i < ClaimOptions{}.representations; ++i)
        planes.push_back(hand.add(Plane{.offset = -1, .stiffness = 100}));
    for (Handle<Plane>& plane : planes) plane.set({.offset = -2, .stiffness = 200});
    EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s));
    EXPECT_EQ(hand.timing().refused, 0u);
}

TEST(Claim, what_is_committed_together_is_felt_in_one_cycle) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    std::optional<Handle<ConstantForce>> x, y, z;
    hand.together([&] {
        x = hand.add(at_once({0.1, 0, 0}));
        y = hand.add(at_once({0, 0.1, 0}));
        z = hand.add(at_once({0, 0, 0.1}));
    });
    hand.arm();
    read_until(hand, [](const HandReport& report) { return report.scene_force.x == 0.1; });

    Observer watch = client.observe();
    const std::uint32_t seed = std::random_device{}();
    std::mt19937 random(seed);
    for (int i = 1; i <= 60; ++i) {
        const double force = 0.1 + 0.002 * i;
        x->set(at_once({force, 0, 0}));
        // No wait for an event, so that the commit falls into any phase of the cycle.
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 2000));
        y->set(at_once({0, force, 0}));
        z->set(at_once({0, 0, force}));
        hand.commit();
        if (i % 20 == 0) {  // removing and adding, too
            hand.together([&] {
                x->remove();
                y->remove();
                z->remove();
                x = hand.add(at_once({force, 0, 0}));
                y = hand.add(at_once({0, force, 0}));
                z = hand.add(at_once({0, 0, force}));
            });
        }
        while (const auto report = watch.next_report(0ns)) {
            ASSERT_EQ(report->scene_force.x, report->scene_force.y)
                << "cycle " << report->cycle << " seed " << seed;
            ASSERT_EQ(report->scene_force.x, report->scene_force.z)
                << "cycle " << report->cycle << " seed " << seed;
        }
    }
    ASSERT_TRUE(hand.wait_applied(0, 10s));
    read_until(hand, [](const HandReport& report) { return std::abs(report.scene_force.x - 0.22) < 1e-9; });
}

TEST(Claim, a_group_that_fails_half_way_leaves_nothing_behind) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim("", {.representations = 2});
    auto kept = hand.add(at_once({0.1, 0, 0}));
    EXPECT_THROW(hand.together([&] {
        kept.remove();
        hand.add(at_once({0, 0.1, 0}));
        hand.add(Plane{.stiffness = -1});
    }),
                 Error);
    EXPECT_EQ(kept.params().force.x, 0.1) << "its removal was taken back";
    hand.add(at_once({0, 0, 0.1}));  // the place of the unsent one is free
    EXPECT_THROW(hand.add(at_once({0, 0, 0.1})), Error);
    EXPECT_THROW(hand.together([&] { hand.commit(); }), Error);
    EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s));
}

TEST(Claim, a_group_that_the_servo_refuses_removes_nothing) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    auto push = hand.add(at_once({0.1, 0, 0}));
    EXPECT_THROW(hand.together([&] {
        push.remove();
        hand.reset_fault();  // refused: there is no fault
    }),
                 Error);
    push.set(at_once({0.2, 0, 0}));  // the servo still has it, and so has the client
    EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s));
    EXPECT_EQ(hand.timing().refused, 0u);
    hand.together([&] {
        push.remove();
        hand.disarm();
    });
    EXPECT_THROW(push.set(at_once({0.3, 0, 0})), Error) << "now it is gone";
    EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s));
}

TEST(Claim, a_full_channel_is_told_and_nothing_is_dropped) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim("", {.representations = 1024});
    servo.stop();
    std::vector<Handle<Spring>> springs;
    std::uint64_t tries = 0;
    try {
        // Few are kept: 128 fill the cycle of a build with ThreadSanitizer, which then refuses more.
        for (; tries < 100'000; ++tries) {
            springs.push_back(hand.add(Spring{.stiffness = 1}));
            if (springs.size() == 32) {
                springs.back().remove();
                springs.pop_back();
            }
        }
        FAIL() << "the channel was never full";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind, Error::Kind::channel_full) << error.what();
    }
    servo.go_on();
    for (bool room = false; !room;) {
        hand.next_report(10s);
        try {
            hand.add(Plane{.stiffness = 1});
            room = true;
        } catch (const Error& error) {
            ASSERT_EQ(error.kind, Error::Kind::channel_full) << error.what();
        }
    }
    ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s)) << "a batch comes after all commands before it";
    for (const auto& spring : springs) ASSERT_EQ(spring.applied_stiffness(), 1.0) << "each of them is there";
}

TEST(Claim, felt_force_and_applied_stiffness_come_back) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    const Vec3 centre = hand.device().workspace_centre;
    auto floor = hand.add(Plane{.normal = {0, 0, 1},
                                .offset = centre.z + 0.001,  // under the hand at rest
                                .stiffness = std::numeric_limits<double>::infinity()});
    hand.arm();
    std::optional<HandFeedback> felt;
    read_until(hand, [&](const HandReport& report) {
        felt = floor.feedback();
        return is_on(report) && felt && felt->force.z > 0;
    });
    EXPECT_EQ(felt->force.x, 0);
    EXPECT_NE(felt->flags & Feedback::touching, 0u);
    EXPECT_NE(felt->flags & Feedback::stiffness_clamped, 0u);
    EXPECT_EQ(felt->stiffness, hand.limits().max_stiffness);
    EXPECT_EQ(floor.applied_stiffness(), hand.limits().max_stiffness);
}

TEST(Claim, knows_how_late_its_updates_are) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    auto force = hand.add(at_once({}));
    EXPECT_EQ(hand.timing().age_at_use, 0ns) << "not measured yet";
    for (int i = 1; i <= 10; ++i) {
        const auto report = hand.next_report(10s);
        ASSERT_TRUE(report);
        for (int n = 0; n < 5; ++n) hand.next_report(10s);  // a computation of five cycles
        force.set(at_once({0.001 * i, 0, 0}));
        ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
    }
    const Timing timing = hand.timing();
    EXPECT_EQ(timing.batches, 10u);
    EXPECT_EQ(timing.refused, 0u);
    EXPECT_GT(timing.age_at_use, 0ns);
    EXPECT_GT(timing.interval, 0ns);
}

TEST(Claim, follows_a_model_with_the_plane_under_the_hand) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    const double height = hand.device().workspace_centre.z + 0.002;
    auto floor = hand.add(Plane{.offset = -1, .stiffness = 500});
    hand.arm();
    read_until(hand, is_on);
    for (int i = 0; i < 10; ++i) {
        floor.follow([&](const Vec3& q) {
            return SurfacePoint{.foot = {q.x, q.y, height}, .normal = {0, 0, 2}};
        });
        ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
    }
    EXPECT_NEAR(floor.params().offset, height, 1e-12);
    EXPECT_EQ(floor.params().normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(floor.params().stiffness, 500) << "the rest stays";
    // A hand that the plane has lifted may be above it for a moment.
    read_until(hand, [&](const HandReport&) { return floor.feedback()->force.z > 0; });
}

TEST(Claim, that_falls_silent_fades_and_comes_back_with_the_next_commit) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim("", {.update_interval = 10ms});
    auto force = hand.add(at_once({0.5, 0, 0}));
    hand.arm();
    read_until(hand, [](const HandReport& report) { return report.scene_force.x == 0.5; });
    const auto start = hand.latest();
    ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
    // No commits from here on. 250 ms count as silence, over a network 450 ms; then the force fades within
    // 100 ms. Judged by the servo's own stamps.
    const std::int64_t whole_ns = ServoProcess::through_bridge() ? 400'000'000 : 200'000'000;
    double previous = 0.5;
    bool whole_at_first = true;
    std::int64_t gone_after = 0;
    while (gone_after == 0) {
        const auto report = hand.next_report(10s);
        ASSERT_TRUE(report);
        const std::int64_t silent = report->read_ns - start->read_ns;
        if (silent < whole_ns) whole_at_first = whole_at_first && report->scene_force.x == 0.5;
        EXPECT_LE(report->scene_force.x, previous) << "it only falls";
        previous = report->scene_force.x;
        if (report->scene_force.x == 0) gone_after = silent;
        ASSERT_LT(silent, 5'000'000'000);
    }
    EXPECT_TRUE(whole_at_first);
    read_until(hand, [](const HandReport& report) { return report.scene_force.x == 0.5; });
}

TEST(Claim, shared_by_two_adds_their_forces) {
    ServoProcess servo;
    Client client = connect();
    Client other_client = connect();
    Claim one = client.claim("", {.shared = true});
    EXPECT_THROW(other_client.claim(), Error) << "sharing is for those who both say so";
    Claim two = other_client.claim("", {.shared = true});
    one.add(at_once({0.2, 0, 0}));
    two.add(at_once({0, 0.3, 0}));
    one.arm();
    two.arm();
    read_until(one, [&](const HandReport& report) {
        two.commit();
        return report.scene_force.x == 0.2 && report.scene_force.y == 0.3;
    });
    two.release();
    read_until(one, [](const HandReport& report) {
        return report.scene_force.x == 0.2 && report.scene_force.y == 0;
    });
}

}  // namespace
