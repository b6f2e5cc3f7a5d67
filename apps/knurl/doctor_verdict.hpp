#pragma once
// From the lateness of cycles to the user's question: can I run a hand at this rate on this machine?

#include <optional>
#include <string>
#include <vector>

#include <knurl/measure/compare.hpp>

#include "doctor_loop.hpp"

namespace knurl::cli {

/// A loop that began late by less than half of its period counts as on time. Its force then depends on a
/// position that is at most half a period too old, for which the bound b / (T/2 + tau) has room.
struct LoopFigures {
    std::size_t cycles = 0;                // without standstills of the machine
    double on_time = 0;                    // share, 0 to 1
    std::optional<double> p50, p99, p999;  // us late; left out if fewer than ten cycles are above it
    double max = 0;                        // us late
    Stalls stalls;
    std::vector<measure::Histogram> blocks;  // us late, of consecutive stretches
    std::vector<double> late_of_block;       // cycles of each that were late
};
/// `beginnings` in order of time, in several turns.
LoopFigures figures(Beginnings beginnings, const std::vector<Gap>& gaps, double rate);

enum class Fitness { good, usable, unfit };
const char* name_of(Fitness fitness);

struct RateVerdict {
    double rate = 0;  // Hz
    Fitness fitness = Fitness::unfit;
    std::string reason;
    LoopFigures servo, bare;
    measure::Comparison lateness;  // ratio of the medians, servo to bare loop
};

/// good: at least 99.9 % of the servo's cycles on time, with real-time priority. usable: 99 %. A machine with
/// standstills longer than the 20 ms after which a servo releases force is usable at best.
RateVerdict judge(double rate, const LoopFigures& servo, const LoopFigures& bare, bool real_time);

}  // namespace knurl::cli
