// runtime/measure/histogram: a histogram's answers equal those of all samples, within its resolution.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <knurl/measure/histogram.hpp>

namespace knurl::measure {
namespace {

/// n samples distributed exactly, by the inverse of the cumulative function.
template <class Inverse>
Histogram spread(const Inverse& inverse, int n) {
    Histogram made;
    for (int i = 0; i < n; ++i) made.record(inverse((i + 0.5) / n));
    return made;
}

void expect_near(const std::optional<double>& is, double should_be) {
    ASSERT_TRUE(is);
    EXPECT_NEAR(*is, should_be, Histogram::resolution * should_be);
}

TEST(Histogram, GivesThePercentilesOfKnownDistributions) {
    const auto exponential = [](double p) { return -40 * std::log1p(-p); };
    const auto pareto = [](double p) { return 3 * std::pow(1 - p, -1 / 1.5); };
    const auto uniform = [](double p) { return 1e6 * p; };
    const Histogram a = spread(exponential, 100'000), b = spread(pareto, 100'000),
                    c = spread(uniform, 100'000);
    for (const double q : {0.01, 0.5, 0.9, 0.99, 0.999}) {
        SCOPED_TRACE(q);
        expect_near(a.percentile(q), exponential(q));
        expect_near(b.percentile(q), pareto(q));
        expect_near(c.percentile(q), uniform(q));
    }
}

TEST(Histogram, IsAsGoodAsSortingWhateverTheSamples) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    for (int round = 0; round < 200; ++round) {
        std::lognormal_distribution<double> any(std::uniform_real_distribution<double>(-5, 20)(random),
                                                std::uniform_real_distribution<double>(0.001, 2)(random));
        std::vector<double> samples(20 + random() % 2000);
        Histogram all, first, second;
        for (double& sample : samples) {
            sample = any(random);
            all.record(sample);
            (random() % 2 == 0 ? first : second).record(sample);
        }
        std::sort(samples.begin(), samples.end());
        first.merge(second);
        EXPECT_EQ(first.buckets(), all.buckets());
        EXPECT_EQ(first.count(), samples.size());
        EXPECT_EQ(first.max(), samples.back());
        const double q = std::uniform_real_distribution<double>(0.001, 0.999)(random);
        const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(samples.size())));
        const auto is = all.percentile(q);
        ASSERT_EQ(is.has_value(), samples.size() - rank >= least_above);
        ASSERT_EQ(is, first.percentile(q));
        // Each bucket is a 128th of what is in it wide, or the one of all that is less than a thousandth.
        if (!is) continue;
        EXPECT_NEAR(*is, samples[rank - 1], std::max(0x1p-10, Histogram::resolution * samples[rank - 1]));
    }
}

TEST(Histogram, EachValueLiesInItsBucketAndTheNextBeginsWhereItEnds) {
    double lower = 0;
    for (int i = 0; i < 50 * 128; ++i) {
        const double upper = Histogram::upper_edge(lower);
        ASSERT_GT(upper, lower);
        EXPECT_EQ(Histogram::lower_edge(lower), lower);
        EXPECT_EQ(Histogram::lower_edge(std::nextafter(upper, 0)), lower);
        EXPECT_EQ(Histogram::lower_edge(upper), upper);
        EXPECT_LE(upper - lower, std::max(0x1p-10, lower * Histogram::resolution));
        lower = upper;
    }
    EXPECT_EQ(lower, 0x1p40 * (1 - Histogram::resolution / 2)) << "50 octaves of 128 buckets, less one";
}

TEST(Histogram, KeepsToItsMemoryWhateverComes) {
    Histogram made;
    for (const double value : {-1e9, -0.0, 0.0, 1e-300, 1e300, std::numeric_limits<double>::max()})
        made.record(value);
    EXPECT_EQ(made.buckets().size(), 2u) << "0, and all that is too large";
    EXPECT_EQ(made.max(), std::numeric_limits<double>::max());
    EXPECT_THROW(made.record(std::numeric_limits<double>::infinity()), std::invalid_argument);
    EXPECT_THROW(made.record(std::nan("")), std::invalid_argument);
    EXPECT_EQ(made.count(), 6u);
}

TEST(Histogram, WhatIsAlwaysTheSameIsExact) {
    Histogram made;
    made.record(33.3, 1000);
    EXPECT_EQ(made.percentile(0.5), 33.3);
    EXPECT_EQ(made.percentile(0.99), 33.3);
    EXPECT_FALSE(made.percentile(0.999));
}

TEST(NeededFor, IsTheFewestSamplesThatHaveThatPercentile) {
    for (const double q : {0.0, 0.5, 0.9, 0.99, 0.999, 0.9999, 0.123, 0.977}) {
        SCOPED_TRACE(q);
        Histogram enough, too_few;
        enough.record(1, needed_for(q));
        too_few.record(1, needed_for(q) - 1);
        EXPECT_EQ(enough.percentile(q).has_value(), q > 0);
        EXPECT_FALSE(too_few.percentile(q));
    }
    EXPECT_EQ(needed_for(0.999), 10'000u);
    EXPECT_THROW(needed_for(1), std::invalid_argument);
}

TEST(Blocks, LoseNothingAndStayFewAndTogether) {
    Blocks one, other;
    for (int i = 0; i < 10'000; ++i) {
        one.add({static_cast<double>(i + 1), 5000});
        other.add(i % 7 == 0 ? std::vector<double>{static_cast<double>(i + 1) * 1e3} : std::vector<double>{},
                  1e-3);
        ASSERT_EQ(one.all().size(), other.all().size());
        ASSERT_LE(one.all().size(), 2 * Blocks::most);
    }
    EXPECT_GE(one.all().size(), Blocks::most);
    EXPECT_EQ(merged(one.all()).count(), 20'000u);
    EXPECT_EQ(merged(one.all()).max(), 10'000);
    EXPECT_EQ(merged(other.all()).count(), 10'000u / 7 + 1);
    // In the same block are the same times: here, the same numbers.
    for (std::size_t i = 0; i < one.all().size(); ++i)
        EXPECT_LE(other.all()[i].max(), std::max(5000.0, one.all()[i].max())) << i;
    for (std::size_t i = 1; i < one.all().size(); ++i)
        EXPECT_LT(other.all()[i - 1].max(), other.all()[i].buckets().begin()->first * 1.01) << i;
}

}  // namespace
}  // namespace knurl::measure
