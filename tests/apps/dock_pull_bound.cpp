// Tests the bounds on the force with models: an atom in a viscous liquid, whose friction heats all atoms,
// and a heat bath.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "pull_bound.hpp"

namespace dock_pull_bound_tests {
namespace {

struct Outcome {
    double hottest = 0;  // K
    double pull = 0;     // kcal/mol/A, mean
};

/// Pulls as hard as allowed for 200 frames, at most with 30 kcal/mol/A. From the hundredth frame on, a frame
/// has `later` steps instead of `steps`.
Outcome pulled(int steps, int later, bool bounded) {
    constexpr double mobility = 4e-4;  // A a step for 1 kcal/mol/A: water's oxygen
    constexpr double k = 0.0019872;
    constexpr std::size_t atoms = 648;
    dock::PullBound bound(450);
    bound.hold();
    Outcome outcome;
    double temperature = 300, sent = 0, way = 0, squares = 0, force_way = 0;
    for (int i = 0; i < 200; ++i) {
        const int now = i < 100 ? steps : later;
        const double acting = sent;
        const double most = bound.force(
            {.temperature = temperature, .atoms = atoms, .steps = now, .way = way, .pushed = acting});
        sent = std::min(30.0, bounded ? most : std::numeric_limits<double>::infinity());
        const double moved = mobility * now * acting;
        temperature += acting * moved / (1.5 * k * atoms);
        outcome.hottest = std::max(outcome.hottest, temperature);
        temperature = 300 + (temperature - 300) * std::exp(-now / 2000.0);
        squares = 0.97 * squares + acting * acting;
        force_way = 0.97 * force_way + acting * moved;
        if (squares > 0) way = force_way / squares;
        outcome.pull += sent / 200;
    }
    return outcome;
}

TEST(DockPullBound, HeatIsBoundedAtEveryFrameRateAndThroughAChangeOfIt) {
    for (const int steps : {5, 50, 500, 4000})
        for (const int later : {steps, 4 * steps, steps / 4 + 1}) {
            SCOPED_TRACE(std::to_string(steps) + " steps in a frame, then " + std::to_string(later));
            const Outcome outcome = pulled(steps, later, true);
            EXPECT_LE(outcome.hottest, 450.001);
            EXPECT_GT(outcome.pull, 3) << "kcal/mol/A: the hand can do something all the same";
        }
}

TEST(DockPullBound, WithoutTheBoundItWouldBurn) {
    // Shows that the test above can fail.
    for (const int steps : {50, 500, 4000}) EXPECT_GT(pulled(steps, steps, false).hottest, 600) << steps;
}

/// The largest error (A) of a place that is sent modulo its box, as by GROMACS, with thermal motion, and
/// unwrapped as in `knurl-dock`.
double farthest_from_the_truth(int steps, unsigned seed, bool bounded) {
    constexpr double mobility = 7e-4, box = 18.6;  // A a step for 1 kcal/mol/A; A
    constexpr std::size_t atoms = 648;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    dock::PullBound bound(450, box);
    bound.hold();
    double truth = 0, told = 0, sent = 0, way = 0, squares = 0, force_way = 0, farthest = 0;
    for (int i = 0; i < 300; ++i) {
        const double acting = sent;
        const double most =
            bound.force({.temperature = 300, .atoms = atoms, .steps = steps, .way = way, .pushed = acting});
        // Back and forth, as hard as allowed, 20 frames each.
        sent = (i / 20 % 2 ? -1 : 1) * std::min(5.0, bounded ? most : 5.0);
        const double moved = mobility * steps * acting + std::sqrt(8.6e-4 * steps) * normal(random);
        truth += moved;
        const double place = truth - box * std::floor(truth / box);
        const double went = place - told - box * std::round((place - told) / box);
        told += went;
        squares = 0.97 * squares + acting * acting;
        force_way = 0.97 * force_way + acting * went;
        if (squares > 0) way = std::max(0.0, force_way / squares);
        farthest = std::max(farthest, std::abs(truth - told));
    }
    return farthest;
}

TEST(DockPullBound, AnAtomGoesNoFartherInAFrameThanItsBoxLetsOneTell) {
    for (const int steps : {5, 50, 500, 2300})
        for (const unsigned seed : {1u, 2u, 3u}) {
            SCOPED_TRACE(std::to_string(steps) + " steps in a frame, seed " + std::to_string(seed));
            EXPECT_LT(farthest_from_the_truth(steps, seed, true), 1e-9) << "A";
        }
    EXPECT_GT(farthest_from_the_truth(2300, 1, false), 18) << "A: without the bound it is lost";
}

TEST(DockPullBound, ASimulationThatTellsNoTemperatureIsBoundedByItsBoxAlone) {
    dock::PullBound bound(450, 18.6), nowhere(450);
    const dock::PullBound::Frame frame{.temperature = std::nan(""), .atoms = 648, .steps = 100, .way = 0.1};
    EXPECT_NEAR(bound.force(frame), 0.2 * 18.6 / 1, 1e-12) << "nothing is known of the atom yet";
    for (int i = 0; i < 10; ++i) bound.force(frame);
    EXPECT_NEAR(bound.force(frame), 0.2 * 18.6 / 0.1, 1e-12);
    EXPECT_EQ(nowhere.force(frame), std::numeric_limits<double>::infinity());
}

}  // namespace

}  // namespace dock_pull_bound_tests
