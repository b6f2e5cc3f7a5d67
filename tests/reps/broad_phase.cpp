// Surfaces out of reach are not evaluated, and nothing else is left out.

#include <algorithm>
#include <array>
#include <set>

#include <gtest/gtest.h>

#include "../../reps/src/broad_phase/bounding_tree.hpp"
#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

TEST(BoundingTree, CollectsExactlyThoseThatComeNearer) {
    const std::uint64_t seed = 77;
    Rng rng(seed);
    for (int round = 0; round < 40; ++round) {
        const auto capacity = static_cast<std::uint32_t>(between(rng, 1, 400));
        detail::BoundingTree tree(capacity);
        struct Ball {
            Vector center;
            double radius;
            bool present = false;
        };
        std::vector<Ball> balls(capacity);
        std::vector<std::uint32_t> found(capacity);
        const double offset = round % 4 == 0 ? 1e6 : 0;
        for (int i = 0; i < 300; ++i) {
            const auto slot = static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(capacity) - 1));
            if (between(rng, 0, 3) > 0) {
                balls[slot] = {0.1 * direction(rng) * uniform(rng, 0, 1) + Vector(offset, 0, 0),
                               scale(rng, 1e-4, 0.02), true};
                tree.put(slot, balls[slot].center, balls[slot].radius);
            } else {
                balls[slot].present = false;
                tree.drop(slot);
            }
            if (between(rng, 0, 40) == 0) tree.index();
            const Vector p = 0.1 * direction(rng) + Vector(offset, 0, 0);
            const double within = scale(rng, 1e-6, 0.05);
            const std::uint32_t n = tree.collect(p, within, found);
            const std::set<std::uint32_t> answer(found.begin(), found.begin() + n);
            ASSERT_EQ(answer.size(), n) << "one twice; seed " << seed;
            std::uint32_t present = 0;
            for (std::uint32_t s = 0; s < capacity; ++s) {
                present += balls[s].present;
                const bool near = balls[s].present && (balls[s].center - p).norm() - balls[s].radius < within;
                if (near) {
                    ASSERT_TRUE(answer.count(s)) << "seed " << seed << " round " << round;
                }
                // It may collect one that is farther by a rounding error.
                if (!near && answer.count(s)) {
                    ASSERT_TRUE(balls[s].present);
                    ASSERT_LT((balls[s].center - p).norm() - balls[s].radius, within + 1e-8);
                }
            }
            ASSERT_EQ(tree.size(), present);
        }
    }
}

TEST(BoundingTree, UntilItSaysNothingThatMovesComesNearerUnseen) {
    const std::uint64_t seed = 78;
    knurl::test::Rng rng(seed);
    std::uint64_t seen = 0, unseen = 0;
    for (int round = 0; round < 300; ++round) {
        constexpr std::uint32_t n = 40;
        detail::BoundingTree reach(n);
        struct Ball {
            Vector center, velocity;
            double radius, since;
            bool holds, there;
        };
        std::array<Ball, n> balls{};
        const double offset = round % 4 == 0 ? 1e6 : 0;
        const Vector origin(offset, 0, -offset);
        for (int i = 0; i < 100; ++i) {
            const auto slot = static_cast<std::uint32_t>(between(rng, 0, n - 1));
            Ball& b = balls[slot];
            if (between(rng, 0, 3) == 0) {
                b.there = false;
                reach.drop(slot);
                continue;
            }
            b = {origin + uniform(rng, 0, 0.5) * direction(rng),
                 scale(rng, 1e-3, 2) * direction(rng),
                 uniform(rng, 0, 0.1),
                 uniform(rng, 1.8, 2),
                 between(rng, 0, 1) != 0,
                 true};
            reach.put_moving(slot, b.center, b.radius, b.velocity, b.since, b.holds);
        }
        const SceneTime now{.all = uniform(rng, 2, 2.5), .held = uniform(rng, 1.8, 2)};
        const Vector p = origin + 0.1 * direction(rng);
        const double within = scale(rng, 1e-6, 0.05);
        std::array<std::uint32_t, n> found;
        const detail::BoundingTree::Coming coming = reach.collect_moving(p, within, now, found);
        ASSERT_GT(coming.lasts, 0) << "seed " << seed << " round " << round;
        for (std::uint32_t s = 0; s < n; ++s) {
            if (!balls[s].there) continue;
            if (std::find(found.begin(), found.begin() + coming.count, s) != found.begin() + coming.count) {
                ++seen;
                continue;
            }
            ++unseen;
            const double moved = std::max(0.0, now.of(balls[s].holds) - balls[s].since);
            for (int k = 0; k <= 20; ++k) {  // one that is held may stand or move
                const double t = moved + k * 0.05 * std::min(coming.lasts, 10.0);
                ASSERT_GE((balls[s].center + t * balls[s].velocity - p).norm() - balls[s].radius, within)
                    << "seed " << seed << " round " << round << " slot " << s;
            }
        }
    }
    EXPECT_GT(seen, 150u);
    EXPECT_GT(unseen, 500u);
}

