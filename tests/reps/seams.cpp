// Touching surfaces hold the hand like one: a hand that is pressed into a surface and slides on to its
// neighbour, or against a wall that stands on it. Flat surfaces; seams_of_shapes.cpp has the others.

#include <algorithm>
#include <iostream>
#include <vector>

#include "seam_tools.hpp"

namespace seams_tests {
namespace {

template <class Try>
void all_pairs(const char* what, Try&& one) {
    for (const Kind a : flat_kinds) {
        for (const Kind b : flat_kinds) {
            Rng rng(seed() + 16 * static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
            Counts counts;
            one(a, b, rng, counts);
            std::cout << names[int(a)] << what << names[int(b)] << ": " << counts << ", KNURL_SEED=" << seed()
                      << '\n';
            EXPECT_EQ(counts.lost, 0u) << names[int(a)] << what << names[int(b)];
            EXPECT_GT(counts.approaches, 100u);
        }
    }
}

}  // namespace

TEST(Seams, AHandSlidesOnToWhatTouches) {
    all_pairs(" to ",
              [](Kind a, Kind b, Rng& rng, Counts& counts) { across(a, b, approaches(1100), rng, counts); });
}

TEST(Seams, AHandInACornerIsHeldByBoth) {
    all_pairs(" with ", [](Kind a, Kind b, Rng& rng, Counts& counts) {
        into_a_corner(a, b, approaches(1100), rng, counts);
    });
}

// Pressed into a soft surface, over the seam, further in and out, lifted. The hard surface takes hold without a
// step, and what the hand has put in over the soft one it does not get back twice over the hard one.
TEST(Seams, OnToAHarderNeighbourTheHandSlidesWithoutAStepAndGainsNothing) {
    Rng rng(seed());
    double lost = 0, gained = 0;
    for (std::uint64_t round = 0; round < approaches(2000); ++round) {
        const Kind kind_a = flat_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Kind kind_b = flat_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Pose pose = any_pose(rng);
        const Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {0, -0.05, 0}, {0.05, 0.05, 0}};
        const double soft = log_uniform(rng, 100, 1000), hard = soft * log_uniform(rng, 1.1, 10);
        Scene scene = room();
        const auto add_as_hard = [&](std::uint32_t slot, Kind kind, const Face& face, double stiffness) {
            put(kind, face, 0.05, slot == 0, [&](auto surface) {
                surface.stiffness = stiffness;
                ASSERT_TRUE(scene.add({slot, 1}, surface));
            });
        };
        add_as_hard(0, kind_a, a, soft);
        add_as_hard(1, kind_b, b, hard);
        std::vector<Vector> way{{-3e-3, 0, 1e-3}};
        const double depth = uniform(rng, 1e-3, 4e-3);
        way.push_back({-3e-3, 0, -depth});
        way.push_back({3e-3, 0, -uniform(rng, 1e-3, 4e-3)});
        for (int i = between(rng, 0, 3); i > 0; --i)
            way.push_back({uniform(rng, 1e-3, 5e-3), uniform(rng, -1e-3, 1e-3), -uniform(rng, 0, 5e-3)});
        way.push_back({3e-3, 0, 1e-3});
        double work = 0, steepest = 0;
        Vector before = way[0], last = Vector::Zero();
        for (std::size_t leg = 1; leg < way.size(); ++leg) {
            for (int i = 1; i <= 400; ++i) {
                const Vector p = way[leg - 1] + i / 400.0 * (way[leg] - way[leg - 1]);
                const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
                work += (force + last).dot(p - before) / 2;
                steepest = std::max(steepest, (force - last).norm() / (p - before).norm());
                last = force;
                before = p;
            }
        }
        ASSERT_EQ(last.norm(), 0);
        // The trapezoidal rule is exact but for the cycles in which a force begins or ends.
        ASSERT_LE(work, 1e-6) << "J; seed " << seed() << " round " << round;
        ASSERT_LE(steepest, hard * (1 + 1e-6)) << "N/m; seed " << seed() << " round " << round;
        gained = std::max(gained, work);
        lost = std::max(lost, -work);
    }
    std::cout << "lost at most " << lost << " J, gained " << gained << " J, KNURL_SEED=" << seed() << '\n';
    EXPECT_LE(lost, 1e-6) << "J: it gives back what the hand put in";
}

// The order of addition makes no difference.
TEST(Seams, TheOrderOfSurfacesMakesNoDifference) {
    Rng rng(seed());
    for (int round = 0; round < 300; ++round) {
        const Kind kind_a = flat_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Kind kind_b = flat_kinds[static_cast<std::size_t>(between(rng, 0, 2))];
        const Pose pose = any_pose(rng);
        Face a{pose, {-0.05, -0.05, 0}, {0, 0.05, 0}}, b{pose, {little(rng, 0), -0.04, 0}, {0.05, 0.04, 0}};
        b.pose.shift = pose({0, 0, little(rng, 0)});
        Forms forms;
        Scene one = room(), other = room();
        add(one, 0, kind_a, a, 0.01, true, forms);
        add(one, 1, kind_b, b, 0.01, false, forms);
        add(other, 0, kind_b, b, 0.01, false, forms);
        add(other, 1, kind_a, a, 0.01, true, forms);
        const double speed = log_uniform(rng, 1e-3, 0.3);
        for (int i = -20; i < 60; ++i) {
            const Vector p(0.3 * speed * dt * (std::abs(i - 20) - 20), 1e-4, i < -10 ? 1e-3 : -2e-3);
            const Vector force = one.evaluate(at(pose(p)), dt).force;
            ASSERT_LE((force - other.evaluate(at(pose(p)), dt).force).norm(), 1e-9)
                << "seed " << seed() << " round " << round << " cycle " << i;
            if (i > 0) {
                ASSERT_GT(force.norm(), 1.9) << "seed " << seed() << " round " << round << " cycle " << i;
            }
        }
    }
}

// Two tables on one belt, sent anew 30 times a second with the error of the application's clock.
TEST(Seams, WhatMovesAndIsSentAnewHoldsLikeOne) {
    Rng rng(seed());
    for (int round = 0; round < 200; ++round) {
        const Kind kinds[] = {flat_kinds[static_cast<std::size_t>(between(rng, 0, 2))],
                              flat_kinds[static_cast<std::size_t>(between(rng, 0, 2))]};
        const Pose pose = any_pose(rng);
        const Vector belt(uniform(rng, -0.2, 0.2), uniform(rng, -0.2, 0.2), uniform(rng, -0.05, 0.05));
        const bool anew = between(rng, 0, 1);
        const double gap = little(rng, 0);
        Scene scene = room();
        scene.set_fade({.automatic = 0.01, .rise_speed = infinity});
        const auto tell = [&](double time, bool first) {
            for (std::uint32_t i = 0; i < 2; ++i) {
                Face face{pose, {i == 0 ? -0.05 : gap, -0.05, 0}, {i == 0 ? 0 : 0.05, 0.05, 0}};
                face.pose.shift = pose(time * belt);
                put(kinds[i], face, 0.01, i == 0, [&](auto surface) {
                    surface.velocity = to_plain(pose.turn * belt);
                    ASSERT_TRUE(first ? scene.add({i, 1}, surface) : scene.update({i, 1}, surface));
                });
            }
        };
        tell(0, true);
        const double y = uniform(rng, -5e-3, 5e-3);
        for (int i = 0; i < 200; ++i) {
            if (anew && i % 33 == 32) tell(dt * i, false);
            const double x = 4e-3 * std::sin(0.05 * i), z = std::max(-3e-3, 1e-3 - 1e-4 * i);
            // In the cycle that takes it a surface is at the stated place, and moves on from there.
            const Vector p = Vector(x, y, z) + dt * i * belt;
            const Vector force = pose.turn.conjugate() * scene.evaluate(at(pose(p)), dt).force;
            // An update states its place in the next cycle.
            const double slack = k * (2e-5 + (anew ? dt * belt.norm() : 0));
            ASSERT_LE((force - Vector(0, 0, k * std::max(0.0, -z))).norm(), slack)
                << "seed " << seed() << " round " << round << " cycle " << i;
        }
    }
}

// A ball rolls over the gap, and is pushed aside by no more than the path over the step. While its centre has
// not entered, everything that it overlaps acts as planes at its feet, which lean more the nearer the edge
// is. There it is held by at least half of its depth, and pushed by no more than that.
TEST(Seams, ABallSlidesOnToWhatTouches) {
    Rng rng(seed());
    double worst = -1;
    for (int round = 0; round < 1500 && !HasFailure(); ++round) {
        const auto any = [&] { return flat_kinds[static_cast<std::size_t>(between(rng, 0, 2))]; };
        const Kind a = any(), b = any();
        worst = std::max(worst, roll_over_a_seam(a, b, 3e-5, rng));
    }
    std::cout << "farthest beyond the bound " << worst << " N, KNURL_SEED=" << seed() << '\n';
}

// While a neighbour fades out, a surface is in two sets, with the neighbour and without. Both must evaluate
// it alike. Else its force, and with a texture even whether it is finite, would depend on which set was
// evaluated last.
TEST(Seams, WhatStaysIsFeltAsItWasWhileItsNeighbourFadesOut) {
    Scene scene({.representations = 4, .probes = 1}, {});
    ASSERT_TRUE(scene.place_probe(0, {.offset = {}, .radius = 3e-3}));
    const Box stays{.center = {0, 0, -0.05}, .stiffness = 1000, .texture = {.amplitude = 1e-5}};
    ASSERT_TRUE(scene.add({0, 1}, stays));
    ASSERT_TRUE(scene.add({1, 1}, Box{.center = {0.16, 0, -0.05}, .stiffness = 1000, .recovery = 0.02}));
    scene.settle();
    // Over the edge of the remaining one, which the probe's centre has not entered.
    const auto evaluate = [&] { return scene.evaluate(at({0.051, 0, 0.001}), dt).force; };
    evaluate();
    const Vector before = evaluate();
    ASSERT_GT(before.norm(), 1.0);
    ASSERT_TRUE(scene.remove({1, 1}));
    for (int i = 0; i < 30; ++i) EXPECT_LE((evaluate() - before).norm(), 1e-9) << "N, cycle " << i;
    std::array<Feedback, 4> feedback;
    ASSERT_EQ(scene.feedback(feedback), 1u);
    EXPECT_TRUE(feedback[0].wrench.force.allFinite());
}

}  // namespace seams_tests
