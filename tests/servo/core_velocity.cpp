// The three velocities, compared with closed forms for known motions.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <knurl/servo/velocity.hpp>

namespace knurl::servo {
namespace {

TEST(FirstOrder, StepResponseIsTheExponentialAtAnyRate) {
    for (const double rate : {500.0, 1000.0, 4000.0, 20000.0}) {
        FirstOrderVelocity filter(100);
        for (int i = 0; i < static_cast<int>(rate / 100); ++i) filter.add({1, 0, 0}, 1 / rate);
        // After 10 ms: 1 - exp(-2 pi 100 0.01)
        EXPECT_NEAR(filter.value().x(), 1 - std::exp(-2 * M_PI), 1e-12) << rate;
    }
}

/// The paper's own procedure, tested sample by sample against every line: O(n^2), one axis.
double end_fit(const std::vector<double>& y, const std::vector<double>& t, double band, std::size_t window) {
    const std::size_t k = y.size() - 1;
    double slope = 0;
    for (std::size_t n = 1; n <= window && n <= k; ++n) {
        const long double candidate =
            (static_cast<long double>(y[k]) - y[k - n]) / (static_cast<long double>(t[k]) - t[k - n]);
        for (std::size_t i = 1; i < n; ++i)
            if (std::abs(y[k] - candidate * (t[k] - t[k - i]) - y[k - i]) > band * (1 + 1e-12L)) return slope;
        slope = static_cast<double>(candidate);
    }
    return slope;
}

TEST(Adaptive, FindsTheWindowThatTestingEveryLineFinds) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        AdaptiveVelocity filter;
        std::vector<double> y, t;
        const double step = 30e-6;
        // counts are off a line by sixteenths at least: never just on the edge
        const double band = 0.97 * step;
        double position = 0, speed = 0, time = 0;
        for (int i = 0; i < 500; ++i) {
            speed += 0.01 * uniform(random);
            position += speed * 1e-3;
            const double count = std::round(position / step) * step;
            const double dt = i == 0 ? 0 : 1e-3;
            time += dt;
            y.push_back(count);
            t.push_back(time);
            filter.add({count, -count, 0}, Eigen::Vector3d::Constant(band), dt);
            const double reference = end_fit(y, t, band, AdaptiveVelocity::window);
            EXPECT_NEAR(filter.value().x(), reference, 1e-9) << "sample " << i;
            EXPECT_EQ(filter.value().y(), -filter.value().x());
            EXPECT_EQ(filter.value().z(), 0);
        }
    }
}

TEST(Adaptive, AQuantisedRampIsQuietAndAReversalIsSeenWithinTwoMilliseconds) {
    AdaptiveVelocity filter;
    const double count = 30e-6;
    const Eigen::Vector3d band = Eigen::Vector3d::Constant(count);
    double position = 0;
    for (int i = 0; i < 200; ++i) {
        position += 0.05 * 1e-3;
        filter.add({std::round(position / count) * count, 0, 0}, band, i == 0 ? 0 : 1e-3);
        // A raw difference is wrong by up to 30 mm/s here.
        if (i > 20) {
            EXPECT_NEAR(filter.value().x(), 0.05, 2.0 * count / 15e-3);
        }
    }
    for (int i = 0; i < 3; ++i) {
        position -= 0.1 * 1e-3;
        filter.add({std::round(position / count) * count, 0, 0}, band, 1e-3);
    }
    EXPECT_LT(filter.value().x(), 0);
}

TEST(Adaptive, TheWindowIsSecondsNotSamples) {
    // Noise of one count at rest: the error must not grow with the rate.
    double worst[2] = {};
    for (const int fast : {0, 1}) {
        const double rate = fast ? 4000 : 1000;
        std::mt19937_64 random(3);
        AdaptiveVelocity filter;
        const double count = 30e-6;
        for (int i = 0; i < static_cast<int>(2 * rate); ++i) {
            const double noise = static_cast<double>(random() % 2) * count;
            filter.add({noise, 0, 0}, Eigen::Vector3d::Constant(count), i == 0 ? 0 : 1 / rate);
            if (i > 100) worst[fast] = std::max(worst[fast], std::abs(filter.value().x()));
        }
    }
    EXPECT_LT(worst[1], 1.3 * worst[0]);
    EXPECT_LT(worst[0], 1.1 * 30e-6 / 15e-3);
}

TEST(Adaptive, ResetForgets) {
    AdaptiveVelocity filter;
    for (int i = 0; i < 30; ++i)
        filter.add({1e-3 * i, 0, 0}, Eigen::Vector3d::Constant(1e-9), i == 0 ? 0 : 1e-3);
    EXPECT_NEAR(filter.value().x(), 1, 1e-9);
    filter.reset();
    EXPECT_EQ(filter.value().x(), 0);
    filter.add({5, 0, 0}, Eigen::Vector3d::Constant(1e-9), 0);
    EXPECT_EQ(filter.value().x(), 0) << "a new place is no motion";
}

}  // namespace
}  // namespace knurl::servo
