#include "doctor_verdict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "measure.hpp"

namespace knurl::cli {

namespace {

constexpr double good_share = 0.999, usable_share = 0.99;
constexpr Nanoseconds lets_go_after = 20'000'000;  // a servo that was late by more begins again from no force

/// Of two loops on one CPU, one with nothing in it: if that is late too, nothing in Knurl can help. Counts of
/// rare events scatter by their root; what differs by less than three of that may be chance.
const char* whose(const LoopFigures& servo, const LoopFigures& bare) {
    const auto late = [](const LoopFigures& f) { return (1 - f.on_time) * static_cast<double>(f.cycles); };
    if (bare.on_time < good_share) return "it is the machine";
    const bool more = late(servo) - late(bare) > 3 * std::sqrt(late(servo) + late(bare));
    return more ? "it is the servo"
                : "too few to say whether it is the machine or the servo; measure longer (--seconds)";
}

}  // namespace

const char* name_of(Fitness fitness) {
    switch (fitness) {
        case Fitness::good:
            return "good";
        case Fitness::usable:
            return "usable";
        case Fitness::unfit:
            break;
    }
    return "unfit";
}

LoopFigures figures(Beginnings beginnings, const std::vector<Gap>& gaps, double rate) {
    LoopFigures result;
    result.stalls = take_out_stalls(beginnings, gaps);
    result.cycles = beginnings.late.size();
    if (result.cycles == 0) return result;
    const auto half = static_cast<Nanoseconds>(0.5e9 / rate);
    const auto in_time = std::count_if(beginnings.late.begin(), beginnings.late.end(),
                                       [half](Nanoseconds late) { return late < half; });
    result.on_time = static_cast<double>(in_time) / static_cast<double>(result.cycles);
    std::vector<double> late;  // us
    for (const Nanoseconds ns : beginnings.late) late.push_back(static_cast<double>(ns) * 1e-3);
    const measure::Result spread = measure::summarise("late", "us", std::move(late));
    result.p50 = spread.p50;
    result.p99 = spread.p99;
    result.p999 = spread.p999;
    result.max = spread.max;
    return result;
}

RateVerdict judge(double rate, const LoopFigures& servo, const LoopFigures& bare, bool real_time) {
    RateVerdict verdict{.rate = rate, .fitness = Fitness::unfit, .reason = {}, .servo = servo, .bare = bare};
    if (servo.cycles == 0) {
        verdict.reason = "the servo reported no cycle";
        return verdict;
    }
    const bool held = servo.stalls.longest > lets_go_after;
    if (servo.on_time >= good_share && real_time && !held)
        verdict.fitness = Fitness::good;
    else if (servo.on_time >= usable_share)
        verdict.fitness = Fitness::usable;

    verdict.reason = fmt::format("{:.2f} % of cycles on time", servo.on_time * 100);
    if (servo.on_time < good_share)
        verdict.reason +=
            fmt::format(", {:.2f} % of a bare loop's: {}", bare.on_time * 100, whose(servo, bare));
    if (!real_time) verdict.reason += "; without real-time priority any program may hold it up";
    if (held)
        verdict.reason += fmt::format("; the machine stood still for {:.0f} ms: forces fade out and in",
                                      static_cast<double>(servo.stalls.longest) * 1e-6);
    return verdict;
}

}  // namespace knurl::cli
