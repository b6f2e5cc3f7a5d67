// The bound on the force, on a model: an atom in a thick liquid whose friction heats all atoms, and a bath.

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "heat.hpp"

namespace {

struct Outcome {
    double hottest = 0;  // K
    double pull = 0;     // kcal/mol/A, mean
};

/// Pulled as hard as may be for 200 frames, at 30 kcal/mol/A at most; from the hundredth on each has `later`
/// steps instead of `steps`.
Outcome pulled(int steps, int later, bool bounded) {
    constexpr double mobility = 4e-4;  // A a step for 1 kcal/mol/A: water's oxygen
    constexpr double k = 0.0019872;
    constexpr std::size_t atoms = 648;
    dock::HeatBound bound(450);
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

TEST(DockHeat, IsBoundedAtEveryFrameRateAndThroughAChangeOfIt) {
    for (const int steps : {5, 50, 500, 4000})
        for (const int later : {steps, 4 * steps, steps / 4 + 1}) {
            SCOPED_TRACE(std::to_string(steps) + " steps in a frame, then " + std::to_string(later));
            const Outcome outcome = pulled(steps, later, true);
            EXPECT_LE(outcome.hottest, 450.001);
            EXPECT_GT(outcome.pull, 3) << "kcal/mol/A: the hand can do something all the same";
        }
}

TEST(DockHeat, WithoutTheBoundItWouldBurn) {
    // What the test above is worth.
    for (const int steps : {50, 500, 4000}) EXPECT_GT(pulled(steps, steps, false).hottest, 600) << steps;
}

}  // namespace
