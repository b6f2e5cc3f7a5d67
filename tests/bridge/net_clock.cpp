// The clock of another host: for any path, the truth lies inside the stated interval.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "clock_estimate.hpp"

namespace knurl::bridge::test::net_clock_tests {
namespace {

using Ns = std::int64_t;
constexpr double ms = 1e6, s = 1e9;  // in ns

/// Another host's clock and the path to it; a seed determines both.
struct World {
    explicit World(unsigned seed) : random(seed) {}

    double offset = 0;                                         // ns at local time 0
    double drift = 0;                                          // s/s
    double wander = 0;                                         // s/s peak, a sine of 7 s
    double forth = 0.1 * ms, back = 0.1 * ms;                  // the shortest delays
    double forth_jitter = 0.05 * ms, back_jitter = 0.05 * ms;  // means of exponential tails
    double loss = 0;

    double truth(double t) const {
        const double omega = 2 * M_PI / (7 * s);
        return offset + drift * t - wander / omega * std::cos(omega * t);
    }
    double rate(double t) const { return drift + wander * std::sin(2 * M_PI / (7 * s) * t); }  // s/s
    double remote(double t) const { return t + truth(t); }
    double tail(double mean) { return mean > 0 ? std::exponential_distribution<>(1 / mean)(random) : 0; }

    /// An exchange that begins at local time t; false: a datagram was lost.
    bool exchange(ClockEstimate& estimate, double t, double* end = nullptr) {
        const double there = t + forth + tail(forth_jitter), answered = there + 0.02 * ms + tail(0.01 * ms);
        const double here = answered + back + tail(back_jitter);
        if (end) *end = here;
        if (std::uniform_real_distribution<>()(random) < loss) return false;
        estimate.add(floor(t), floor(remote(there)), floor(remote(answered)), floor(here));
        return true;
    }
    static Ns floor(double t) { return static_cast<Ns>(std::floor(t)); }

    std::mt19937_64 random;
};

/// ns by which the truth is outside of the stated interval; 0 or less is right.
double outside(const ClockEstimate& estimate, const World& world, double now) {
    const Ns t = World::floor(now);
    return std::abs(static_cast<double>(estimate.offset_at(t)) - world.truth(now)) -
           static_cast<double>(estimate.uncertainty(t));
}

TEST(ClockEstimate, KnowsNothingBeforeTheFirstExchange) {
    const ClockEstimate estimate;
    EXPECT_FALSE(estimate.known());
    EXPECT_EQ(estimate.uncertainty(0), ClockEstimate::unknown);
    EXPECT_EQ(estimate.offset_at(5), 0);
    EXPECT_EQ(estimate.drift_uncertainty(), ClockEstimate::max_drift);
}

TEST(ClockEstimate, OneExchangeLeavesHalfTheRoundTrip) {
    ClockEstimate estimate;
    // 100 there, 50 held, 150 back, clock 50'000 ahead
    ASSERT_TRUE(estimate.add(1000, 51'100, 51'150, 1300));
    EXPECT_NEAR(static_cast<double>(estimate.offset_at(1300)), 49'975, 2);  // ((t1-t0) + (t2-t3))/2
    EXPECT_NEAR(static_cast<double>(estimate.uncertainty(1300)), 125, 3);
    EXPECT_EQ(estimate.round_trip(), 250);
}

TEST(ClockEstimate, StatesNothingButTheTruthWhateverTheWayDoes) {
    constexpr unsigned seeds = 300;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
        World world(seed);
        const auto uniform = [&](double a, double b) {
            return std::uniform_real_distribution<>(a, b)(world.random);
        };
        world.offset = uniform(-1, 1) * std::pow(10, uniform(3, 16));  // up to a third of a year
        world.drift = uniform(-300e-6, 300e-6);
        world.wander = uniform(0, 1e-6);
        world.forth = uniform(0.005 * ms, 100 * ms);
        world.back = uniform(0.005 * ms, 100 * ms);
        world.forth_jitter = uniform(0, 100 * ms);
        world.back_jitter = seed % 3 ? uniform(0, 1 * ms) : 0;
        world.loss = uniform(0, 0.5);
        ClockEstimate estimate;
        double t = uniform(0, 1e6) * s;
        for (int i = 0; i < 300; ++i) {
            double end = 0;
            const bool came = world.exchange(estimate, t, &end);
            if (!estimate.known()) continue;
            // The test's arithmetic resolves offsets of 1e16 ns only to 2 ns.
            ASSERT_LE(outside(estimate, world, end), 4) << "seed " << seed << " exchange " << i;
            ASSERT_LE(outside(estimate, world, end + uniform(0, 1) * s), 4)
                << "seed " << seed << " exchange " << i;
            // The test's error of 4 ns, over the 10 ms that are at least between two exchanges.
            if (came) {
                ASSERT_LE(std::abs(estimate.drift() - world.rate(end)),
                          estimate.drift_uncertainty() + 4 / (10 * ms))
                    << "seed " << seed << " exchange " << i;
            }
            t = end + (i < 20 ? 10 : 100) * ms;
        }
    }
}

TEST(ClockEstimate, IsTightOnAQuietNetwork) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        World world(seed);
        world.offset = 3e12;
        world.drift = 40e-6;
        ClockEstimate estimate;
        double end = 0;
        for (int i = 0; i < 100; ++i) world.exchange(estimate, (1000 + 100 * i) * ms, &end);
        const Ns now = World::floor(end);
        // Paths take at least 0.1 ms, which remains uncertain, plus the drift's wander over 6 s (12 us). The
        // estimate itself is much more accurate.
        EXPECT_LT(static_cast<double>(estimate.uncertainty(now)), 0.14 * ms) << "seed " << seed;
        EXPECT_LT(std::abs(static_cast<double>(estimate.offset_at(now)) - world.truth(end)), 0.02 * ms)
            << "seed " << seed;
        EXPECT_NEAR(estimate.drift(), 40e-6, 20e-6) << "seed " << seed;
        EXPECT_LT(estimate.drift_uncertainty(), 50e-6) << "seed " << seed;
    }
}

