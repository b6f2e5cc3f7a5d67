// knurl_bench_scaling [--quick] [--seed N] [--json FILE] [AXIS ...]: how the servo's cycle grows with its
// load: the law of each axis, compared with the design; and the cost of observing it.
//   axes: clients readers representations scenes devices updates servo_rates watching
// scripts/plot_scaling.py draws the file.

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <stdexcept>

#include <knurl/json/json.hpp>
#include <knurl/measure/output_file.hpp>

#include "goals.hpp"
#include "lab.hpp"

namespace {

using namespace knurl;
using namespace knurl::servo::scaling;
using knurl::Json;

const struct {
    const char* name;
    std::vector<Series> (*measure)(Lab&);
} axes[] = {{"clients", clients},        {"readers", readers}, {"representations", representations},
            {"scenes", scenes},          {"devices", devices}, {"updates", updates},
            {"servo_rates", servo_rates}};
constexpr const char* watching_axis = "watching";

struct Asked {
    Options options;
    std::string json;
    std::vector<std::string> axes;
    bool wants(const char* axis) const {
        return axes.empty() || std::find(axes.begin(), axes.end(), axis) != axes.end();
    }
};

Asked asked(int argc, char** argv) {
    Asked a;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&] {
            if (++i == argc) throw std::invalid_argument(word + ": its value is missing");
            return std::string(argv[i]);
        };
        if (word == "--quick") {
            a.options.quick = true;
            a.options.blocks = 3;
        } else if (word == "--seed") {
            const std::string text = value();
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), a.options.seed);
            if (error != std::errc() || end != text.data() + text.size())
                throw std::invalid_argument("--seed " + text + ": give a whole number");
        } else if (word == "--json") {
            a.json = value();
        } else if (word == watching_axis || std::any_of(std::begin(axes), std::end(axes),
                                                        [&](auto& axis) { return word == axis.name; })) {
            a.axes.push_back(word);
        } else {
            throw std::invalid_argument(
                "'" + word +
                "' is neither --quick, --seed N, --json FILE nor one of clients, readers, "
                "representations, scenes, devices, updates, servo_rates, watching");
        }
    }
    return a;
}

struct Found {
    Series series;
    measure::Fitted fitted;
    measure::Design verdict;
};

Found law_of(Series series) {
    std::vector<measure::Point> points;
    for (const Point& point : series.points)
        if (point.n > 0) points.push_back({point.n, point.middles});
    const measure::Fitted fitted = measure::fit(points);
    const measure::Design verdict = measure::judge(fitted, series.design);
    return {std::move(series), fitted, verdict};
}

/// Median of the blocks' values, and their quartiles.
struct Spread {
    double p25, p50, p75;
    explicit Spread(std::vector<double> middles) {
        std::sort(middles.begin(), middles.end());
        const auto at = [&](double q) {
            return middles[static_cast<std::size_t>(q * static_cast<double>(middles.size()))];
        };
        p25 = at(0.25);
        p50 = at(0.5);
        p75 = at(0.75);
    }
};

void print(const Found& found) {
    const Series& series = found.series;
    const Spread first(series.points.front().middles), last(series.points.back().middles);
    std::printf("  %-28s %8.0f ns at %g, %8.0f ns at %g   %s\n", series.name.c_str(), first.p50,
                series.points.front().n, last.p50, series.points.back().n,
                measure::text_of(found.fitted).c_str());
    std::printf(
        "  %-28s by design at most %s, since %s: %s (farthest point %.0f %% off, the same law in %.0f %% of "
        "the drawings)\n",
        "", measure::name_of(series.design), series.why.c_str(), measure::name_of(found.verdict),
        100 * found.fitted.off, 100 * found.fitted.agreed);
}

Json interval(const std::optional<measure::Interval>& known) {
    return known ? Json{known->low, known->high} : Json();
}

Json to_json(const Found& found) {
    const auto& [series, fitted, verdict] = found;
    Json points = Json::array();
    for (const Point& point : series.points) {
        const Spread spread(point.middles);
        points.push_back({{"n", point.n}, {"p25", spread.p25}, {"p50", spread.p50}, {"p75", spread.p75}});
    }
    return {{"name", series.name},
            {"axis", series.axis},
            {"unit", "ns"},
            {"points", points},
            {"law",
             {{"growth", measure::name_of(fitted.law.growth)},
              {"text", measure::text_of(fitted)},
              {"base", fitted.law.base},
              {"base_interval", interval(fitted.base_interval)},
              {"factor", fitted.law.factor},
              {"factor_interval", interval(fitted.factor_interval)},
              {"exponent", fitted.exponent},
              {"exponent_interval", interval(fitted.exponent_interval)},
              {"rise", fitted.rise},
              {"rise_interval", interval(fitted.rise_interval)},
              {"off", fitted.off},
              {"agreed", fitted.agreed}}},
            {"design", measure::name_of(series.design)},
            {"why", series.why},
            {"verdict", measure::name_of(verdict)}};
}

