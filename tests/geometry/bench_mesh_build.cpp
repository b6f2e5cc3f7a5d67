// The cost of building a mesh: CPU time of the thread per triangle, and memory. For comparison: the time to
// sort as many numbers.

#include <algorithm>
#include <random>

#include <benchmark/benchmark.h>

#include "raw_mesh.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

void build(benchmark::State& state, int subdivisions, bool crossings, bool stl) {
    RawMesh raw = raw_sphere(subdivisions, 0.1, 0.05);
    if (stl) raw = raw.unwelded();
    MeshBuild how;
    how.budget = std::size_t{1} << 32;
    how.find_crossings = crossings;
    double bytes = 0;
    for (auto _ : state) {
        const Mesh mesh(raw.given(), how);
        bytes = static_cast<double>(mesh.bytes());
        benchmark::DoNotOptimize(bytes);
    }
    const auto n = static_cast<double>(raw.triangles.size());
    state.counters["a_triangle"] =
        benchmark::Counter(n, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    state.counters["triangles"] = n;
    state.counters["bytes_a_triangle"] = bytes / n;
}

void sort_keys(benchmark::State& state, std::size_t count) {
    std::mt19937_64 random(1);
    std::vector<std::uint64_t> keys(count), sorted;
    std::generate(keys.begin(), keys.end(), random);
    for (auto _ : state) {
        sorted = keys;
        std::sort(sorted.begin(), sorted.end());
        benchmark::DoNotOptimize(sorted.data());
    }
}

// 20 480, 81 920, 327 680 and 1 310 720 triangles.
BENCHMARK_CAPTURE(build, bare_20k, 5, false, false);
BENCHMARK_CAPTURE(build, bare_328k, 7, false, false);
BENCHMARK_CAPTURE(build, bare_1311k, 8, false, false);
BENCHMARK_CAPTURE(build, crossings_20k, 5, true, false);
BENCHMARK_CAPTURE(build, crossings_328k, 7, true, false);
BENCHMARK_CAPTURE(build, crossings_1311k, 8, true, false);
BENCHMARK_CAPTURE(build, stl_328k, 7, false, true);
BENCHMARK_CAPTURE(sort_keys, 20k, 20'480);
BENCHMARK_CAPTURE(sort_keys, 328k, 327'680);
BENCHMARK_CAPTURE(sort_keys, 1311k, 1'310'720);

}  // namespace

BENCHMARK_MAIN();
