// Contacts are conservative: on any closed path the hand gets back the work that it puts in.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

// A smooth closed curve through the walls: three harmonics about a centre.
struct Loop {
    Vector centre, a[3], b[3];
    explicit Loop(Rng& rng) : centre(0.003 * direction(rng)) {
        for (int h = 0; h < 3; ++h)
            a[h] = 0.002 / (h + 1) * direction(rng), b[h] = 0.002 / (h + 1) * direction(rng);
    }
    Vector at(double t) const {
        Vector p = centre;
        for (int h = 0; h < 3; ++h) p += a[h] * std::cos((h + 1) * t) + b[h] * std::sin((h + 1) * t);
        return p;
    }
};

double work(Scene& scene, const Loop& loop, int steps) {
    double sum = 0;
    Vector p = loop.at(0);
    for (int i = 0; i < steps; ++i) {
        const Vector next = loop.at(2 * M_PI * (i + 1) / steps);
        sum += scene.evaluate(at((p + next) / 2), dt).force.dot(next - p);
        p = next;
    }
    return sum;
}

}  // namespace

TEST(WorkOfClosedLoops, IsNothingForAnyPlanesAndAnyMixOfStiffness) {
    const std::uint64_t seed = 77;
    Rng rng(seed);
    for (int round = 0; round < (long_form() ? 1000 : 60); ++round) {
        const PlaneSet set = corner(rng, between(rng, 1, 9), 0.01);
        Scene scene = make_scene();
        for (std::uint32_t i = 0; i < set.size(); ++i) {
            const double k = round % 3 == 0 ? 1000 : scale(rng, 50, 3000);
            ASSERT_TRUE(scene.add(
                {i, 1}, Plane{.normal = to_plain(set.normal(i)), .offset = set.c[i], .stiffness = k}));
        }
        scene.settle();
        EXPECT_LE(std::abs(work(scene, Loop(rng), 20'000)), 1e-8) << "J; seed " << seed << " round " << round;
    }
}

TEST(WorkOfClosedLoops, IsNothingForContradictoryPlanes) {
    Rng rng(78);
    for (int round = 0; round < 20; ++round) {
        Scene scene = make_scene();
        const Vector n = direction(rng);
        ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = to_plain(n), .offset = 0.001, .stiffness = 2000}));
        ASSERT_TRUE(scene.add(
            {1, 1}, Plane{.normal = to_plain(-n), .offset = 0.001, .stiffness = round % 2 ? 2000.0 : 300.0}));
        ASSERT_TRUE(scene.add({2, 1}, Plane{.normal = to_plain(direction(rng)), .stiffness = 700}));
        scene.settle();
        EXPECT_LE(std::abs(work(scene, Loop(rng), 20'000)), 1e-8) << "J; round " << round;
    }
}

TEST(WorkOfClosedLoops, DampingOnlyTakes) {
    Rng rng(79);
    for (int round = 0; round < 20; ++round) {
        Scene scene = make_scene();
        for (std::uint32_t i = 0; i < 4; ++i) {
            ASSERT_TRUE(scene.add(
                {i, 1},
                Plane{.normal = to_plain(direction(rng)), .stiffness = 500.0 + 300 * i, .damping = 3}));
        }
        scene.settle();
        const Loop loop(rng);
        constexpr int steps = 20'000;
        double sum = 0;
        Vector p = loop.at(0);
        for (int i = 0; i < steps; ++i) {
            const Vector next = loop.at(2 * M_PI * (i + 1) / steps);
            sum += scene.evaluate(at((p + next) / 2, (next - p) / 1e-5), dt).force.dot(next - p);
            p = next;
        }
        EXPECT_LE(sum, 1e-8) << "the hand must not gain; round " << round;
    }
}
