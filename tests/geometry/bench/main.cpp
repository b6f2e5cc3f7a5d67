// knurl_bench_geometry: run time and error of all methods to render one relief of 1 000 to 1 000 000
// triangles, on the same path (strokes at 0.1 to 0.3 m/s that press 1 to 3 mm, and pokes, at 1 kHz). The
// error is relative to the reference in long double of the same run.
//   knurl_bench_geometry [--short] [--most TRIANGLES] [--cold CYCLES] [--json FILE]
//     --short   walk beside active set alone, at two sizes, in seconds
//     --cold    so many cold cycles of each (1050, the fewest of which 99 % is stated)
// scripts/plot_geometry.py draws the file.
//
// Warm: each cycle alone, the fastest of three passes over a hand. Cold: once, 48 MiB written before it. The
// clock's own time is taken off. All times are of cycles in which the reference touches.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <optional>

#include <exact/god_object.hpp>

#include <knurl/json/json.hpp>
#include <knurl/measure/compare.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>

#include "caches.hpp"
#include "methods.hpp"

namespace {

using namespace knurl;
using namespace knurl::test;
using Eigen::Vector3d;
using ordered_json = knurl::Json;

constexpr std::size_t hands_a_block = 3;
constexpr double deep = 0.0002;  // m: a hand deeper inside that feels nothing has lost the surface
constexpr int passes = 3;
constexpr std::uint64_t seed = 7;

struct Options {
    bool brief = false;
    std::size_t most = 1'000'000, cold = 1050;
    const char* file = nullptr;
};

Vector3d at(const Hand& hand, std::size_t i) {
    return {hand[i][0], hand[i][1], hand[i][2]};
}

std::vector<Hand> strokes_and_pokes() {
    const Relief middle(64, 0.14);  // the middle of the relief, of the size for which Hands is made
    Hands hands(middle.shape, seed);
    std::vector<Hand> all;
    for (int i = 0; i < 102; ++i) all.push_back(i % 5 < 2 ? hands.stroke() : hands.poke());
    return all;
}

/// The reference's proxy in every cycle of every hand.
using Truth = std::vector<std::vector<ProxyPoint>>;
Truth truth_of(const Relief& relief, const std::vector<Hand>& hands) {
    const exact::Surface surface(relief.shape.vertices, relief.shape.triangles);
    Truth all;
    for (const Hand& hand : hands) {
        exact::GodObject god(surface);
        auto& felt = all.emplace_back();
        for (const auto& p : hand) {
            const bool touches = god.step(exact::to_exact(p));
            const exact::V x = god.at();
            felt.push_back(
                {touches ? Vector3d(double(x.x), double(x.y), double(x.z)) : Vector3d(p[0], p[1], p[2]),
                 touches});
        }
    }
    return all;
}

double percentile(std::vector<double>& samples, double share) {
    if (samples.empty()) return NAN;
    const auto place =
        std::min(samples.size() - 1, static_cast<std::size_t>(share * static_cast<double>(samples.size())));
    std::nth_element(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(place), samples.end());
    return samples[place];
}

/// The results of one method at one size.
struct Seen {
    std::vector<double> errors;         // m
    std::size_t lost = 0, losses = 0;   // cycles without contact deep inside; how often that began
    std::size_t touching = 0;           // cycles, of the reference
    std::vector<double> warm, cold;     // ns
    measure::Blocks middles, extremes;  // ns: of the warm ones; their 99 %, one of each block
};

class Bench {
  public:
    explicit Bench(const std::vector<Hand>& hands) : hands_(hands) {}

    /// Runs one hand after the other, with all methods on each.
    std::vector<Seen> run(const Methods& methods, const Truth& truth) {
        std::vector<Seen> all(methods.size());
        std::vector<std::vector<double>> block(methods.size());
        for (std::size_t h = 0; h < hands_.size(); ++h) {
            for (std::size_t m = 0; m < methods.size(); ++m) {
                judge(*methods[m], h, truth[h], all[m]);
                const auto times = warm_times(*methods[m], h);
                for (std::size_t i = 0; i < times.size(); ++i)
                    if (truth[h][i].touches) block[m].push_back(times[i]);
            }
            if (h % hands_a_block != hands_a_block - 1) continue;
            for (std::size_t m = 0; m < methods.size(); ++m) {
                all[m].warm.insert(all[m].warm.end(), block[m].begin(), block[m].end());
                all[m].middles.add(block[m]);
                all[m].extremes.add({percentile(block[m], 0.99)});
                block[m].clear();
            }
        }
        return all;
    }

