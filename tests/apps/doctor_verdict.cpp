// The verdict for a loop's lateness, with invented loops.

#include <doctor_verdict.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace knurl::test {
namespace {

using cli::Beginnings;
using cli::Fitness;
using cli::Gap;
using cli::Nanoseconds;
using testing::HasSubstr;

constexpr Nanoseconds us = 1000, ms = 1'000'000;

/// The first `late` of `cycles` begin `how_late` after their deadline, the others 30 us.
Beginnings loop(double rate, std::size_t cycles, std::size_t late = 0, Nanoseconds how_late = 0) {
    Beginnings made;
    for (std::size_t i = 0; i < cycles; ++i) {
        made.deadline.push_back(static_cast<Nanoseconds>(static_cast<double>(i + 1) * 1e9 / rate));
        made.late.push_back(i < late ? how_late : 30 * us);
    }
    return made;
}

/// Late beginnings at regular intervals.
Beginnings scattered(std::size_t cycles, std::size_t late) {
    Beginnings made = loop(1000, cycles);
    for (std::size_t i = 0; i < late; ++i) made.late[i * cycles / late] = 800 * us;
    return made;
}

TEST(DoctorVerdict, SaysHowMuchLaterTheServoIsThanTheBareLoop) {
    Beginnings servo = loop(1000, 9000), bare = servo;
    for (std::size_t i = 0; i < 9000; ++i) {
        bare.late[i] = 30 * us + static_cast<Nanoseconds>(i * 7919 % 1000) * 10;
        servo.late[i] = bare.late[i] * 12 / 10;
    }
    const auto verdict = cli::judge(1000, cli::figures(servo, {}, 1000), cli::figures(bare, {}, 1000), true);
    ASSERT_TRUE(verdict.lateness.problem.empty()) << verdict.lateness.problem;
    EXPECT_NEAR(verdict.lateness.ratio, 1.2, 0.01);
    EXPECT_EQ(verdict.lateness.verdict, measure::Verdict::worse);
    EXPECT_LT(verdict.lateness.interval.high, 1.25);
    const auto alike = cli::judge(1000, cli::figures(bare, {}, 1000), cli::figures(bare, {}, 1000), true);
    EXPECT_EQ(alike.lateness.verdict, measure::Verdict::undecided);
    EXPECT_FALSE(cli::judge(1000, cli::figures(loop(1000, 40), {}, 1000), {}, true).lateness.problem.empty());
}

TEST(DoctorVerdict, OnTimeIsWithinHalfOfAPeriod) {
    EXPECT_EQ(cli::figures(loop(1000, 10'000, 100, 499 * us), {}, 1000).on_time, 1);
    EXPECT_NEAR(cli::figures(loop(1000, 10'000, 100, 500 * us), {}, 1000).on_time, 0.99, 1e-12);
    EXPECT_NEAR(cli::figures(loop(4000, 10'000, 100, 130 * us), {}, 4000).on_time, 0.99, 1e-12);
}

TEST(DoctorVerdict, APercentileHasTenCyclesAboveIt) {
    const auto few = cli::figures(loop(1000, 999, 5, 700 * us), {}, 1000);
    EXPECT_EQ(few.p50, 30);
    EXPECT_FALSE(few.p99);
    EXPECT_EQ(few.max, 700);
    const auto more = cli::figures(loop(1000, 10'000, 11, 700 * us), {}, 1000);
    EXPECT_EQ(more.p99, 30);
    EXPECT_EQ(more.p999, 700);
}

TEST(DoctorVerdict, GoodUsableUnfit) {
    const auto fine = cli::figures(loop(1000, 10'000), {}, 1000);
    const auto judged = [&](std::size_t late, bool real_time = true) {
        return cli::judge(1000, cli::figures(loop(1000, 10'000, late, 800 * us), {}, 1000), fine, real_time)
            .fitness;
    };
    EXPECT_EQ(judged(10), Fitness::good);
    EXPECT_EQ(judged(11), Fitness::usable);
    EXPECT_EQ(judged(100), Fitness::usable);
    EXPECT_EQ(judged(101), Fitness::unfit);
    EXPECT_EQ(judged(0, false), Fitness::usable) << "without real-time priority nothing is promised";
}

TEST(DoctorVerdict, TheBareLoopTellsTheMachineFromTheServo) {
    const auto fine = cli::figures(loop(1000, 10'000), {}, 1000),
               late = cli::figures(loop(1000, 10'000, 300, 800 * us), {}, 1000);
    EXPECT_THAT(cli::judge(1000, late, late, true).reason, HasSubstr("it is the machine"));
    EXPECT_THAT(cli::judge(1000, cli::figures(scattered(10'000, 90), {}, 1000), fine, true).reason,
                HasSubstr("it is the servo"));
    EXPECT_THAT(cli::judge(1000, cli::figures(loop(1000, 10'000, 90, 800 * us), {}, 1000), fine, true).reason,
                HasSubstr("too few"))
        << "one burst of ninety may be one event, and chance";
    const auto few = cli::figures(loop(1000, 4000, 6, 800 * us), {}, 1000);
    EXPECT_THAT(cli::judge(1000, few, cli::figures(loop(1000, 4000, 1, 800 * us), {}, 1000), true).reason,
                HasSubstr("too few"));
    EXPECT_THAT(cli::judge(1000, fine, late, true).reason, testing::Not(HasSubstr("it is")));
}

TEST(DoctorVerdict, AStandstillThatTheWitnessSawIsNotTheLoops) {
    // Cycle 100 (deadline 100 ms) begins 8 ms late.
    Beginnings seen = loop(1000, 1000);
    seen.late[99] = 8 * ms;
    const std::vector<Gap> both{{.begin = 100 * ms, .end = 107 * ms}};
    EXPECT_EQ(cli::figures(seen, both, 1000).stalls.count, 1u);
    EXPECT_EQ(cli::figures(seen, both, 1000).stalls.longest, 8 * ms);
    EXPECT_EQ(cli::figures(seen, both, 1000).on_time, 1);
    const std::vector<Gap> another_time{{.begin = 300 * ms, .end = 307 * ms}};
    EXPECT_EQ(cli::figures(seen, another_time, 1000).stalls.count, 0u);
    EXPECT_EQ(cli::figures(seen, another_time, 1000).max, 8000);
}

TEST(DoctorVerdict, CyclesLateInOneStandstillAreOneStandstill) {
    Beginnings seen = loop(4000, 4000);
    for (std::size_t i = 400; i < 420; ++i)
        seen.late[i] = 6 * ms - static_cast<Nanoseconds>(i - 400) * 250 * us;
    const std::vector<Gap> gaps{{.begin = seen.deadline[400], .end = seen.deadline[400] + 6 * ms}};
    const auto figures = cli::figures(seen, gaps, 4000);
    EXPECT_EQ(figures.stalls.count, 1u);
    EXPECT_EQ(figures.max, 30);
}

TEST(DoctorVerdict, AMachineThatStandsStillLongerThanAServoHoldsOnIsUsableAtBest) {
    Beginnings seen = loop(1000, 10'000);
    seen.late[99] = 25 * ms;
    const std::vector<Gap> gaps{{.begin = 100 * ms, .end = 125 * ms}};
    const auto figures = cli::figures(seen, gaps, 1000);
    const auto verdict = cli::judge(1000, figures, figures, true);
    EXPECT_EQ(verdict.fitness, Fitness::usable);
    EXPECT_THAT(verdict.reason, HasSubstr("stood still for 25 ms"));
}

TEST(DoctorVerdict, NoCycleIsNoVerdict) {
    EXPECT_EQ(
        cli::judge(1000, cli::figures({}, {}, 1000), cli::figures(loop(1000, 100), {}, 1000), true).fitness,
        Fitness::unfit);
}

}  // namespace
}  // namespace knurl::test
