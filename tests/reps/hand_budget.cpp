// The hand's budget alone: the scales that follow from loads, and their rates.

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <knurl/reps/hand_budget.hpp>

#include "scene_tools.hpp"

namespace hand_budget_tests {
namespace {

using namespace knurl;
using namespace knurl::test;

double largest(const Matrix6& m) {
    return Eigen::SelfAdjointEigenSolver<Matrix6>(m).eigenvalues()(5);
}

}  // namespace

TEST(HandBudget, GivesEachOfFiveFingersAFifthNoFasterThanItSays) {
    HandBudget budget;
    SceneLoad load;
    load.contacts(2, 2) = 5;
    double last = 1;
    for (int cycle = 0; cycle < 200; ++cycle) {
        budget.advance(load, 0, dt);
        const double now = budget.scales().contacts;
        ASSERT_LE(last - now, last * dt / HandBudget::fall_time * (1 + 1e-12)) << "cycle " << cycle;
        last = now;
    }
    EXPECT_DOUBLE_EQ(last, 0.2);
    EXPECT_EQ(budget.scales().damping, 1);
    EXPECT_EQ(budget.scales().effects, 1);
    for (int cycle = 0; cycle < 1000 && !budget.rests(); ++cycle) {
        budget.advance({}, 0, dt);
        const double now = budget.scales().contacts;
        ASSERT_LE(now - last, last * dt / HandBudget::rise_time * (1 + 1e-12)) << "cycle " << cycle;
        last = now;
    }
    EXPECT_TRUE(budget.rests());
}

TEST(HandBudget, NoTimeNoChange) {
    HandBudget budget;
    SceneLoad load;
    load.contacts(0, 0) = load.damping(1, 1) = 7;
    budget.advance(load, 0, 0);
    EXPECT_TRUE(budget.rests());
    budget.advance(load, 0, infinity);  // at once
    EXPECT_DOUBLE_EQ(budget.scales().contacts, 1.0 / 7);
    EXPECT_DOUBLE_EQ(budget.scales().damping, 1.0 / 7);
}

TEST(HandBudget, WhatEffectsGetDoesNotKnowWhatIsTouched) {
    HandBudget touching, away;
    SceneLoad load{.surfaces = true};
    load.effects(0, 0) = load.effects(2, 2) = 0.8;
    away.advance(load, 0, infinity);
    load.contacts(2, 2) = 1;
    touching.advance(load, 0, infinity);
    EXPECT_DOUBLE_EQ(touching.scales().effects, 0.5 / 0.8);
    EXPECT_EQ(away.scales().effects, touching.scales().effects);
    EXPECT_DOUBLE_EQ(touching.scales().contacts, 0.5);
    load.surfaces = false;
    load.contacts.setZero();
    away.advance(load, 0, infinity);
    EXPECT_EQ(away.scales().effects, 1) << "where there are no surfaces, all of it";
}

TEST(HandBudget, NeverLeavesMoreThanThereIs) {
    const std::uint64_t seed = 816;
    Rng rng(seed);
    const auto any = [&](int parts) {
        Matrix6 m = Matrix6::Zero();
        for (; parts > 0; --parts) {
            Eigen::Matrix<double, 6, 1> v = Eigen::Matrix<double, 6, 1>::Zero();
            for (int k = 0; k < 6; ++k) v(k) = between(rng, 0, 1) * uniform(rng, -1, 1);
            m += scale(rng, 0.01, 5) * v * v.transpose();
        }
        return m;
    };
    for (int i = 0; i < 2000; ++i) {
        const SceneLoad load{.contacts = any(between(rng, 1, 4)),
                             .effects = any(between(rng, 0, 4)),
                             .damping = any(between(rng, 0, 4)),
                             .surfaces = true};
        HandBudget budget;
        budget.advance(load, 0, infinity);
        const HandScales& s = budget.scales();
        ASSERT_LE(largest(s.contacts * load.contacts + s.effects * load.effects), 1 + 1e-9)
            << "seed " << seed << " case " << i;
        ASSERT_LE(largest(s.effects * load.effects), 0.5 + 1e-9) << "seed " << seed << " case " << i;
        ASSERT_LE(largest(s.damping * load.damping), 1 + 1e-9) << "seed " << seed << " case " << i;
        if (s.contacts < 1) {  // ... nor less than it could
            ASSERT_GE(largest(s.contacts * load.contacts + s.effects * load.effects), 1 - 1e-6)
                << "seed " << seed << " case " << i;
        }
    }
}

// E = m v^2 / 2 + s V: for all loads and motions of the hand, the energy of rising scales was paid before.
TEST(HandBudget, GivesNoMoreThanIsPaid) {
    const std::uint64_t seed = 818;
    Rng rng(seed);
    const auto any = [&rng](int parts) {
        Matrix6 m = Matrix6::Zero();
        for (; parts > 0; --parts) {
            Eigen::Matrix<double, 6, 1> v = Eigen::Matrix<double, 6, 1>::Zero();
            for (int k = 0; k < 3; ++k) v(k) = uniform(rng, -1, 1);
            m += scale(rng, 0.1, 5) * v * v.transpose();
        }
        return m;
    };
    int rises = 0;
    for (int i = 0; i < 100; ++i) {
        HandBudget budget;
        double given = 0, paid = 0;
        for (int stretch = 0; stretch < 30; ++stretch) {
            SceneLoad load{.contacts = any(between(rng, 0, 4)), .effects = any(between(rng, 0, 2))};
            load.surfaces = between(rng, 0, 1);
            load.in_contacts.held = between(rng, 0, 3) * scale(rng, 1e-6, 1e-2);
            load.in_effects.held = between(rng, 0, 3) * scale(rng, 1e-6, 1e-2);
            const double spent = between(rng, 0, 2) * scale(rng, 1e-9, 1e-4);
            const double freed = (between(rng, 0, 5) == 0) * 1e-4;
            for (int cycle = between(rng, 1, 60); cycle > 0; --cycle) {
                load.in_contacts.freed = cycle == 1 ? freed : 0;
                const HandScales before = budget.scales();
                const Matrix6 felt = before.contacts * load.contacts + before.effects * load.effects;
                paid += before.contacts * load.in_contacts.freed +
                        HandBudget::spent_share * std::max(0.0, 1 - largest(felt)) * spent;
                budget.advance(load, spent, dt);
                const HandScales& after = budget.scales();
                given += std::max(0.0, after.contacts - before.contacts) * load.in_contacts.held +
                         std::max(0.0, after.effects - before.effects) * load.in_effects.held;
                rises += after.contacts > before.contacts && load.in_contacts.held > 0;
                ASSERT_LE(given,
                          paid * (1 + 1e-9) + 1e-9 * load.in_contacts.held + 1e-9 * load.in_effects.held)
                    << "seed " << seed << " case " << i;
            }
        }
    }
    EXPECT_GT(rises, 1000) << "it is not that nothing rises";
}

// Where no surface holds a scale rises as fast as allowed.
TEST(HandBudget, WhatIsNotTouchedIsWholeAgainForNothing) {
    HandBudget budget;
    SceneLoad load;
    load.contacts(2, 2) = 4;
    budget.advance(load, 0, infinity);
    EXPECT_DOUBLE_EQ(budget.scales().contacts, 0.25);
    load.contacts(2, 2) = 1;
    load.in_contacts.held = 1e-3;
    for (int cycle = 0; cycle < 1000; ++cycle) budget.advance(load, 0, dt);
    EXPECT_DOUBLE_EQ(budget.scales().contacts, 0.25) << "one that holds the hand stays as it is";
    load.in_contacts.held = 0;
    budget.advance(load, 0, dt);
    EXPECT_DOUBLE_EQ(budget.scales().contacts, 0.25 * (1 + dt / HandBudget::rise_time));
}

// Against power iteration in long double.
TEST(HandBudget, FindsTheLargestEigenvalueOfAnySum) {
    const std::uint64_t seed = 815;
    Rng rng(seed);
    using Real6 = Eigen::Matrix<long double, 6, 6>;
    for (int i = 0; i < 2000; ++i) {
        Matrix6 m = Matrix6::Zero();
        const int size = between(rng, 0, 1) ? 3 : 6;
        for (int part = between(rng, 1, 8); part > 0; --part) {
            Eigen::Matrix<double, 6, 1> v = Eigen::Matrix<double, 6, 1>::Zero();
            for (int k = 0; k < size; ++k) v(k) = uniform(rng, -1, 1);
            m += uniform(rng, 0, 2) * v * v.transpose();
        }
        Real6 power = m.cast<long double>();
        long double norm = 1, value = 0;
        for (int square = 0; square < 60; ++square) {
            norm = power.norm();
            power = (power / norm) * (power / norm);
        }
        const Eigen::Matrix<long double, 6, 1> top = power.col([&] {
            Eigen::Index best;
            power.diagonal().maxCoeff(&best);
            return best;
        }());
        value = top.dot(m.cast<long double>() * top) / top.squaredNorm();
        ASSERT_NEAR(largest_eigenvalue_above_1(m), static_cast<double>(std::max(1.0L, value)), 1e-9)
            << "seed " << seed << " case " << i;
    }
}

}  // namespace hand_budget_tests
