// The bound of a remote update: one cycle + 1.2 x (one way by UDP + one wake-up), from the same run's floors.

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <latency_bound.hpp>

namespace knurl::test {
namespace {

using cli::PathSamples;
using testing::HasSubstr;

constexpr cli::Nanoseconds period = 1'000'000;
const std::vector<double> udp(50, 20'000), wake(50, 50'000);  // ns: with a grace of 1.2 they are 84'000

/// The bound from these samples.
std::optional<cli::RemoteBound> remote_bound(const PathSamples& paths, std::vector<double> ways,
                                             std::vector<double> wakes, cli::Nanoseconds cycle,
                                             std::span<const measure::Gap> gaps) {
    const auto median = [](std::vector<double> samples) {
        return measure::summarise("", "ns", std::move(samples)).p50.value_or(0);
    };
    return cli::remote_bound(paths, ways, wakes, {.udp_one_way = median(ways), .wake = median(wakes)}, cycle,
                             gaps);
}

/// Consecutive updates, each of which is in use after that many ns and written 10 us later.
PathSamples updates(const std::vector<double>& to_use) {
    PathSamples paths;
    cli::Nanoseconds at = 0;
    for (const double took : to_use) {
        paths.to_use.push_back(took);
        paths.to_write.push_back(took + 10'000);
        paths.commits.push_back({.begin = at, .end = at + static_cast<cli::Nanoseconds>(took)});
        at += 10 * period;
    }
    return paths;
}

TEST(RemoteBound, IsOneCycleAndAFifthMoreThanTheMediansOfTheFloors) {
    auto few = udp;
    std::fill_n(few.begin(), 20, 9e9);  // a tail moves no median
    const auto bound = remote_bound(updates(std::vector<double>(30, 5e5)), few, wake, period, {});
    ASSERT_TRUE(bound);
    EXPECT_DOUBLE_EQ(bound->use.limit, 1084);
}

TEST(RemoteBound, CountsWhatWasInUseAndWhatWasWrittenWithin) {
    std::vector<double> took(100, 500'000);
    std::fill_n(took.begin(), 10, 1'084'000);  // just within, and written after it
    std::fill_n(took.begin() + 10, 5, 1'084'001);
    const auto bound = remote_bound(updates(took), udp, wake, period, {});
    ASSERT_TRUE(bound);
    EXPECT_EQ(bound->use.n, 100u);
    EXPECT_EQ(bound->use.within, 95u);
    EXPECT_EQ(bound->write_within, 85u);
    EXPECT_EQ(bound->use.stalled, 0u);
    EXPECT_THAT(cli::to_text(*bound), HasSubstr("95 of 100 (95.00 %) within 1084.0 us"));
}

TEST(RemoteBound, TellsTheMachinesStandstillsFromOurs) {
    std::vector<double> took(100, 500'000);
    took[3] = took[7] = 5e6;
    const cli::Nanoseconds third = 30 * period;  // when it was committed
    const std::vector<measure::Gap> gaps{
        {.begin = third + period, .end = third + 4 * period},
        {.begin = 500 * period, .end = 502 * period}};  // one within the bound
    const auto bound = remote_bound(updates(took), udp, wake, period, gaps);
    ASSERT_TRUE(bound);
    EXPECT_EQ(bound->use.within, 98u);
    EXPECT_EQ(bound->use.stalled, 1u);
}

TEST(RemoteBound, OfTheFloorsOwnSamplesIsWhatADrawnWaitWouldGive) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::exponential_distribution<double> way(1.0 / 200'000);
    std::vector<double> ways(500);
    for (double& each : ways) each = way(random);
    const std::vector<double> none(ways.size(), 0);
    const auto bound = remote_bound(updates(std::vector<double>(20, 0)), ways, none, period, {});
    ASSERT_TRUE(bound);
    std::uniform_real_distribution<double> wait(0, static_cast<double>(period));
    constexpr int draws = 400'000;
    int within = 0;
    for (int i = 0; i < draws; ++i)
        within += ways[random() % ways.size()] + wait(random) <= bound->use.limit * 1e3 ? 1 : 0;
    // 6 sigma and more
    EXPECT_NEAR(bound->use.references_within, static_cast<double>(within) / draws, 0.005);
    EXPECT_LT(bound->use.references_within, 0.95) << "a tail as long as this one's";
}

TEST(RemoteBound, IsNotStatedWithoutItsFloors) {
    EXPECT_FALSE(remote_bound(updates(std::vector<double>(100, 0)), {}, wake, period, {}));
    EXPECT_FALSE(remote_bound(updates({}), udp, wake, period, {}));
}

}  // namespace
}  // namespace knurl::test
