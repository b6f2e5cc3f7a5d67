// When cycles begin, and what counts as a stall for the guardian.

#include <random>

#include <gtest/gtest.h>

#include <knurl/servo/guardian.hpp>
#include <knurl/servo/loop.hpp>

namespace knurl::servo {
namespace {

constexpr Nanoseconds ms = 1'000'000;

TEST(Deadlines, FollowTheRateForAnHourWithoutDrift) {
    for (double rate : {500.0, 1000.0, 3000.0, 19'999.0}) {
        Deadlines deadlines(rate, 20 * ms);
        deadlines.start(12345);
        const auto cycles = static_cast<std::uint64_t>(rate * 3600);
        for (std::uint64_t i = 0; i < cycles; ++i) deadlines.advance(deadlines.current());
        const long double exact =
            12345 + 1e9L * static_cast<long double>(cycles) / static_cast<long double>(rate);
        EXPECT_NEAR(static_cast<double>(static_cast<long double>(deadlines.current()) - exact), 0, 2) << rate;
        EXPECT_EQ(deadlines.ended_late(), 0u);
    }
}

TEST(Deadlines, AreNotRebasedAfterACycleThatEndedLate) {
    Deadlines deadlines(1000, 20 * ms);
    deadlines.start(0);
    deadlines.advance(15 * ms);  // the first cycle took 15 ms
    int caught_up = 0;
    while (deadlines.current() < 15 * ms) {
        EXPECT_EQ(deadlines.current() % ms, 0);
        deadlines.advance(15 * ms);
        ++caught_up;
    }
    EXPECT_EQ(caught_up, 14);  // none is left out
    EXPECT_EQ(deadlines.current(), 15 * ms);
    EXPECT_EQ(deadlines.ended_late(), 14u);
    EXPECT_EQ(deadlines.restarts(), 0u);
}

TEST(Deadlines, BeginAnewAfterAStallAndSleepFirst) {
    Deadlines deadlines(1000, 20 * ms);
    deadlines.start(0);
    deadlines.advance(500 * ms);
    EXPECT_EQ(deadlines.restarts(), 1u);
    EXPECT_EQ(deadlines.current(), 501 * ms);
}

TEST(Deadlines, ALoopThatNeverKeepsUpStillSleeps) {
    Deadlines deadlines(1000, 20 * ms);
    Nanoseconds now = 0;
    Nanoseconds slept = 0;
    deadlines.start(now);
    for (int i = 0; i < 10'000; ++i) {
        if (deadlines.current() > now) {
            slept += deadlines.current() - now;
            now = deadlines.current();
        }
        now += 3 * ms;  // three times too long
        deadlines.advance(now);
    }
    EXPECT_GT(slept, now / 100);
}

TEST(StallWatch, ActsOnceWhenTheBeatStandsStill) {
    StallWatch watch(20 * ms);
    Nanoseconds now = 1000 * ms;
    for (std::uint64_t beat = 0; beat < 100; ++beat) EXPECT_FALSE(watch.tick(now += ms, beat, true));
    int acted_after = 0;
    while (!watch.tick(now += ms, 99, true)) ++acted_after;
    EXPECT_NEAR(acted_after, 20, 1);
    for (int i = 0; i < 1000; ++i) EXPECT_FALSE(watch.tick(now += ms, 99, true));
    EXPECT_FALSE(watch.tick(now += ms, 100, true));  // it continues: the next stall counts again
    acted_after = 0;
    while (!watch.tick(now += ms, 100, true)) ++acted_after;
    EXPECT_NEAR(acted_after, 20, 1);
}

TEST(StallWatch, DoesNotWaitForAServoThatIsStopped) {
    StallWatch watch(20 * ms);
    Nanoseconds now = 1000 * ms;
    EXPECT_FALSE(watch.tick(now += ms, 7, true));
    EXPECT_FALSE(watch.tick(now += ms, 7, true, true)) << "it may have been about to write";
    EXPECT_TRUE(watch.tick(now += ms, 7, true, true));
    for (int i = 0; i < 1000; ++i) EXPECT_FALSE(watch.tick(now += ms, 7, true, true));
    for (std::uint64_t beat = 8; beat < 100; ++beat)
        EXPECT_FALSE(watch.tick(now += ms, beat, true, beat % 2 == 0));
    EXPECT_FALSE(watch.tick(now += ms, 99, false, true)) << "where no force is on there is nothing to zero";
}

TEST(StallWatch, DoesNotBlameTheServoForAHostThatStopsBoth) {
    StallWatch watch(20 * ms);
    Nanoseconds now = 1000 * ms;
    std::mt19937 random(1);
    for (std::uint64_t beat = 0; beat < 1000; ++beat) {
        now += std::uniform_int_distribution<Nanoseconds>(1, 500)(random) *
               ms;  // the guardian, too, did not run
        EXPECT_FALSE(watch.tick(now, beat / 2, true));
    }
}

TEST(GuardianWatch, SaysSoAsLongAsTheGuardianStandsStill) {
    GuardianWatch watch(40 * ms);
    Nanoseconds now = 1000 * ms;
    for (std::uint64_t cycle = 0; cycle < 1000; ++cycle) EXPECT_FALSE(watch.still(now += ms, cycle / 20));
    int still_after = 0;
    while (!watch.still(now += ms, 50)) ++still_after;
    EXPECT_NEAR(still_after, 40, 1);
    for (int i = 0; i < 1000; ++i) EXPECT_TRUE(watch.still(now += ms, 50));
    EXPECT_FALSE(watch.still(now += ms, 51));
}

TEST(GuardianWatch, DoesNotBlameTheGuardianForAHostThatStopsBoth) {
    GuardianWatch watch(40 * ms);
    Nanoseconds now = 1000 * ms;
    std::mt19937 random(1);
    for (std::uint64_t cycle = 0; cycle < 1000; ++cycle) {
        now += std::uniform_int_distribution<Nanoseconds>(1, 500)(random) * ms;
        EXPECT_FALSE(watch.still(now, cycle / 18));
    }
}

TEST(StallWatch, LeavesADeviceAloneThatIsNotEnabled) {
    StallWatch watch(20 * ms);
    Nanoseconds now = 0;
    for (int i = 0; i < 1000; ++i) EXPECT_FALSE(watch.tick(now += ms, 5, false));
}

}  // namespace
}  // namespace knurl::servo
