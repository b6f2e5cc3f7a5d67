// Many planes are not evaluated while the probe cannot have reached them: the force must not show it.

#include <vector>

#include <gtest/gtest.h>

#include "scene_tools.hpp"

namespace far_planes_tests {
namespace {

using namespace knurl;
using namespace knurl::test;

/// The same planes twice; one scene also has a moving plane far behind all others, so that it scans all
/// planes in every cycle.
struct Both {
    Scene left_alone = make_scene(), scanned = make_scene();
    std::vector<Plane> planes;

    explicit Both(std::size_t count, Rng& rng, double away) {
        for (std::uint32_t i = 0; i < count; ++i) {
            // Some as near as the hand's last steps, others far away; of two stiffnesses.
            const double offset = -away * scale(rng, 0.1, 10);
            planes.push_back({.normal = to_plain(direction(rng)),
                              .offset = offset,
                              .stiffness = i % 3 == 0 ? 700.0 : 1000.0,
                              .recovery = i % 5 == 0 ? 0 : automatic,
                              .friction = {.dynamic = i % 4 == 0 ? 0.5 : 0.0}});
            EXPECT_TRUE(left_alone.add({i, 1}, planes.back()));
            EXPECT_TRUE(scanned.add({i, 1}, planes.back()));
        }
        EXPECT_TRUE(scanned.add(
            {63, 1},
            Plane{.normal = {0, 0, 1}, .offset = -1e6, .velocity = {1e-3, 0, 0}, .stiffness = 1000}));
        left_alone.settle(), scanned.settle();
    }
    void update(std::uint32_t i, double offset) {
        planes[i].offset = offset;
        EXPECT_TRUE(left_alone.update({i, 1}, planes[i]));
        EXPECT_TRUE(scanned.update({i, 1}, planes[i]));
    }
};

TEST(FarPlanes, ThoseThatAreNotEvaluatedAreNotMissed) {
    const std::uint64_t seed = 2611;
    Rng rng(seed);
    int touched = 0, free = 0;
    for (int round = 0; round < (long_form() ? 2000 : 100); ++round) {
        const double away = scale(rng, 1e-4, 0.1);
        Both both(static_cast<std::size_t>(between(rng, 1, 60)), rng, away);
        Vector p = Vector::Zero(), way = direction(rng);
        for (int i = 0; i < 300; ++i) {
            if (between(rng, 0, 20) == 0) way = direction(rng);
            if (between(rng, 0, 15) == 0) p.setZero();
            p += away * scale(rng, 1e-3, 0.05) * way;
            for (int k = between(rng, 0, 30) == 0 ? between(rng, 1, 40) : 0; k > 0; --k)
                both.update(
                    static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(both.planes.size()) - 1)),
                    -away * scale(rng, 0.1, 10));
            const Probe hand = at(p);
            const Wrench a = both.left_alone.evaluate(hand, dt), b = both.scanned.evaluate(hand, dt);
            ASSERT_TRUE(same_bits(a, b)) << a.force.transpose() << " instead of " << b.force.transpose()
                                         << ", seed " << seed << " round " << round << " cycle " << i;
            (a.force.isZero(0) ? free : touched) += 1;
        }
    }
    EXPECT_GT(touched, 1000);
    EXPECT_GT(free, 1000);
}

// A probe closer to the nearest plane than rounding resolves: touched exactly when its distance says so.
TEST(FarPlanes, TheCycleInWhichOneIsReachedIsTheSame) {
    const std::uint64_t seed = 2612;
    Rng rng(seed);
    for (int round = 0; round < 200; ++round) {
        const double away = scale(rng, 1e-6, 1);
        const Vector middle = scale(rng, 1e-3, 10) * direction(rng), n = direction(rng);
        Scene scene = make_scene();
        for (std::uint32_t i = 0; i < 40; ++i) {
            ASSERT_TRUE(scene.add(
                {i, 1},
                Plane{.normal = to_plain(n), .offset = n.dot(middle) - away * (1 + i), .stiffness = 1000}));
        }
        scene.settle();
        scene.evaluate(at(middle), dt);
        for (const double part : {0.5, 0.999999999, 1.000000001, 1.5}) {
            const double force = scene.evaluate(at(middle - part * away * n), dt).force.norm();
            if (away * 1e-9 < 1e-13 && part != 0.5 && part != 1.5) continue;  // below rounding
            EXPECT_EQ(force > 0, part > 1)
                << part << " of " << away << " m, seed " << seed << " round " << round;
        }
    }
}

TEST(FarPlanes, AStillSceneKnowsHowFarTheHandHasMovedSinceTheyWereEvaluated) {
    Scene scene = make_scene();
    for (std::uint32_t i = 0; i < 40; ++i)
        ASSERT_TRUE(scene.add({i, 1}, Plane{.normal = {0, 0, 1}, .offset = -1, .stiffness = 1000}));
    scene.settle();
    std::vector<Feedback> entries(40);
    std::vector<std::uint64_t> wholly(1), flags(1);
    for (const double z : {0.0, -0.4, -0.9}) {
        scene.evaluate(at({0, 0, z}), dt);
        scene.feedback(entries, {.wholly = wholly, .flags = flags});
        EXPECT_LE(scene.sleep_radius(), 1 + z) << z;
        EXPECT_GT(scene.sleep_radius(), 0.9 * (1 + z)) << z;
    }
}

}  // namespace
}  // namespace far_planes_tests
