// knurl_bench_error: run time against error of every implementation at hand, with the one that Knurl uses
// marked.
//   knurl_bench_error [--json FILE] [PANEL ...]       panels: planes curved surfaces friction springs
// scripts/plot_error.py draws the file.

#include <cstdio>
#include <cstring>
#include <iostream>

#include <knurl/json/json.hpp>
#include <knurl/measure/output_file.hpp>

#include "panel.hpp"

using namespace knurl;
using namespace knurl::error;

namespace {

/// A point of the same scene with no larger error, and faster by more than the measurement's noise.
bool beats(const Panel& panel, const Point& a, const Point& b) {
    const double ea = std::max(a.error, panel.exact), eb = std::max(b.error, panel.exact);
    return a.scene == b.scene && !a.knurl && a.flaw.empty() &&
           ((ea <= eb && a.ns < 0.9 * b.ns) || (ea < 0.9 * eb && a.ns <= b.ns));
}

void print(const Panel& panel) {
    std::printf("\n%s: error is the %s (%s); ns are the median of a call; * is Knurl's\n", panel.name.c_str(),
                panel.error_meaning.c_str(), panel.error_unit.c_str());
    std::string scene;
    for (const Point& point : panel.points) {
        if (point.scene != scene) std::printf("  %s\n", point.scene.c_str());
        scene = point.scene;
        std::printf("   %c %-34s %12.3g %-3s %12.1f ns  n %zu  %s\n", point.knurl ? '*' : ' ',
                    point.implementation.c_str(), point.error, panel.error_unit.c_str(), point.ns,
                    point.samples, point.flaw.c_str());
    }
    for (const Point& ours : panel.points) {
        if (!ours.knurl || ours.error > panel.useless) continue;
        for (const Point& other : panel.points) {
            if (beats(panel, other, ours))
                std::printf("  BETTER THAN KNURL'S in %s: %s (%.3g %s, %.1f ns) than %s (%.3g %s, %.1f ns)\n",
                            ours.scene.c_str(), other.implementation.c_str(), other.error,
                            panel.error_unit.c_str(), other.ns, ours.implementation.c_str(), ours.error,
                            panel.error_unit.c_str(), ours.ns);
        }
    }
}

knurl::Json to_json(const Panel& panel) {
    knurl::Json points = knurl::Json::array();
    for (const Point& p : panel.points)
        points.push_back({{"scene", p.scene},
                          {"size", p.size},
                          {"implementation", p.implementation},
                          {"knurl", p.knurl},
                          {"flaw", p.flaw},
                          {"error", p.error},
                          {"ns", p.ns},
                          {"n", p.samples}});
    return {{"name", panel.name},
            {"error_unit", panel.error_unit},
            {"error_meaning", panel.error_meaning},
            {"exact", panel.exact},
            {"points", points}};
}

}  // namespace

int main(int argc, char** argv) {
    const struct {
        const char* name;
        Panel (*run)(const measure::Stopwatch&);
    } all[] = {{"planes", planes},
               {"curved", curved},
               {"surfaces", surfaces},
               {"friction", friction},
               {"springs", springs}};

    const char* file = nullptr;
    std::vector<std::string> wanted;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--json") == 0 && i + 1 < argc) {
            file = argv[++i];
            continue;
        }
        wanted.push_back(argv[i]);
        if (std::none_of(std::begin(all), std::end(all),
                         [&](const auto& panel) { return wanted.back() == panel.name; })) {
            std::fprintf(stderr,
                         "knurl_bench_error: '%s' is neither --json FILE nor one of planes, curved, "
                         "surfaces, friction, springs\n",
                         argv[i]);
            return 2;
        }
    }

    measure::Run run{.machine = measure::this_machine(), .results = {}};
    const measure::Machine& m = run.machine;
    std::printf("%s, %u CPUs, Linux %s, load %s\n%s, %s\n", m.processor.c_str(), m.cpus, m.kernel.c_str(),
                m.load.c_str(), m.build.c_str(), m.date.c_str());
    const measure::Stopwatch watch;
    knurl::Json json = knurl::Json::parse(measure::to_json(run));
    json["panels"] = knurl::Json::array();
    for (const auto& panel : all) {
        if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), panel.name) == wanted.end()) continue;
        const Panel result = panel.run(watch);
        print(result);
        std::fflush(stdout);
        json["panels"].push_back(to_json(result));
    }
    if (file) {
        try {
            measure::write_file(file, json.dump(1) + '\n');
        } catch (const std::exception& error) {
            std::fprintf(stderr, "knurl_bench_error: %s\n", error.what());
            return 1;
        }
    }
    return 0;
}