TEST(ClockEstimate, OneSlowDirectionWidensTheBoundByItsShortestWayOnly) {
    World world(5);
    world.forth = 50 * ms;
    world.back = 0.1 * ms;
    world.forth_jitter = 30 * ms;
    ClockEstimate estimate;
    double end = 0;
    for (int i = 0; i < 200; ++i) world.exchange(estimate, 150.0 * i * ms, &end);
    EXPECT_LE(outside(estimate, world, end), 1);
    EXPECT_GT(static_cast<double>(estimate.uncertainty(World::floor(end))), 24 * ms)
        << "nobody can know better";
    EXPECT_LT(static_cast<double>(estimate.uncertainty(World::floor(end))), 30 * ms);
}

TEST(ClockEstimate, AllowsForADriftThatWanders) {
    World world(8);
    world.drift = 50e-6;
    world.wander = 1e-6;  // 1 us back and forth within 7 s: more than the path's 0.2 us would allow
    world.forth = world.back = 200;
    world.forth_jitter = world.back_jitter = 0;
    ClockEstimate estimate;
    for (int i = 0; i < 300; ++i) {
        double end = 0;
        world.exchange(estimate, 100.0 * i * ms, &end);
        ASSERT_LE(outside(estimate, world, end), 2) << "exchange " << i;
        ASSERT_LE(outside(estimate, world, end + 1 * s), 2) << "exchange " << i;
    }
}

TEST(ClockEstimate, GrowsMoreUncertainWhileNothingComes) {
    World world(6);
    world.drift = 100e-6;
    ClockEstimate estimate;
    double end = 0;
    for (int i = 0; i < 50; ++i) world.exchange(estimate, 100.0 * i * ms, &end);
    Ns last = estimate.uncertainty(World::floor(end));
    for (int seconds = 1; seconds < 60; ++seconds) {
        const double later = end + seconds * s;
        EXPECT_GT(estimate.uncertainty(World::floor(later)), last);
        EXPECT_LE(outside(estimate, world, later), 1);
        last = estimate.uncertainty(World::floor(later));
    }
}

TEST(ClockEstimate, AClockThatWasSetIsBelievedAtOnce) {
    for (const double jump : {3600 * s, -3600 * s, 5 * ms}) {
        World world(7);
        ClockEstimate estimate;
        for (int i = 0; i < 30; ++i) world.exchange(estimate, 100.0 * i * ms);
        world.offset += jump;
        double end = 0;
        world.exchange(estimate, 5000 * ms, &end);
        EXPECT_LE(outside(estimate, world, end), 1) << jump;
    }
}

TEST(ClockEstimate, StampsThatCannotBeAreIgnored) {
    ClockEstimate estimate;
    EXPECT_FALSE(estimate.add(100, 200, 200, 99)) << "came back before it was sent";
    EXPECT_FALSE(estimate.add(100, 201, 200, 110)) << "answered before it was there";
    EXPECT_FALSE(estimate.add(100, 200, 300, 110)) << "held longer than it was away";
    constexpr Ns largest = std::numeric_limits<Ns>::max(), least = std::numeric_limits<Ns>::min();
    EXPECT_FALSE(estimate.add(100, least, largest, 110));
    EXPECT_FALSE(estimate.add(100, largest, largest, 110));
    EXPECT_FALSE(estimate.known());
    EXPECT_TRUE(estimate.add(100, 200, 201, 110));
    EXPECT_FALSE(estimate.add(90, 200, 201, 110)) << "not after the last one";
    estimate.forget();
    EXPECT_FALSE(estimate.known());
}

}  // namespace
}  // namespace knurl::bridge::test::net_clock_tests