    /// Runs that many cold cycles, spread over all hands.
    void run_cold(const Methods& methods, const Truth& truth, std::size_t samples, std::vector<Seen>& all) {
        std::size_t touching = 0, seen = 0;
        for (const auto& hand : truth)
            for (const ProxyPoint& felt : hand) touching += felt.touches;
        const std::size_t every = std::max<std::size_t>(1, touching / samples);
        for (std::size_t h = 0; h < hands_.size(); ++h) {
            for (const auto& method : methods) method->begin(h, at(hands_[h], 0));
            for (std::size_t i = 0; i < hands_[h].size(); ++i) {
                const Vector3d hand = at(hands_[h], i);
                const bool now = truth[h][i].touches && ++seen % every == 0;
                for (std::size_t m = 0; m < methods.size(); ++m) {
                    if (now)
                        all[m].cold.push_back(cold([&] { return methods[m]->step(hand); }));
                    else
                        (void)methods[m]->step(hand);
                }
            }
        }
    }

    /// The time of one memory access that is in no cache, including code and page table.
    std::vector<double> look_cold(int samples) {
        constexpr std::size_t bytes = std::size_t{64} << 20;
        const std::vector<char> memory(bytes, 1);
        std::vector<double> ns;
        for (int i = 0; i < samples; ++i) {
            const volatile char* where = &memory[(static_cast<std::size_t>(i) * 7919 * 4096) % bytes];
            ns.push_back(cold([&] { return ProxyPoint{Vector3d::Zero(), *where != 0}; }));
        }
        return ns;
    }

    const measure::Stopwatch& watch() const { return watch_; }

  private:
    template <class Do>
    double timed(Do&& cycle) {
        const std::uint64_t begin = measure::Stopwatch::begin();
        const ProxyPoint felt = cycle();
        asm volatile("" : : "g"(&felt) : "memory");
        return watch_.nanoseconds(begin, measure::Stopwatch::end()) - watch_.empty_interval();
    }
    template <class Do>
    double cold(Do&& cycle) {
        flush_caches();
        return timed(cycle);
    }

    std::vector<double> warm_times(Method& method, std::size_t h) {
        const Hand& hand = hands_[h];
        std::vector<double> best(hand.size(), INFINITY);
        for (int pass = 0; pass < passes; ++pass) {
            method.begin(h, at(hand, 0));
            for (std::size_t i = 0; i < hand.size(); ++i) {
                const Vector3d p = at(hand, i);
                best[i] = std::min(best[i], timed([&] { return method.step(p); }));
            }
        }
        return best;
    }

    void judge(Method& method, std::size_t h, const std::vector<ProxyPoint>& truth, Seen& seen) {
        method.begin(h, at(hands_[h], 0));
        bool lost = false;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const Vector3d hand = at(hands_[h], i);
            const ProxyPoint felt = method.step(hand);
            if (felt.touches || truth[i].touches) seen.errors.push_back((felt.at - truth[i].at).norm());
            if (!truth[i].touches) lost = false;
            if (!truth[i].touches) continue;
            ++seen.touching;
            const bool feels_nothing = !felt.touches && (truth[i].at - hand).norm() > deep;
            seen.losses += feels_nothing && !lost;
            seen.lost += feels_nothing;
            lost = feels_nothing;
        }
    }

    const std::vector<Hand>& hands_;
    const measure::Stopwatch watch_;
};

ordered_json stated(std::vector<double>& samples, double share) {
    const bool enough =
        static_cast<double>(samples.size()) * (1 - share) >= static_cast<double>(measure::least_above);
    return enough ? ordered_json(percentile(samples, share)) : ordered_json(nullptr);
}

/// The output of a run.
class Report {
  public:
    explicit Report(const measure::Machine& machine) { run_.machine = machine; }

