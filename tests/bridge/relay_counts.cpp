// Datagrams of the data channel: which is a copy, which report is late or lost, what is forged, and how long
// a datagram may be. No sockets; KNURL_SEED repeats a run.

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "counter_window.hpp"
#include "datagram_channel.hpp"
#include "path_mtu.hpp"
#include "report_tally.hpp"
#include "seed.hpp"

namespace knurl::bridge {
namespace {

TEST(Counts, a_counter_is_accepted_once_and_never_when_it_is_old) {
    const std::uint32_t seed = test::seed();
    SCOPED_TRACE(test::text_of_seed(seed));
    std::mt19937 random(seed);
    CounterWindow window;
    std::vector<bool> accepted(200'000);
    std::uint64_t newest = 0;
    EXPECT_NE(window.look(0), CounterWindow::Seen::never);
    for (int i = 0; i < 20'000; ++i) {
        const std::uint64_t ahead = random() % 300 == 0 ? random() % 3000 : random() % 4;
        const std::uint64_t counter = 1 + std::min<std::uint64_t>(199'998, newest + ahead) -
                                      std::min<std::uint64_t>(newest, random() % 1100);
        const bool expected = !accepted[counter] && counter + CounterWindow::width > newest;
        ASSERT_EQ(window.look(counter) == CounterWindow::Seen::never, expected)
            << counter << " after " << newest;
        if (!expected) continue;
        window.accept(counter);
        accepted[counter] = true;
        newest = std::max(newest, counter);
    }
}

TEST(Counts, each_report_is_the_newest_or_late_or_lost_and_each_copy_is_a_copy) {
    const std::uint32_t seed = test::seed();
    SCOPED_TRACE(test::text_of_seed(seed));
    std::mt19937 random(seed);
    for (const std::uint64_t others : {0u, 1u, 20u}) {  // datagrams of other streams after each of this one
        constexpr std::uint64_t reports = 20'000, begin = 7;
        struct Flying {
            std::uint64_t due, counter, number;
        };
        std::vector<Flying> air;
        for (std::uint64_t n = 0; n < reports; ++n)
            for (std::uint64_t copies = random() % 10 < 3   ? 0
                                        : random() % 10 < 3 ? 2
                                                            : 1;
                 copies > 0; --copies)
                air.push_back(
                    {.due = n + random() % 400, .counter = 1 + n * (1 + others), .number = begin + n});
        std::ranges::stable_sort(air, {}, &Flying::due);

        CounterWindow counters;
        ReportTally tally;
        std::vector<bool> came(begin + reports);
        std::uint64_t first = 0, newest = 0, late = 0, distinct = 0, copies = 0, known_copies = 0;
        for (const Flying& one : air) {
            if (first == 0) first = one.number;
            if (came[one.number]) {
                ++copies;
            } else if (one.number >= first) {
                late += one.number < newest;
                ++distinct;
            }
            came[one.number] = true;
            newest = std::max(newest, one.number);
            switch (counters.look(one.counter)) {
                case CounterWindow::Seen::never:
                    counters.accept(one.counter);
                    tally.take(one.number);
                    break;
                case CounterWindow::Seen::already:
                    ++known_copies;
                    break;
                case CounterWindow::Seen::too_old:
                    tally.take_old(one.number);
                    break;
            }
        }
        EXPECT_EQ(tally.newest(), newest);
        EXPECT_EQ(tally.late(), late);
        EXPECT_EQ(tally.lost(), newest - first + 1 - distinct);
        EXPECT_EQ(known_copies + tally.copies(), copies) << others;
        if (others == 20) {
            EXPECT_GT(tally.copies(), 0u) << "where the counters alone do not tell";
        }
    }
}

TEST(Counts, the_newest_report_sent_again_is_neither_late_nor_a_copy) {
    ReportTally tally;
    EXPECT_TRUE(tally.take(5));
    EXPECT_FALSE(tally.take(5)) << "the newest, for one that had none";
    EXPECT_FALSE(tally.take(4)) << "before the first";
    EXPECT_EQ(tally.late() + tally.lost() + tally.copies(), 0u);
    EXPECT_TRUE(tally.take(7));
    EXPECT_EQ(tally.lost(), 1u);
    EXPECT_FALSE(tally.take(6));
    EXPECT_FALSE(tally.take(6));
    EXPECT_EQ(tally.lost(), 0u);
    EXPECT_EQ(tally.late(), 1u);
}

TEST(Counts, what_is_forged_counts_as_foreign_whatever_its_counter) {
    const std::array<std::byte, key_bytes> key{};
    OutgoingDatagrams outgoing(1, &key);
    IncomingDatagrams incoming(1, &key);
    std::array<CounterWindow, max_streams + 1> windows{};
    const auto datagram = [&] {
        std::vector<std::byte> room(64 + tag_bytes);
        write(room, DatagramHeader{.kind = DatagramKind::report, .stream = 1});
        EXPECT_EQ(outgoing.close(room, 64), room.size());
        return room;
    };
    const std::vector<std::byte> first = datagram();
    for (std::uint64_t i = 0; i <= CounterWindow::width; ++i) {
        std::vector<std::byte> sent = i == 0 ? first : datagram();
        const std::vector<std::byte> copy = sent;
        EXPECT_EQ(incoming.open(sent, windows).verdict, IncomingDatagrams::Verdict::good);
        sent = copy;
        EXPECT_EQ(incoming.open(sent, windows).verdict, IncomingDatagrams::Verdict::already);
        sent = copy;
        sent.back() ^= std::byte{1};
        EXPECT_EQ(incoming.open(sent, windows).verdict, IncomingDatagrams::Verdict::foreign)
            << "of one that has come";
    }
    std::vector<std::byte> old = first;
    EXPECT_EQ(incoming.open(old, windows).verdict, IncomingDatagrams::Verdict::too_old);
    old = first;
    old.back() ^= std::byte{1};
    EXPECT_EQ(incoming.open(old, windows).verdict, IncomingDatagrams::Verdict::foreign) << "of long ago";
}

TEST(Counts, a_path_is_as_wide_as_what_comes_through) {
    PathMtu mtu;
    EXPECT_EQ(mtu.bytes(), least_datagram_bytes);
    mtu.came_through(datagram_bytes - 1);
    EXPECT_EQ(mtu.bytes(), least_datagram_bytes);
    mtu.came_through(std::numeric_limits<std::uint64_t>::max());  // a peer that lies
    EXPECT_EQ(mtu.bytes(), datagram_bytes);
    mtu.refused();
    EXPECT_EQ(mtu.bytes(), least_datagram_bytes);
    mtu.came_through(datagram_bytes);  // a report from before the refusal
    EXPECT_EQ(mtu.bytes(), least_datagram_bytes);
    mtu.came_through(least_datagram_bytes);  // the first report from after the refusal
    EXPECT_EQ(mtu.bytes(), least_datagram_bytes);
    mtu.came_through(datagram_bytes);
    EXPECT_EQ(mtu.bytes(), datagram_bytes);
    mtu.came_through(least_datagram_bytes);  // since then long datagrams are silently dropped
    EXPECT_EQ(mtu.bytes(), least_datagram_bytes);
}

TEST(Counts, what_came_through_is_forgotten_when_nothing_of_that_length_comes_for_four_seconds) {
    constexpr std::int64_t second = 1'000'000'000, begin = 12'345 * second;
    LongestLately longest;
    EXPECT_EQ(longest.bytes(begin), 0U);
    longest.came(1200, begin);
    for (std::int64_t t = 0; t <= 10 * second; t += second / 10) {
        longest.came(100, begin + t);
        const std::uint64_t bytes = longest.bytes(begin + t);
        EXPECT_TRUE(t > 2 * second || bytes == 1200) << t << " " << bytes;
        EXPECT_TRUE(t < 4 * second || bytes == 100) << t << " " << bytes;
    }
    EXPECT_EQ(longest.bytes(begin + 20 * second), 0U) << "silence";
    longest.came(1200, begin + 21 * second);
    longest.came(760, begin + 20 * second);  // with an older time, which another thread has read
    EXPECT_EQ(longest.bytes(begin + 21 * second), 1200U);
}

}  // namespace
}  // namespace knurl::bridge
