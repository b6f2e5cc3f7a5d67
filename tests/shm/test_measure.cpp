// runtime/measure: a figure never claims more than its samples show.

#include <algorithm>
#include <chrono>
#include <numeric>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>

namespace knurl::measure {
namespace {

std::vector<double> one_to(int n) {
    std::vector<double> samples(static_cast<std::size_t>(n));
    std::iota(samples.begin(), samples.end(), 1.0);
    std::shuffle(samples.begin(), samples.end(), std::mt19937(7));
    return samples;
}

TEST(Summary, GivesNearestRankPercentilesOfSamplesInAnyOrder) {
    const Result result = summarise("x", "ns", one_to(10000));
    EXPECT_EQ(result.n, 10000u);
    EXPECT_EQ(result.p50, 5000);
    EXPECT_EQ(result.p99, 9900);
    EXPECT_EQ(result.p999, 9990);
    EXPECT_EQ(result.max, 10000);
}

TEST(Summary, LeavesOutAPercentileWithFewerThanTenSamplesAboveIt) {
    EXPECT_TRUE(summarise("x", "ns", one_to(1000)).p99);
    EXPECT_FALSE(summarise("x", "ns", one_to(999)).p99);
    EXPECT_FALSE(summarise("x", "ns", one_to(9999)).p999);
    EXPECT_TRUE(summarise("x", "ns", one_to(20)).p50);
    EXPECT_FALSE(summarise("x", "ns", one_to(19)).p50);
    EXPECT_EQ(summarise("x", "ns", {}).n, 0u);
}

TEST(Ratio, IsThatOfTheMediansAndMissingWhereOneIs) {
    const Result reference = summarise("reference", "ns", one_to(100));
    std::vector<double> doubled = one_to(100);
    for (double& sample : doubled) sample *= 2;
    Result result = summarise("x", "ns", doubled);
    relate(result, reference);
    EXPECT_EQ(result.reference, "reference");
    EXPECT_DOUBLE_EQ(result.ratio.value(), 2.0);
    Result few = summarise("few", "ns", one_to(5));
    relate(few, reference);
    EXPECT_FALSE(few.ratio);
}

TEST(Json, IsReadAsItWasWritten) {
    Blocks blocks;
    for (int i = 0; i < 50; ++i) blocks.add({0, 0.25 + i, 1e3 + i}, 1.1);
    measure::Run run{.machine = this_machine(), .results = {summarise_blocks("a", "us", blocks)}};
    run.results.push_back(summarise("beside \"line 0\"", "us", one_to(30)));
    relate(run.results[0], run.results[1]);
    const measure::Run copy = from_json(to_json(run));
    ASSERT_EQ(copy.results.size(), 2u);
    EXPECT_EQ(copy.machine.kernel, run.machine.kernel);
    EXPECT_EQ(copy.results[0].p50, run.results[0].p50);
    EXPECT_EQ(copy.results[0].p99, std::nullopt);
    EXPECT_EQ(copy.results[0].reference, run.results[1].name);
    EXPECT_EQ(copy.results[0].ratio, run.results[0].ratio);
    ASSERT_EQ(copy.results[0].blocks.size(), 50u);
    for (std::size_t i = 0; i < 50; ++i)
        EXPECT_EQ(copy.results[0].blocks[i].buckets(), run.results[0].blocks[i].buckets());
    EXPECT_TRUE(copy.results[1].blocks.empty());
    const std::string text = to_json(run);
    EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 60) << "blocks are a line each";
    for (const char* foreign : {"", "{}", "[]", R"({"machine": 3})"})
        EXPECT_THROW(from_json(foreign), std::runtime_error);
}

TEST(Json, HasTheMachineAndNullsForWhatIsMissing) {
    const measure::Run run{.machine = this_machine(), .results = {summarise("a \"name\"", "us", one_to(30))}};
    const auto json = knurl::Json::parse(to_json(run));
    for (const char* key : {"processor", "cpus", "kernel", "load", "idle", "build", "date"})
        EXPECT_TRUE(json.at("machine").contains(key)) << key;
    const auto& result = json.at("results").at(0);
    EXPECT_EQ(result.at("name"), "a \"name\"");
    EXPECT_EQ(result.at("n"), 30);
    EXPECT_EQ(result.at("p50"), 15.0);
    for (const char* key : {"p99", "p999", "reference", "ratio"})
        EXPECT_TRUE(result.at(key).is_null()) << key;
}

TEST(Table, NamesTheMachineAndEachResult) {
    std::ostringstream out;
    print(out, measure::Run{.machine = this_machine(), .results = {summarise("publish", "ns", one_to(30))}});
    EXPECT_NE(out.str().find(this_machine().kernel), std::string::npos);
    EXPECT_NE(out.str().find("publish"), std::string::npos);
}

TEST(Stopwatch, AgreesWithTheSystemsClockWithinAFewPercent) {
    const Stopwatch watch;
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t begin = Stopwatch::begin();
    while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(5)) {
    }
    EXPECT_GT(watch.nanoseconds(begin, Stopwatch::end()), 4.5e6);
    EXPECT_GT(watch.empty_interval(), 0);
}

}  // namespace
}  // namespace knurl::measure
