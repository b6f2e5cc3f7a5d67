// runtime/measure: an empty loop keeps a servo's time; a witness sees only what it may, and what several see at
// once counts once.

#include <algorithm>
#include <thread>

#include <gtest/gtest.h>

#include <knurl/measure/measure.hpp>
#include <knurl/measure/sleeper.hpp>

#include "../rights.hpp"

namespace knurl::measure {
namespace {

constexpr Nanoseconds us = 1000, ms = 1'000'000;

Beginnings run(Nanoseconds first, Nanoseconds period, Nanoseconds length) {
    return bare_loop({.cpu = allowed_cpus().back(), .first = first, .period = period, .length = length});
}

TEST(BareLoop, BeginsOnTheGridOfItsDeadlinesAndNeverEarly) {
    const Nanoseconds first = now_ns() + 3 * ms, period = 700 * us;
    const Beginnings seen = run(first, period, 20 * ms);
    ASSERT_FALSE(seen.deadline.empty());
    ASSERT_EQ(seen.deadline.size(), seen.late.size());
    EXPECT_GE(seen.deadline.front(), first);
    EXPECT_LT(seen.deadline.back(), first + 20 * ms);
    for (std::size_t i = 0; i < seen.late.size(); ++i) {
        EXPECT_EQ((seen.deadline[i] - first) % period, 0) << i;
        EXPECT_GE(seen.late[i], 0) << i;
    }
}

TEST(BareLoop, CountsNoCycleThatWasDueBeforeItsThreadHadStarted) {
    const Nanoseconds asked = now_ns(), second = 1000 * ms;
    const Beginnings seen = run(asked - second, ms, second + 20 * ms);
    ASSERT_FALSE(seen.deadline.empty());
    EXPECT_GT(seen.deadline.front(), asked);
}

TEST(BareLoop, DoesNotMakeUpForWhatItMissed) {
    const Nanoseconds period = 2 * us;  // quicker than any sleep
    const Beginnings seen = run(now_ns(), period, 50 * ms);
    ASSERT_GT(seen.deadline.size(), 1u);
    EXPECT_LT(seen.deadline.size(), 50 * ms / period);
    for (std::size_t i = 1; i < seen.deadline.size(); ++i)
        EXPECT_GT(seen.deadline[i], seen.deadline[i - 1] + seen.late[i - 1]) << i;
}

TEST(Witness, GivesEachGapOnceAndOnlyLongOnes) {
    Witness witness(allowed_cpus(), 1);
    EXPECT_LE(witness.watching(), allowed_cpus().size());
    sleep_until(now_ns() + 20 * ms);
    Nanoseconds known = 0;
    for (int call = 0; call < 2; ++call) {
        for (const Gap& gap : witness.gaps()) {
            EXPECT_GE(gap.end - gap.begin, Witness::long_gap);
            EXPECT_GT(gap.end, known) << "it was told before";
        }
        known = now_ns();
    }
}

TEST(Witness, SeesThatItsCpuWasTakenFromIt) {
    KNURL_NEEDS(test::missing_real_time(2));
    const unsigned cpu = allowed_cpus().back();
    Witness witness({cpu}, 1);
    ASSERT_EQ(witness.watching(), 1u);
    witness.gaps();
    Nanoseconds begin = 0, end = 0;
    std::thread([&] {  // above it, and never asleep
        ASSERT_TRUE(settle_on(cpu, 2));
        begin = now_ns();
        while ((end = now_ns()) < begin + 20 * ms) {
        }
    })
        .join();
    Nanoseconds longest = 0;
    const Nanoseconds patience = end + 5000 * ms;  // until it has had its turn
    for (; longest < 15 * ms && now_ns() < patience; sleep_until(now_ns() + ms))
        for (const Gap& gap : witness.gaps())
            longest = std::max(longest, std::min(gap.end, end) - std::max(gap.begin, begin));
    EXPECT_GE(longest, 15 * ms) << "of the 20 ms in which it could not run";
    for (const Gap& gap : witness.gaps()) EXPECT_GT(gap.end, end) << "the same is not told twice";
}

TEST(Witness, IsNoneOnACpuThatItMayNotHave) {
    constexpr unsigned nowhere = 1023;
    Witness witness({nowhere}, 1);
    EXPECT_EQ(witness.watching(), 0u);
}

TEST(StoodStill, CountsOnceWhatTheGapsOfSeveralCPUsShare) {
    EXPECT_EQ(stood_still({}), 0);
    EXPECT_EQ(stood_still({{10 * ms, 13 * ms}}), 3 * ms);
    // One within another, one that goes on from it, one by itself; in any order.
    EXPECT_EQ(stood_still({{30 * ms, 31 * ms}, {12 * ms, 14 * ms}, {15 * ms, 18 * ms}, {10 * ms, 16 * ms}}),
              9 * ms);
}

TEST(StoodStill, OfTheWorstWindowAlone) {
    constexpr Nanoseconds window = 60 * ms;
    EXPECT_EQ(stood_still({{10 * ms, 110 * ms}}, window), window) << "no more than all of it";
    // 8 + 8 + 4 ms: the third is cut off where the window ends. Each of the others by itself is less.
    EXPECT_EQ(stood_still({{0, 15 * ms},
                           {100 * ms, 108 * ms},
                           {130 * ms, 138 * ms},
                           {156 * ms, 162 * ms},
                           {300 * ms, 315 * ms}},
                          window),
              20 * ms);
    EXPECT_EQ(stood_still({{0, 15 * ms}, {60 * ms, 75 * ms}}, window), 15 * ms) << "the second is outside";
}

}  // namespace
}  // namespace knurl::measure
