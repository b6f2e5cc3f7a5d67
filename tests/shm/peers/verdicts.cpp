#include "verdicts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace knurl::shm::peers {

namespace {

using measure::Blocks, measure::Comparison, measure::Verdict;

constexpr double false_alarms = 0.05;              // of all comparisons together, where nothing differs
constexpr double blocked_client = 1.2;             // of the floor
constexpr double servo_median = 1, servo_p99 = 3;  // us

template <class... Values>
std::string text(const char* format, Values... values) {
    char line[400];
    std::snprintf(line, sizeof line, format, values...);
    return line;
}

const Seen& named(const std::vector<Seen>& all, const char* name) {
    const auto found = std::ranges::find(all, name, &Seen::name);
    if (found == all.end()) throw std::runtime_error(std::string("there is no ") + name);
    return *found;
}

Comparison against(const Seen& a, const Seen& b, Blocks Seen::*what, double q, double confidence) {
    return measure::compare({.blocks = (a.*what).all(), .reference = {}},
                            {.blocks = (b.*what).all(), .reference = {}}, q, {.confidence = confidence});
}

/// On which side of the bound an interval lies.
const char* kept(const measure::Interval& interval, double bound) {
    return interval.high <= bound ? "kept" : interval.low > bound ? "not kept" : "undecided";
}

void add_goal(Verdicts& all, const std::string& what, double bound, const measure::Interval& interval,
              const std::string& problem) {
    if (!problem.empty()) {
        all.text += text("%s: nothing to say: %s\n", what.c_str(), problem.c_str());
        return;
    }
    all.text += text("%s: %.2f to %.2f, bound %g: %s\n", what.c_str(), interval.low, interval.high, bound,
                     kept(interval, bound));
    all.json["goals"].push_back({{"what", what},
                                 {"bound", bound},
                                 {"low", interval.low},
                                 {"high", interval.high},
                                 {"verdict", kept(interval, bound)}});
}

void judge_cost(Verdicts& all, const Seen& knurl, double q, double bound) {
    const auto percentile = [&](std::span<const std::size_t> drawn, std::span<const std::size_t>) {
        measure::Histogram merged;
        for (const std::size_t block : drawn) merged.merge(knurl.pays.all()[block]);
        return merged.percentile(q);
    };
    const std::size_t blocks = knurl.pays.all().size();
    const auto interval = measure::bootstrap(blocks, blocks, percentile, {.resamples = 300});
    add_goal(all, text("%s: p%g of what a message costs the servo, us", knurl.name.c_str(), 100 * q), bound,
             interval.value_or(measure::Interval{}), interval ? "" : "too few blocks or samples");
}

std::string column(std::optional<double> value) {
    return value ? text(*value < 100 ? "%.2f" : "%.0f", *value) : "-";
}

}  // namespace

Verdicts judge(const std::vector<Seen>& all) {
    const Seen &floor = all.front(), &knurl = named(all, "Knurl");
    Verdicts made{.text = {}, .json = {{"verdicts", knurl::Json::array()}, {"goals", knurl::Json::array()}}};
    const double confidence = 1 - false_alarms / (2 * static_cast<double>(all.size() - 1));
    for (const Seen& other : all) {
        if (&other == &knurl) continue;
        for (const double q : {0.5, 0.99}) {
            const Comparison found = against(knurl, other, &Seen::has_it, q, confidence);
            if (!found.problem.empty()) {
                made.text +=
                    text("%s, p%g: nothing to say: %s\n", other.name.c_str(), 100 * q, found.problem.c_str());
                continue;
            }
            const char* const verdict = found.verdict == Verdict::better  ? "faster than Knurl"
                                        : found.verdict == Verdict::worse ? "slower than Knurl"
                                                                          : "undecided";
            made.text += text("%s, p%g: %.2f times Knurl's (%.2f to %.2f): %s\n", other.name.c_str(), 100 * q,
                              found.ratio, found.interval.low, found.interval.high, verdict);
            made.json["verdicts"].push_back({{"transport", other.name},
                                             {"percentile", 100 * q},
                                             {"to_knurl", found.ratio},
                                             {"low", found.interval.low},
                                             {"high", found.interval.high},
                                             {"verdict", verdict}});
        }
    }
    made.text += "\n";
    const Comparison blocked = against(floor, knurl, &Seen::has_it, 0.5, 0.99);
    add_goal(made, "a blocked client has it, medians, times the bare wake-up", blocked_client,
             blocked.interval, blocked.problem);
    for (const char* const name : {"Knurl", "Knurl, waker"}) {
        judge_cost(made, named(all, name), 0.5, servo_median);
        judge_cost(made, named(all, name), 0.99, servo_p99);
    }
    return made;
}

std::string table(const std::vector<Seen>& all) {
    std::string made =
        text("%-22s %7s %9s | %-35s | %-15s | %7s\n%-22s %7s %9s | %7s %7s %6s %6s %6s | %7s %7s | %7s\n", "",
             "", "", "client has it, us", "send call, us", "CPU, us", "", "n", "overtaken", "p50", "p90",
             "p99", "p99.9", "max", "p50", "p99", "p50");
    for (const Seen& one : all) {
        const auto has_it = measure::merged(one.has_it.all()), pays = measure::merged(one.pays.all());
        made += text("%-22s %7zu %9zu | %7s %7s %6s %6s %6s | %7s %7s | %7s\n", one.name.c_str(), one.sent,
                     one.overtaken, column(has_it.percentile(0.5)).c_str(),
                     column(has_it.percentile(0.9)).c_str(), column(has_it.percentile(0.99)).c_str(),
                     column(has_it.percentile(0.999)).c_str(), column(has_it.max()).c_str(),
                     column(pays.percentile(0.5)).c_str(), column(pays.percentile(0.99)).c_str(),
                     column(measure::merged(one.cpu.all()).percentile(0.5)).c_str());
    }
    return made;
}

}  // namespace knurl::shm::peers
