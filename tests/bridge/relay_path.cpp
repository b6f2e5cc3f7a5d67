// Additional features of a remote application: decimated reports, their age, the distance to the servo.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>

#include <knurl/link/clock.hpp>

#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

TEST(Path, reports_come_as_seldom_as_asked_for_and_answers_at_once) {
    ServoProcess servo;
    BridgeProcess bridge;
    Client client = connect_to(bridge, {}, 50);
    Claim hand = client.claim();
    auto force = hand.add(at_once({0.1, 0, 0}));
    auto last = hand.next_report(10s);
    ASSERT_TRUE(last);
    std::vector<std::int64_t> gaps;  // ns
    for (int i = 0; i < 21; ++i) {
        const auto next = hand.next_report(10s);
        ASSERT_TRUE(next);
        gaps.push_back(next->deadline_ns - last->deadline_ns);
        last = next;
    }
    // By the servo's own time stamps. If the machine stood still, one gap is longer, but not the median.
    std::ranges::nth_element(gaps, gaps.begin() + 10);
    EXPECT_EQ(gaps[10], 20'000'000) << "50 Hz";
    EXPECT_EQ(last->missed, 0u) << "what was not asked for is not missed";
    // An update is acknowledged within the next cycles, not within the next report.
    Client local = Client::connect("knurl:default", {.wait = 10s});
    Observer here = local.observe();
    ASSERT_TRUE(here.next_report(10s));
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();  // cycles
    for (int i = 0; i < 10; ++i) {
        const std::uint64_t before = here.latest()->cycle;
        force.set(at_once({0.001 * i, 0, 0}));
        ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
        least = std::min(least, here.latest()->cycle - before);
    }
    EXPECT_LT(least, 12u) << "each after the one before; with the reports that would be 20";
}

TEST(Path, the_newest_report_is_there_at_once_however_seldom_they_are_asked_for) {
    ServoProcess servo;
    BridgeProcess bridge;
    Client client = connect_to(bridge, {}, 0.01);
    for (int i = 0; i < 5; ++i) {
        Observer observer = client.observe();
        ASSERT_TRUE(observer.next_report(10s)) << "the next one comes in 100 s";
    }
}

TEST(Path, what_the_bridge_itself_overslept_is_counted_too) {
    ServoProcess servo({"--device", "sim:cartesian3", "--rate", "16000"});
    BridgeProcess bridge;
    Client client = connect_to(bridge), local = Client::connect("knurl:default", {.wait = 10s});
    Observer reader = client.observe(), watch = local.observe();
    const auto before = reader.next_report(10s);
    ASSERT_TRUE(before);
    ASSERT_EQ(::kill(bridge.pid(), SIGSTOP), 0);
    const auto stopped = watch.latest();
    ASSERT_TRUE(stopped);
    while (watch.latest()->cycle < stopped->cycle + 6000) watch.next_report(1s);  // 4095 are kept for it
    ASSERT_EQ(::kill(bridge.pid(), SIGCONT), 0);
    std::uint64_t read = 0;
    auto after = before;
    for (; after && after->cycle < stopped->cycle + 6000; ++read) after = reader.next_report(10s);
    ASSERT_TRUE(after);
    EXPECT_GT(after->missed - before->missed, 1000u);
    EXPECT_EQ(after->cycle - before->cycle, read + after->missed - before->missed);
    EXPECT_GE(reader.network().lost, 1000u);
}

TEST(Path, a_report_s_age_is_known_within_its_uncertainty) {
    ServoProcess servo;
    BridgeProcess bridge;
    Client client = connect_to(bridge);
    Observer observer = client.observe();
    for (int i = 0; i < 200; ++i) ASSERT_TRUE(observer.next_report(10s));
    const auto report = observer.next_report(10s);
    ASSERT_TRUE(report);
    // On one host both ends have the same clock.
    const std::int64_t before = detail::monotonic_ns() - report->read_ns;
    const Age age = observer.age(*report);
    const std::int64_t after = detail::monotonic_ns() - report->read_ns;
    EXPECT_GE(age.age.count() + age.uncertainty.count(), before);
    EXPECT_LE(age.age.count() - age.uncertainty.count(), after);
    EXPECT_GT(age.uncertainty, 0ns);
    const Network network = observer.network();
    EXPECT_LE(std::abs(network.clock_offset.count()), network.clock_uncertainty.count());
    EXPECT_GT(network.round_trip, 0ns);
    EXPECT_EQ(network.late, 0u);
    EXPECT_EQ(network.duplicated, 0u);
    EXPECT_FALSE(network.encrypted);
}

TEST(Path, on_one_box_there_is_no_network) {
    ServoProcess servo;
    Client client = Client::connect("knurl:default", {.wait = 20s});
    Observer observer = client.observe();
    const auto report = observer.next_report(10s);
    ASSERT_TRUE(report);
    EXPECT_EQ(observer.network().round_trip, 0ns);
    const Age age = observer.age(*report);
    EXPECT_GT(age.age, 0ns);
    EXPECT_EQ(age.uncertainty, 0ns);
}

TEST(Path, a_batch_of_any_size_arrives_whole) {
    ServoProcess servo;
    BridgeProcess bridge;
    Client client = connect_to(bridge);
    // Sizes from one datagram, over several, to batches that need TCP.
    for (const std::uint32_t count : {1u, 20u, 30u, 400u}) {
        Claim hand = client.claim("", {.shared = true, .representations = count});
        std::vector<Handle<ConstantForce>> forces;
        for (std::uint32_t i = 0; i < count; ++i) forces.push_back(hand.add(at_once({})));
        hand.arm();
        for (int round = 1; round <= 5; ++round) {
            const double share = 0.1 * round / count;
            for (auto& force : forces) force.set(at_once({share, 0, 0}));
            const std::uint64_t number = hand.commit();
            ASSERT_TRUE(hand.wait_applied(number, 10s)) << count;
            read_until(hand, [&](const HandReport& report) {
                return std::abs(report.scene_force.x - 0.1 * round) < 1e-9;
            });
            read_until(hand, [&](const HandReport&) {
                return std::ranges::all_of(forces, [&](const Handle<ConstantForce>& force) {
                    const auto felt = force.feedback();
                    return felt && felt->force.x == share;
                });
            });
        }
        EXPECT_EQ(hand.timing().refused, 0u);
    }
}

}  // namespace
}  // namespace knurl::bridge::test