namespace broad_phase_tests {
namespace {

/// One endless surface: in the scene, and evaluated separately in every cycle.
template <class R, class Make>
void expect_as_if_evaluated(std::uint64_t seed, Make make) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rng rng(seed);
    Scene scene = make_scene();
    const double radius = between(rng, 0, 1) ? 0 : uniform(rng, 0, 0.003);
    ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = radius}));
    R raw = make(rng), params = prepared(raw, Limits{});
    ASSERT_TRUE(scene.add({0, 1}, raw));
    typename R::State state{};
    adopt(params, static_cast<const R*>(nullptr), state, Probe{});
    scene.settle();
    const double swift = scale(rng, 0.1, 10);
    Vector about = Vector::Zero();
    long touched = 0, evaluated = 0;
    for (int cycle = 0; cycle < 4000; ++cycle) {
        if (between(rng, 0, 100) == 0) about = scale(rng, 1e-3, 0.3) * direction(rng);  // a teleport
        if (between(rng, 0, 300) == 0) {
            raw = make(rng);
            const R next = prepared(raw, Limits{}), previous = params;
            ASSERT_TRUE(scene.update({0, 1}, raw));
            params = next;
            if (std::memcmp(&params, &previous, sizeof params) != 0) adopt(params, &previous, state, Probe{});
        }
        const double t = 1e-3 * cycle * swift;
        Probe hand = at(about + 0.02 * Vector(std::sin(3 * t), std::cos(2 * t), std::sin(5 * t)));
        const double step = between(rng, 0, 30) == 0 ? 0 : dt;
        const Vector got = scene.evaluate(hand, step).force;
        hand.radius = radius;
        const Contact want = contact(params, state, hand, step);
        const Vector force = std::max(0.0, -want.height) * want.stiffness * want.normal;
        ASSERT_LE((got - force).norm(), 1e-12 * (1 + force.norm())) << "cycle " << cycle;
        touched += force.norm() > 0;
        evaluated += scene.evaluated();
    }
    EXPECT_LT(evaluated, 4000);
}

TEST(BroadPhase, CapsOutOfReachAnswerAsIfTheyWereEvaluatedInEveryCycle) {
    for (std::uint64_t seed = 1; seed <= (long_form() ? 2000u : 100u); ++seed) {
        ASSERT_NO_FATAL_FAILURE(expect_as_if_evaluated<Cap>(seed, [](Rng& rng) {
            Cap cap{.foot = to_plain(uniform(rng, 0, 0.1) * direction(rng)),
                    .normal = to_plain(direction(rng)),
                    .curvature = between(rng, 0, 2) ? uniform(rng, -60, 60) : 0,
                    .stiffness = 300};
            cap.curvature2 = cap.curvature;
            if (between(rng, 0, 1)) {
                cap.axis = to_plain(to_eigen(cap.normal).unitOrthogonal());
                cap.curvature2 = uniform(rng, -60, 60);
            }
            if (between(rng, 0, 3) == 0) cap.stiffness = 0;
            cap.recovery = 0;
            return cap;
        }));
    }
}

TEST(BroadPhase, HalfPlanesOutOfReachAnswerAsIfTheyWereEvaluatedInEveryCycle) {
    for (std::uint64_t seed = 1; seed <= (long_form() ? 2000u : 100u); ++seed) {
        ASSERT_NO_FATAL_FAILURE(expect_as_if_evaluated<HalfPlane>(seed, [](Rng& rng) {
            const Vector n = direction(rng);
            return HalfPlane{.normal = to_plain(n),
                             .offset = uniform(rng, -0.08, 0.08),
                             .edge = to_plain(n.unitOrthogonal()),
                             .edge_offset = uniform(rng, -0.08, 0.08),
                             .stiffness = 300,
                             .recovery = 0,
                             .sides = between(rng, 0, 1) ? Sides::both : Sides::front};
        }));
    }
}

}  // namespace
}  // namespace broad_phase_tests
