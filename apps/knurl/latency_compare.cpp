#include "latency_compare.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/words/printable.hpp>

namespace knurl::cli {

namespace {

constexpr double share_of_false_alarms = 0.05;  // over all verdicts of a comparison

using measure::Result;

const Result* find(const measure::Run& run, const std::string& name) {
    const auto found = std::ranges::find(run.results, name, &Result::name);
    return found == run.results.end() ? nullptr : &*found;
}

/// With the reference of the same moments, if `with` is one.
measure::Measured measured(const measure::Run& run, const Result& result, bool with) {
    measure::Measured made{.blocks = result.blocks, .reference = {}};
    const Result* beside = with ? find(run, *result.reference) : nullptr;
    if (beside != nullptr) made.reference = beside->blocks;
    return made;
}

/// A word of a file, in which any character may stand.
std::string shown(const std::string& word) {
    constexpr std::size_t longest = 200;
    return words::printable(word, longest);
}

std::vector<std::string> warnings(const LatencyFile& before, const LatencyFile& now) {
    std::vector<std::string> all;
    const measure::Machine &old_machine = before.run.machine, &machine = now.run.machine;
    const auto differ = [&](const char* what, const std::string& was, const std::string& is) {
        if (was != is) all.push_back(fmt::format("{} was {}, is {}", what, shown(was), shown(is)));
    };
    differ("the machine's processor", old_machine.processor, machine.processor);
    differ("the number of CPUs", std::to_string(old_machine.cpus), std::to_string(machine.cpus));
    differ("the kernel", old_machine.kernel, machine.kernel);
    differ("what idle CPUs do", old_machine.idle, machine.idle);
    differ("the compiler", old_machine.build, machine.build);
    for (const char* key : {"servo", "rate", "priority", "real_time", "load"}) {
        const auto value = [key](const LatencyFile& file) {
            return file.setting.contains(key) ? file.setting.at(key).dump() : std::string("not known");
        };
        differ(fmt::format("`{}`", key).c_str(), value(before), value(now));
    }
    return all;
}

/// Results that show the machine only.
bool is_floor(const std::string& name) {
    return name.starts_with("floor.");
}

double middle_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::optional<double> percentile_of(const Result& result, double q) {
    return q == 0.5 ? result.p50 : result.p99;
}

/// How far the floors have moved at this percentile: the largest move, and the largest difference between
/// two.
struct FloorsMoved {
    double farthest = 0, apart = 0;  // of the logarithm
};
FloorsMoved floors_moved(const measure::Run& before, const measure::Run& now, double q) {
    std::vector<double> by;
    for (const Result& floor : now.results) {
        const Result* was = is_floor(floor.name) ? find(before, floor.name) : nullptr;
        if (was == nullptr) continue;
        const auto old_level = percentile_of(*was, q), level = percentile_of(floor, q);
        if (old_level && level && *old_level > 0 && *level > 0) by.push_back(std::log(*level / *old_level));
    }
    if (by.empty()) return {};
    const auto [least, most] = std::ranges::minmax(by);
    return {.farthest = std::max(std::abs(least), std::abs(most)), .apart = most - least};
}

std::string number(const std::optional<double>& value) {
    return value ? fmt::format("{:.3g}", *value) : "-";
}

}  // namespace

LatencyFile read_latency_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error(
            fmt::format("{}: cannot be read: {}; give a file that knurl latency --json wrote", path,
                        std::strerror(errno)));
    return parse_latency_file({std::istreambuf_iterator<char>(file), {}}, path);
}

LatencyFile parse_latency_file(const std::string& text, const std::string& path) {
    const auto foreign = [&path](const std::string& why) {
        return std::runtime_error(fmt::format(
            "{}: is not what knurl latency --json writes ({}); measure with --json FILE, and give that file",
            path, words::printable(why, 200)));
    };
    knurl::Json all;
    try {
        all = knurl::Json::parse(text);
    } catch (const knurl::JsonError& error) {
        throw foreign(error.what());
    }
    const auto format = all.is_object() && all.contains("format") ? all["format"] : knurl::Json();
    if (!format.is_object() || format.value("program", knurl::Json()) != LatencyFile::program)
        throw foreign("it does not say so in \"format\"");
    const auto version = format.value("version", knurl::Json());
    if (version != LatencyFile::version)
        throw std::runtime_error(fmt::format(
            "{}: has version {} of the format, this program reads {}; measure again with this one", path,
            words::printable(version.dump(), 40), LatencyFile::version));
    try {
        LatencyFile read{.run = measure::from_json(text), .setting = {}};
        if (!all.contains("setting") || !all["setting"].is_object())
            throw std::runtime_error("it has no \"setting\"");
        read.setting = all["setting"];
        return read;
    } catch (const std::exception& error) {
        throw foreign(error.what());
    }
}

