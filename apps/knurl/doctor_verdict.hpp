#pragma once
// From how late cycles begin to what a person asks: may I run a hand at this rate on this machine?

#include <optional>
#include <string>
#include <vector>

#include <knurl/measure/compare.hpp>

#include "doctor_loop.hpp"

namespace knurl::cli {

/// A loop that began late by less than half of its period is on time: the force then rests on a position that
/// is at most half of a period older than it should be, which the bound b / (T/2 + tau) leaves room for.
struct LoopFigures {
    std::size_t cycles = 0;                // of which standstills of the machine are taken out
    double on_time = 0;                    // share, 0 to 1
    std::optional<double> p50, p99, p999;  // us late; each has ten cycles above it, or is left out
    double max = 0;                        // us late
    Stalls stalls;
    std::vector<measure::Histogram> blocks;  // us late, of stretches one after another
    std::vector<double> late_of_block;       // cycles of each that were not on time
};
/// `beginnings` in the order in which they were seen, in some turns.
LoopFigures figures(Beginnings beginnings, const std::vector<Gap>& gaps, double rate);

enum class Fitness { good, usable, unfit };
const char* name_of(Fitness fitness);

struct RateVerdict {
    double rate = 0;  // Hz
    Fitness fitness = Fitness::unfit;
    std::string reason;
    LoopFigures servo, bare;
    measure::Comparison lateness;  // of the medians, the servo's to the bare loop's
};

/// good: at least 99.9 % of the servo's cycles on time, in real time. usable: 99 %. A machine that stands
/// still for longer than the 20 ms after which a servo lets go is usable at best.
RateVerdict judge(double rate, const LoopFigures& servo, const LoopFigures& bare, bool real_time);

}  // namespace knurl::cli
