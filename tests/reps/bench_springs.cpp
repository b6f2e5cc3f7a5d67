// Springs of one probe evaluated one by one, and collapsed to one, in the same run.

#include <benchmark/benchmark.h>

#include <knurl/reps/collapsed_springs.hpp>

#include "random_planes.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

struct Bundle {
    std::vector<Spring> springs;
    std::vector<Spring::State> states;
    CollapsedSprings collapsed;
    std::vector<Probe> path;

    explicit Bundle(std::int64_t count) {
        Rng rng(42);
        for (std::int64_t i = 0; i < count; ++i) {
            springs.push_back(prepared({.anchor = to_plain(0.1 * direction(rng)),
                                        .attach = to_plain(0.03 * direction(rng)),
                                        .stiffness = uniform(rng, 1, 200)},
                                       {}));
            states.push_back({.anchor = springs.back().anchor});
            collapsed.add(springs.back(), springs.back().anchor);
        }
        for (int i = 0; i < 64; ++i) {
            Probe probe;
            probe.position = 0.02 * std::sin(i * M_PI / 32) * Eigen::Vector3d::UnitX();
            probe.orientation = Eigen::AngleAxisd(0.3 * std::cos(i * M_PI / 32), Eigen::Vector3d::UnitY());
            path.push_back(probe);
        }
    }
};

void one_by_one(benchmark::State& state) {
    Bundle bundle(state.range(0));
    std::size_t at = 0;
    for (auto _ : state) {
        const Probe& probe = bundle.path[at++ & 63];
        Wrench sum;
        for (std::size_t i = 0; i < bundle.springs.size(); ++i)
            sum += evaluate(bundle.springs[i], bundle.states[i], probe, 1e-3);
        benchmark::DoNotOptimize(sum);
    }
}

void collapsed(benchmark::State& state) {
    Bundle bundle(state.range(0));
    std::size_t at = 0;
    for (auto _ : state) {
        Wrench sum = bundle.collapsed.evaluate(bundle.path[at++ & 63]);
        benchmark::DoNotOptimize(sum);
    }
}

}  // namespace

BENCHMARK(one_by_one)->Arg(1)->Arg(6)->Arg(100)->Arg(1000);
BENCHMARK(collapsed)->Arg(1)->Arg(6)->Arg(100)->Arg(1000);

BENCHMARK_MAIN();