namespace {

/// Compares one percentile of all paths.
void compare_percentile(const LatencyFile& before, const LatencyFile& now, double q,
                        const measure::Bootstrap& how, LatencyComparison& all) {
    const FloorsMoved floors = floors_moved(before.run, now.run, q);
    (q == 0.5 ? all.moved : all.moved_tail) = std::exp(floors.farthest);
    std::vector<std::pair<measure::Measured, measure::Measured>> runs;
    std::vector<double> drifts;
    for (PathComparison& path : all.paths) {
        if (path.q != q) continue;
        const Result &was = *find(before.run, path.name), &is = *find(now.run, path.name);
        path.before = percentile_of(was, q);
        path.now = percentile_of(is, q);
        const bool beside = was.ratio && is.ratio && was.reference == is.reference;
        if (beside) path.reference = is.reference;
        const auto& [old_run, new_run] =
            runs.emplace_back(measured(before.run, was, beside), measured(now.run, is, beside));
        for (const measure::Measured* run : {&old_run, &new_run})
            if (const auto found = measure::drift(*run, q, how)) drifts.push_back(*found);
    }
    auto pair = runs.begin();
    for (PathComparison& path : all.paths) {
        if (path.q != q) continue;
        // A floor shows the machine: how far it moved, without a verdict.
        const double moved = is_floor(path.name) ? 0 : path.reference ? floors.apart : floors.farthest;
        path.result = measure::compare_apart(pair->first, pair->second, q,
                                             {.drift = middle_of(drifts), .moved = moved}, how);
        if (is_floor(path.name)) path.result.verdict = measure::Verdict::undecided;
        ++pair;
    }
}

}  // namespace

LatencyComparison compare_runs(const LatencyFile& before, const LatencyFile& now) {
    LatencyComparison all{.date = before.run.machine.date, .warnings = warnings(before, now), .paths = {}};
    for (const Result& result : now.run.results) {
        // That result is 0, unless something is broken.
        if (find(before.run, result.name) == nullptr || result.name == "update.cycles_overlooked") continue;
        for (const double q : {0.5, 0.99}) {
            PathComparison& path = all.paths.emplace_back();
            path.name = result.name;
            path.q = q;
        }
    }
    all.confidence =
        1 - share_of_false_alarms / static_cast<double>(std::max<std::size_t>(1, all.paths.size()));
    const measure::Bootstrap how{.confidence = all.confidence};
    for (const double q : {0.5, 0.99}) compare_percentile(before, now, q, how, all);
    return all;
}

std::string to_text(const LatencyComparison& comparison) {
    std::string text = fmt::format(
        "\ncompared with the run of {}. Each verdict holds at {:.2f} %: of twenty pairs of equal runs on a "
        "steady machine at most one has any. The machine's floors moved by up to {:.2f} at the median, "
        "{:.2f} at 99 %. A difference that is no larger, or no larger than between the stretches of either "
        "run, may be the machine. Where the floors moved more than {:g} times there is no verdict:\n",
        shown(comparison.date), comparison.confidence * 100, comparison.moved, comparison.moved_tail,
        measure::most_moved);
    for (const std::string& warning : comparison.warnings)
        text += fmt::format("not alike: {}; this may cause the difference\n", warning);
    text += fmt::format("{:<34} {:>4} {:>8} {:>8}  {:<24} {}\n", "what", "", "was", "is", "new to old",
                        "verdict");
    for (const PathComparison& path : comparison.paths) {
        const measure::Comparison& r = path.result;
        text += fmt::format("{:<34} {:>4} {:>8} {:>8}  ", shown(path.name),
                            fmt::format("p{:g}", path.q * 100), number(path.before), number(path.now));
        if (!r.problem.empty())
            text += fmt::format("{:<24} undecided: {}\n", "-", r.problem);
        else
            text += fmt::format(
                "{:<24} {}{}\n",
                fmt::format("{:.2f} ({:.2f} to {:.2f})", r.ratio, r.interval.low, r.interval.high),
                is_floor(path.name) ? "the machine" : measure::name_of(r.verdict),
                path.reference ? ", beside " + shown(*path.reference) : "");
    }
    return text +
           "What has a floor is compared as a multiple of that floor's median; floor.* is the machine, and "
           "has no "
           "verdict.\n";
}

knurl::Json to_json(const LatencyComparison& comparison) {
    auto paths = knurl::Json::array();
    const auto or_null = [](const auto& value) { return value ? knurl::Json(*value) : knurl::Json(); };
    for (const PathComparison& path : comparison.paths) {
        const measure::Comparison& r = path.result;
        const bool known = r.problem.empty();
        paths.push_back({{"name", path.name},
                         {"percentile", path.q * 100},
                         {"before", or_null(path.before)},
                         {"now", or_null(path.now)},
                         {"reference", or_null(path.reference)},
                         {"ratio", known ? knurl::Json(r.ratio) : knurl::Json()},
                         {"low", known ? knurl::Json(r.interval.low) : knurl::Json()},
                         {"high", known ? knurl::Json(r.interval.high) : knurl::Json()},
                         {"verdict", measure::name_of(r.verdict)},
                         {"problem", known ? knurl::Json() : knurl::Json(r.problem)}});
    }
    return {{"date", comparison.date},
            {"confidence", comparison.confidence},
            {"floors_moved", {{"p50", comparison.moved}, {"p99", comparison.moved_tail}}},
            {"warnings", comparison.warnings},
            {"paths", paths}};
}

}  // namespace knurl::cli