    void add(const Method& method, std::size_t triangles, Seen& seen) {
        std::string what = method.name;
        if (method.rate > 0) what += ", " + std::to_string(int(method.rate)) + " Hz";
        if (method.predicted) what += ", predicted";
        std::printf("%8zu  %-28s %7.0f %7.0f", triangles, what.c_str(), percentile(seen.warm, 0.5),
                    percentile(seen.warm, 0.99));
        if (seen.cold.empty())
            std::printf("               ");
        else
            std::printf("  %6.0f %6.0f", percentile(seen.cold, 0.5), percentile(seen.cold, 0.99));
        const double lost = seen.touching > 0 ? double(seen.lost) / double(seen.touching) : 0;
        if (!seen.errors.empty())
            std::printf("  %9.2e %9.2e %9.2e  %6.2f %% %5zu", percentile(seen.errors, 0.5),
                        percentile(seen.errors, 0.99), percentile(seen.errors, 1), 100 * lost, seen.losses);
        std::puts("");
        ordered_json point{{"method", method.name},
                           {"hz", method.rate},
                           {"predicted", method.predicted},
                           {"triangles", triangles},
                           {"cycles", seen.warm.size()},
                           {"warm_p50", stated(seen.warm, 0.5)},
                           {"warm_p99", stated(seen.warm, 0.99)},
                           {"cold_cycles", seen.cold.size()},
                           {"cold_p50", stated(seen.cold, 0.5)},
                           {"cold_p99", stated(seen.cold, 0.99)}};
        if (!seen.errors.empty()) {
            point["error_p50"] = percentile(seen.errors, 0.5);
            point["error_p99"] = percentile(seen.errors, 0.99);
            point["error_max"] = percentile(seen.errors, 1);
            point["lost_share"] = lost;
            point["pop_throughs"] = seen.losses;
        }
        points_.push_back(std::move(point));
        const std::string where = ", " + std::to_string(triangles) + " triangles";
        run_.results.push_back(measure::summarise_blocks(what + where, "ns", seen.middles));
        run_.results.push_back(measure::summarise_blocks(what + ", 99 %" + where, "ns", seen.extremes));
    }
    /// Relates all results to those of this method at the same size.
    void beside(const std::string& method) {
        for (measure::Result& result : run_.results) {
            const bool extreme = result.name.find(", 99 %") != std::string::npos;
            const std::string reference =
                method + (extreme ? ", 99 %" : "") +
                result.name.substr(std::min(result.name.rfind(", "), result.name.size()));
            const measure::Result* other = find(reference);
            if (other != nullptr && other != &result) measure::relate(result, *other);
        }
    }
    void look(std::vector<double> ns) {
        run_.results.push_back(measure::summarise("a look at memory, cold", "ns", std::move(ns)));
        std::printf("          a look at memory, cold: %.0f ns\n", run_.results.back().p50.value_or(NAN));
    }

    /// Judges the ratio of the medians of `what` and `reference`, by bootstrap over the blocks of both.
    void goal(const std::string& what, const std::string& reference, double most) {
        const measure::Result *one = find(what), *other = find(reference);
        if (one == nullptr || other == nullptr) return;
        const auto middle = [](const measure::Result& r, std::span<const std::size_t> drawn) {
            measure::Histogram all;
            for (const std::size_t block : drawn) all.merge(r.blocks[block]);
            return all.percentile(0.5);
        };
        const std::size_t blocks = std::min(one->blocks.size(), other->blocks.size());
        const auto interval = measure::bootstrap(
            blocks, blocks,
            [&](std::span<const std::size_t> drawn, std::span<const std::size_t>) -> std::optional<double> {
                const auto a = middle(*one, drawn), b = middle(*other, drawn);
                if (!a || !b || !(*b > 0)) return std::nullopt;
                return *a / *b;
            },
            {});
        if (interval) verdict(what + " to " + reference, most, interval->low, interval->high);
    }
    /// Judges a value that is counted or exact, so has no noise.
    void fact(const std::string& what, double most, double value) { verdict(what, most, value, value); }

    std::string text(const Options& options) const {
        ordered_json json = ordered_json::parse(measure::to_json(run_));
        json["goals"] = goals_;
        json["geometry"] = {{"seed", seed}, {"short", options.brief}, {"points", points_}};
        return json.dump(1) + '\n';
    }

  private:
    const measure::Result* find(const std::string& name) const {
        for (const measure::Result& r : run_.results)
            if (r.name == name) return &r;
        return nullptr;
    }
    void verdict(const std::string& what, double most, double low, double high) {
        const char* said = high <= most ? "kept" : low > most ? "not kept" : "undecided";
        std::printf("%s: %.3g to %.3g, at most %.3g: %s\n", what.c_str(), low, high, most, said);
        goals_.push_back({{"what", what}, {"bound", most}, {"low", low}, {"high", high}, {"verdict", said}});
    }

    measure::Run run_;
    ordered_json points_ = ordered_json::array(), goals_ = ordered_json::array();
};

