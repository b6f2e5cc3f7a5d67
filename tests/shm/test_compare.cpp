// runtime/measure/compare: wrong verdicts are as rare as promised, and a relevant difference is found.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <knurl/measure/compare.hpp>

namespace knurl::measure {
namespace {

using Random = std::mt19937_64;

/// Blocks of a run on a machine whose speed changes from block to block, like a real one's.
struct Machine {
    double mood = 0.05;  // standard deviation of a block's own factor, in its logarithm
    double tail = 0.5;   // of the samples
    int samples = 40;    // a block
};

Measured run_on(const Machine& machine, double level, std::size_t blocks, Random& random) {
    Measured made;
    for (std::size_t i = 0; i < blocks; ++i) {
        const double mood = std::normal_distribution<double>(0, machine.mood)(random);
        std::lognormal_distribution<double> sample(std::log(level) + mood, machine.tail);
        Histogram& block = made.blocks.emplace_back();
        for (int n = 0; n < machine.samples; ++n) block.record(sample(random));
    }
    return made;
}

/// The share of pairs of runs of which `verdict` is said.
double share(Verdict verdict, double shift, double q, const Machine& machine, double confidence,
             Random& random) {
    constexpr int pairs = 400;
    int said = 0;
    for (int i = 0; i < pairs; ++i) {
        const Measured before = run_on(machine, 30, 40, random),
                       now = run_on(machine, 30 * shift, 50, random);
        const Comparison result =
            compare(before, now, q, {.confidence = confidence, .resamples = 150, .seed = random()});
        EXPECT_TRUE(result.problem.empty()) << result.problem;
        said += result.verdict == verdict ? 1 : 0;
    }
    return static_cast<double>(said) / pairs;
}

TEST(Compare, CallsEqualRunsDifferentAsSeldomAsItPromises) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    Random random(seed);
    for (const double q : {0.5, 0.9}) {
        SCOPED_TRACE(q);
        double wrong = 0;
        for (const Verdict verdict : {Verdict::better, Verdict::worse})
            wrong += share(verdict, 1, q, {.mood = 0.1}, 0.95, random) / 2;
        // The promise is 5 % in both directions together. Five standard deviations of 400 pairs are 2.7 %
        // each way.
        EXPECT_LT(wrong, 0.025 + 0.028);
        EXPECT_GT(wrong, 0.002) << "a verdict that is never given is no test";
    }
}

TEST(Compare, FindsFivePerCent) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    Random random(seed);
    EXPECT_GT(share(Verdict::worse, 1.05, 0.5, {.mood = 0.02, .tail = 0.2}, 0.99, random), 0.95);
    EXPECT_GT(share(Verdict::better, 1 / 1.05, 0.5, {.mood = 0.02, .tail = 0.2}, 0.99, random), 0.95);
}

TEST(Compare, ItsIntervalIsThatOfTheTextbookWhereThereIsOne) {
    // The median of many normal samples a block scatters with the blocks' own factors: then the interval is
    // Welch's for two means.
    Random random(5);
    Measured before, now;
    std::vector<double> logarithms[2];
    for (auto [run, made] : {std::pair(0, &before), {1, &now}})
        for (int i = 0; i < 200; ++i) {
            const double x = std::normal_distribution<double>(0, 0.05)(random);
            logarithms[run].push_back(x);
            Histogram& block = made->blocks.emplace_back();
            // A spread that is even in each block makes the median of them all the mean of theirs.
            for (int n = -500; n <= 500; ++n) block.record(50 * std::exp(x + n * 0.002));
        }
    const Comparison result = compare(before, now, 0.5, {.confidence = 0.95, .resamples = 2000});
    const auto mean = [](const std::vector<double>& v) {
        double sum = 0;
        for (const double x : v) sum += x;
        return sum / static_cast<double>(v.size());
    };
    const auto variance = [&](const std::vector<double>& v) {
        double sum = 0;
        for (const double x : v) sum += (x - mean(v)) * (x - mean(v));
        return sum / static_cast<double>(v.size() - 1);
    };
    const double half = 1.972 * std::sqrt(variance(logarithms[0]) / 200 + variance(logarithms[1]) / 200);
    const double middle = mean(logarithms[1]) - mean(logarithms[0]);
    EXPECT_NEAR(std::log(result.ratio), middle, 0.1 * half);
    EXPECT_NEAR(std::log(result.interval.high / result.interval.low), 2 * half, 0.1 * 2 * half);
}

TEST(Compare, WhatTheMachineDoesToTheReferenceTooIsNoDifference) {
    Random random(11);
    const auto beside = [&](double machine, double ours) {
        Measured made = run_on({}, 30 * machine * ours, 64, random);
        made.reference = run_on({}, 20 * machine, 64, random).blocks;
        return made;
    };
    const Measured before = beside(1, 1), slower_machine = beside(1.5, 1), slower_program = beside(1.5, 1.3);
    EXPECT_EQ(compare(before, slower_machine, 0.5).verdict, Verdict::undecided);
    EXPECT_EQ(compare(before, slower_program, 0.5).verdict, Verdict::worse);
    EXPECT_NEAR(compare(before, slower_program, 0.5).ratio, 1.3, 0.1);
    EXPECT_EQ(compare(slower_program, before, 0.5).verdict, Verdict::better);
}

TEST(Compare, RefusesWhatIsTooFewAndSaysHowManyItNeeds) {
    Random random(3);
    const Measured fine = run_on({}, 30, 40, random), few = run_on({}, 30, 29, random);
    EXPECT_EQ(compare(few, fine, 0.5).problem, "the old run has 29 blocks, 30 are needed");
    EXPECT_EQ(compare(fine, few, 0.5).problem, "the new run has 29 blocks, 30 are needed");
    EXPECT_EQ(compare(fine, fine, 0.999).problem, "the old run has 1600 samples, 10000 are needed");
    EXPECT_EQ(compare(fine, fine, 0.999).verdict, Verdict::undecided);
    EXPECT_EQ(compare(fine, {}, 0.5).problem, "the new run has 0 blocks, 30 are needed");
}

TEST(Compare, WhatIsAlwaysTheSameIsTheSame) {
    Measured zeros;
    for (int i = 0; i < 40; ++i) zeros.blocks.emplace_back().record(0, 20);
    const Comparison result = compare(zeros, zeros, 0.5);
    EXPECT_EQ(result.verdict, Verdict::undecided);
    EXPECT_EQ(result.ratio, 1);
    EXPECT_EQ(result.interval.low, 1);
}

}  // namespace
}  // namespace knurl::measure
