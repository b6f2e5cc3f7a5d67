#include "doctor_verdict.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <knurl/measure/measure.hpp>

namespace knurl::cli {

namespace {

constexpr double good_share = 0.999, usable_share = 0.99;
constexpr Nanoseconds lets_go_after = 20'000'000;  // after a longer delay a servo starts again without force

/// Compares the servo with an empty loop on the same CPU: if that is late too, the machine is the cause. Late
/// cycles come in bursts. So the scatter of the stretches of both loops decides whether one has more, not the
/// totals.
const char* whose(const LoopFigures& servo, const LoopFigures& bare) {
    if (bare.on_time < good_share) return "it is the machine";
    const auto share = [](const LoopFigures& loop, std::span<const std::size_t> drawn) {
        double late = 0, cycles = 0;
        for (const std::size_t block : drawn) {
            late += loop.late_of_block[block];
            cycles += static_cast<double>(loop.blocks[block].count());
        }
        return cycles > 0 ? late / cycles : 0;
    };
    const auto more = measure::bootstrap(servo.blocks.size(), bare.blocks.size(),
                                         [&](std::span<const std::size_t> a, std::span<const std::size_t> b) {
                                             return std::optional(share(servo, a) - share(bare, b));
                                         },
                                         {.confidence = 0.99});
    return more && more->low > 0
               ? "it is the servo"
               : "too few to say whether it is the machine or the servo; measure longer (--seconds)";
}

/// Divides into stretches with equal numbers of cycles, slightly more than the bootstrap needs.
void divide(LoopFigures& result, const Beginnings& beginnings, Nanoseconds half) {
    constexpr std::size_t blocks = 45;  // each of the doctor's three turns has fifteen
    const std::size_t n = beginnings.late.size();
    if (n < blocks) return;
    result.blocks.resize(blocks);
    result.late_of_block.resize(blocks);
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t block = i * blocks / n;
        result.blocks[block].record(static_cast<double>(beginnings.late[i]) * 1e-3);
        result.late_of_block[block] += beginnings.late[i] < half ? 0 : 1;
    }
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
    divide(result, beginnings, half);
    return result;
}

RateVerdict judge(double rate, const LoopFigures& servo, const LoopFigures& bare, bool real_time) {
    RateVerdict verdict{.rate = rate,
                        .fitness = Fitness::unfit,
                        .reason = {},
                        .servo = servo,
                        .bare = bare,
                        .lateness = measure::compare({.blocks = bare.blocks, .reference = {}},
                                                     {.blocks = servo.blocks, .reference = {}}, 0.5)};
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