/// In the form of all benchmarks: the last point of each series beside its first, with the blocks for a
/// comparison.
Json results_of(const std::vector<Found>& all) {
    Json results = Json::array();
    for (const Found& found : all) {
        const Series& series = found.series;
        const auto name = [&](const Point& point) {
            return series.name + "/" + std::to_string(static_cast<long>(point.n));
        };
        const Point &first = series.points.front(), &last = series.points.back();
        for (const Point* point : {&first, &last}) {
            const measure::Histogram every = measure::merged(point->blocks);
            const auto p99 = every.percentile(0.99);
            const double p50 = Spread(point->middles).p50;
            results.push_back({{"name", name(*point)},
                               {"unit", "ns"},
                               {"n", every.count()},
                               {"p50", p50},
                               {"p99", p99 ? Json(*p99) : Json()},
                               {"p999", nullptr},
                               {"max", every.max()},
                               {"reference", point == &last ? Json(name(first)) : Json()},
                               {"ratio", point == &last ? Json(p50 / Spread(first.middles).p50) : Json()},
                               {"samples", point->middles}});
        }
    }
    return results;
}

Json to_json(const Judged& judged) {
    return {{"name", judged.goal.name},
            {"unit", judged.goal.unit},
            {"limit", judged.goal.limit},
            {"value", judged.value ? Json(*judged.value) : Json()},
            {"interval", interval(judged.interval)},
            {"verdict", measure::name_of(judged.verdict)}};
}

void print(const Judged& judged) {
    const int digits = judged.goal.unit == "ns" ? 0 : 2;
    std::printf("  %-56s at most %5.0f %s: ", judged.goal.name.c_str(), judged.goal.limit,
                judged.goal.unit.c_str());
    if (judged.value)
        std::printf("%.*f", digits, *judged.value);
    else
        std::printf("too few samples");
    if (judged.interval)
        std::printf(" [%.*f, %.*f]", digits, judged.interval->low, digits, judged.interval->high);
    std::printf(", %s\n", measure::name_of(judged.verdict));
}

}  // namespace

int main(int argc, char** argv) try {
    const Asked wanted = asked(argc, argv);
    if (!wanted.json.empty()) measure::require_writable(wanted.json);
    const measure::Run run{.machine = measure::this_machine(), .results = {}};
    const measure::Machine& m = run.machine;
    Lab lab(wanted.options);
    std::printf(
        "%s, %u CPUs, Linux %s, load %s\n%s, %s\n%d blocks by turns, seed %llu; processor time; one cycle "
        "timed by itself has the clock's %.0f ns in it\n",
        m.processor.c_str(), m.cpus, m.kernel.c_str(), m.load.c_str(), m.build.c_str(), m.date.c_str(),
        lab.blocks(), static_cast<unsigned long long>(wanted.options.seed), lab.clock_pair());
    std::vector<Found> all;
    std::vector<Judged> goals;
    for (const auto& axis : axes) {
        if (!wanted.wants(axis.name)) continue;
        std::printf("\n%s\n", axis.name);
        std::fflush(stdout);
        const std::vector<Series> measured = axis.measure(lab);
        for (Judged& one : judge_goals(measured)) goals.push_back(std::move(one));
        for (const Series& series : measured) {
            all.push_back(law_of(series));
            // What the sample keeps alive is large and no longer needed.
            for (Point& point : all.back().series.points) point.sample = nullptr;
            print(all.back());
        }
    }
    if (wanted.wants(watching_axis))
        for (Judged& one : watching(lab)) goals.push_back(std::move(one));
    if (!goals.empty()) std::printf("\ngoals\n");
    for (const Judged& one : goals) print(one);
    if (wanted.json.empty()) return 0;

    Json json = Json::parse(measure::to_json(run));
    json["results"] = results_of(all);
    json["scaling"] = {{"seed", wanted.options.seed},
                       {"blocks", lab.blocks()},
                       {"clock_pair", lab.clock_pair()},
                       {"series", Json::array()},
                       {"goals", Json::array()}};
    for (const Found& found : all) json["scaling"]["series"].push_back(to_json(found));
    for (const Judged& one : goals) json["scaling"]["goals"].push_back(to_json(one));
    measure::write_file(wanted.json, json.dump(1) + "\n");
    return 0;
} catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "knurl_bench_scaling: %s\n", error.what());
    return 2;
} catch (const std::exception& error) {
    std::fprintf(stderr, "knurl_bench_scaling: %s\n", error.what());
    return 1;
}
