#pragma once
// The goals, judged from the measured points.

#include <optional>
#include <string>
#include <vector>

#include <knurl/measure/compare.hpp>

#include "lab.hpp"

namespace knurl::servo::scaling {

/// A percentile of some points' samples, minus the median of other points' in the same blocks.
struct Goal {
    std::string name;
    double limit = 0;  // ns
    std::string series = {}, beside = {};
    double n = 0, beside_n = 0;
    double q = 0.5;
    std::string unit = "ns";
};

struct Judged {
    Goal goal;
    std::optional<double> value;  // ns; none: too few samples
    std::optional<measure::Interval> interval;
    measure::Verdict verdict = measure::Verdict::undecided;  // better than the limit, or worse
};

std::vector<Judged> judge_goals(const std::vector<Series>& all);
/// By bootstrap over so many blocks.
Judged judge(const Goal& goal, std::size_t blocks, const measure::Statistic& statistic);

/// The cost per cycle of counters, flight recorder and a recording: no law, two goals.
std::vector<Judged> watching(Lab& lab);

}  // namespace knurl::servo::scaling
