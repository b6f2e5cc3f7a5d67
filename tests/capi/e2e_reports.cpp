// Reading: the newest, the next, many at once, and when to look.

#include <algorithm>
#include <cstddef>

#include <poll.h>

#include "e2e_support.hpp"

namespace capi_test {
namespace {

TEST_F(CHand, reports_come_in_order_and_as_the_newest) {
    knurl_report first = sized<knurl_report>(), next = first;
    ASSERT_TRUE(did(knurl_next_report(hand, KNURL_FOREVER, &first)));
    EXPECT_NEAR(first.position.x, device.workspace_centre.x, 0.1);
    EXPECT_GT(first.write_ns, first.read_ns);
    EXPECT_EQ(first.size, sizeof first);
    for (int i = 0; i < 50; ++i) {
        ASSERT_TRUE(did(knurl_next_report(hand, 20 * s, &next)));
        EXPECT_EQ(next.cycle, first.cycle + 1 + next.missed - first.missed);
        first = next;
    }
    std::uint64_t missed = 1;
    ASSERT_TRUE(did(knurl_missed(hand, &missed)));
    EXPECT_EQ(missed, next.missed);
    knurl_report latest = sized<knurl_report>();
    ASSERT_TRUE(did(knurl_latest(hand, &latest)));
    EXPECT_GE(latest.cycle, next.cycle);
    knurl_frame frame = sized<knurl_frame>();
    ASSERT_TRUE(did(knurl_newest(hand, KNURL_FOREVER, &frame)));
    EXPECT_GT(frame.report.cycle, latest.cycle);
    EXPECT_EQ(frame.report.size, sizeof(knurl_report));
    std::int64_t age = -1, uncertainty = -1;
    ASSERT_TRUE(did(knurl_age(hand, frame.report.read_ns, &age, &uncertainty)));
    EXPECT_GT(age + uncertainty, 0);
    EXPECT_GE(uncertainty, 0);
    EXPECT_TRUE(did(knurl_age(hand, frame.report.read_ns, &age, nullptr)));
    knurl_network between = sized<knurl_network>();
    ASSERT_TRUE(did(knurl_network_of(hand, &between)));
    if (ServoProcess::through_bridge())
        EXPECT_GT(between.round_trip_ns, 0);
    else
        EXPECT_EQ(between.round_trip_ns, 0);
    EXPECT_EQ(between.reserved, 0u);
}

TEST_F(CHand, many_reports_come_in_one_call_with_the_callers_stride) {
    std::vector<Later<knurl_report>> some(40);
    knurl_hand* watch = nullptr;
    ASSERT_TRUE(did(knurl_observe(client, nullptr, &watch)));
    knurl_report one = sized<knurl_report>();
    std::uint64_t last = 0;
    for (std::size_t got = 0; got < 300;) {
        for (int i = 0; i < 100; ++i) {  // meanwhile the hand's own are unread
            ASSERT_TRUE(did(knurl_next_report(watch, 20 * s, &one)));
        }
        for (std::size_t count = 1; count > 0; got += count) {
            for (auto& each : some) each.tail[2] = 7;
            count = 99;
            const int code = knurl_reports(hand, &some[0].known, some.size(), &count);
            ASSERT_GE(code, 0) << knurl_error(hand);
            ASSERT_EQ(code == KNURL_OK, count > 0);
            ASSERT_LE(count, some.size());
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_EQ(some[i].known.size, sizeof some[i]);
                ASSERT_EQ(some[i].tail[2], 7u);
                ASSERT_TRUE(last == 0 || some[i].known.cycle == last + 1) << "none is left out";
                last = some[i].known.cycle;
            }
        }
    }
    std::size_t count = 99;
    EXPECT_TRUE(did(knurl_reports(hand, nullptr, 0, &count)));
    EXPECT_EQ(count, 0u);
}

TEST_F(CHand, many_reports_at_once_are_those_that_come_one_by_one) {
    knurl_hand *one = nullptr, *many = nullptr, *watch = nullptr;
    for (knurl_hand** observer : {&one, &many, &watch})
        ASSERT_TRUE(did(knurl_observe(client, nullptr, observer)));
    knurl_report report = sized<knurl_report>();
    for (int i = 0; i < 200; ++i) {
        ASSERT_TRUE(did(knurl_next_report(watch, 20 * s, &report)));
    }
    std::vector<knurl_report> some(300, sized<knurl_report>());
    std::size_t count = 0;
    ASSERT_TRUE(did(knurl_reports(many, some.data(), some.size(), &count)));
    // Over a network both have gaps of their own.
    std::size_t both = 0;
    while (both < count && knurl_next_report(one, 100 * ms, &report) == KNURL_OK &&
           report.cycle <= some[count - 1].cycle) {
        const auto same = std::find_if(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count),
                                       [&](const knurl_report& each) { return each.cycle == report.cycle; });
        if (same == some.begin() + static_cast<std::ptrdiff_t>(count)) continue;
        ++both;
        ASSERT_EQ(std::memcmp(&report, &*same, offsetof(knurl_report, missed)), 0)
            << "cycle " << report.cycle;
    }
    EXPECT_GE(both, 100u);
}

TEST_F(CHand, its_descriptor_is_readable_while_a_report_is_unread) {
    int fd = -1, again = -2;
    ASSERT_TRUE(did(knurl_fd(hand, &fd)));
    ASSERT_TRUE(did(knurl_fd(hand, &again)));
    EXPECT_EQ(fd, again);
    knurl_report report = sized<knurl_report>();
    for (int i = 0; i < 20; ++i) {
        pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
        ASSERT_EQ(::poll(&ready, 1, 20'000), 1);
        int count = 0;
        while (knurl_next_report(hand, 0, &report) == KNURL_OK) ++count;
        EXPECT_GE(count, 1);
    }
    servo->stop();
    while (knurl_next_report(hand, 100 * ms, &report) == KNURL_OK) {
    }
    pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&ready, 1, 0), 0);
    knurl_frame frame = sized<knurl_frame>();
    EXPECT_EQ(knurl_newest(hand, 1 * ms, &frame), KNURL_NOTHING);
    EXPECT_EQ(knurl_newest(hand, -1, &frame), KNURL_NOTHING);
    servo->go_on();
    EXPECT_EQ(::poll(&ready, 1, 20'000), 1);
}

TEST_F(CHand, a_frame_tells_what_happened_since_the_last) {
    knurl_frame frame = sized<knurl_frame>();
    ASSERT_TRUE(did(knurl_newest(hand, 20 * s, &frame)));
    add(KNURL_PLANE, plane(device.workspace_centre.z + 0.001, 300));
    ASSERT_TRUE(did(knurl_arm(hand)));
    std::uint64_t before = frame.report.cycle;
    std::uint32_t touched = 0;
    ASSERT_TRUE(eventually([&] {
        EXPECT_TRUE(did(knurl_newest(hand, 20 * s, &frame)));
        knurl_commit(hand, nullptr);
        EXPECT_EQ(frame.report.cycle, before + frame.skipped + 1) << "it says how many were passed over";
        before = frame.report.cycle;
        touched += frame.touches;
        return frame.touched != 0;
    }));
    EXPECT_GE(touched, 1u);
    EXPECT_EQ(frame.pressed, 0u);
    EXPECT_EQ(frame.released, 0u);
    // A longer frame has a longer report.
    Later<knurl_frame> later;
    later.tail[0] = 7;
    ASSERT_TRUE(did(knurl_newest(hand, 20 * s, &later.known)));
    EXPECT_GE(later.known.report.size, sizeof(knurl_report));
}

}  // namespace
}  // namespace capi_test