void add_all(Report& report, const Methods& methods, std::size_t triangles, std::vector<Seen>& seen) {
    for (std::size_t m = 0; m < methods.size(); ++m) report.add(*methods[m], triangles, seen[m]);
    std::fflush(stdout);
}

/// In cells a side: 1 058 to 999 698 triangles.
constexpr std::uint32_t sizes[] = {23, 43, 90, 181, 360, 707};
constexpr std::uint32_t small = 43, medium = 181, large = 707;

std::string triangles_of(std::uint32_t cells) {
    return std::to_string(std::size_t{2} * cells * cells) + " triangles";
}

void run(const Options& options, Report& report) {
    const std::vector<Hand> hands = strokes_and_pokes();
    Bench bench(hands);
    std::vector<std::uint32_t> done;
    for (const std::uint32_t cells : sizes) {
        if (std::size_t{2} * cells * cells > options.most) break;
        if (options.brief && cells != small && cells != medium) continue;
        done.push_back(cells);
        const Relief relief(cells);
        const Shapes shapes(relief);
        const Methods methods = options.brief ? walkers(shapes) : whole_surfaces(relief, shapes);
        const Truth truth = truth_of(relief, hands);
        std::vector<Seen> seen = bench.run(methods, truth);
        if (!options.brief && (cells == sizes[0] || cells == medium || cells == large))
            bench.run_cold(methods, truth, options.cold, seen);
        add_all(report, methods, relief.triangles(), seen);
        for (std::size_t m = 0; m < methods.size(); ++m) {
            if (methods[m]->name != "walk" && methods[m]->name != "height field") continue;
            const std::string which = methods[m]->name + ", " + triangles_of(cells);
            report.fact(which + ": 99 % of errors, m", 1e-7, percentile(seen[m].errors, 0.99));
            report.fact(which + ": cycles that lost the contact", 0, double(seen[m].lost));
        }
        if (options.brief || cells != medium) continue;
        // The scene's planes and caps do not depend on the number of triangles, so one size is enough.
        const Methods scenes = in_a_scene(shapes, hands);
        seen = bench.run(scenes, truth);
        bench.run_cold(scenes, truth, std::min<std::size_t>(options.cold, 200), seen);
        add_all(report, scenes, relief.triangles(), seen);
    }
    if (!options.brief) report.look(bench.look_cold(300));
    report.beside("active set");
    for (const std::uint32_t cells : done) {
        const std::string where = ", " + triangles_of(cells);
        report.goal("walk" + where, "active set" + where, 1.0 / 8);
        report.goal("walk, 99 %" + where, "active set, 99 %" + where, 1.0 / 4);
    }
    report.goal("walk, " + triangles_of(large), "walk, " + triangles_of(small), 3);
}

std::optional<Options> options_of(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--short") == 0)
            options.brief = true;
        else if (std::strcmp(argv[i], "--most") == 0 && i + 1 < argc)
            options.most = std::strtoull(argv[++i], nullptr, 10);
        else if (std::strcmp(argv[i], "--cold") == 0 && i + 1 < argc)
            options.cold = std::max(1ULL, std::strtoull(argv[++i], nullptr, 10));
        else if (std::strcmp(argv[i], "--json") == 0 && i + 1 < argc)
            options.file = argv[++i];
        else
            return std::nullopt;
    }
    return options;
}

}  // namespace

int main(int argc, char** argv) {
    const auto options = options_of(argc, argv);
    if (!options) {
        std::fputs("knurl_bench_geometry: use [--short] [--most TRIANGLES] [--cold CYCLES] [--json FILE]\n",
                   stderr);
        return 2;
    }
    try {
        if (options->file) measure::require_writable(options->file);
        const measure::Machine machine = measure::this_machine();
        std::printf("%s, %u CPUs, Linux %s, load %s\n%s, %s\n", machine.processor.c_str(), machine.cpus,
                    machine.kernel.c_str(), machine.load.c_str(), machine.build.c_str(),
                    machine.date.c_str());
#if !defined(KNURL_EMBREE)
        std::puts("WITHOUT EMBREE: built without it; install libembree-dev, then configure again");
#endif
        std::printf("%8s  %-28s %7s %7s  %6s %6s  %9s %9s %9s  %8s %5s\n", "", "", "warm ns", "99 %", "cold",
                    "99 %", "error, m", "99 %", "most", "lost", "pops");
        Report report(machine);
        run(*options, report);
        if (options->file) measure::write_file(options->file, report.text(*options));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl_bench_geometry: %s\n", error.what());
        return 1;
    }
    return 0;
}
