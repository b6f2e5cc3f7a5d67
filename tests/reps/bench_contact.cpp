// Contact solutions beside the sum of plane forces (which is wrong by millimetres) in the same run. Every
// iteration moves the probe along the same 64 points, so all do the same work on changing data.

#include <benchmark/benchmark.h>

#include "random_planes.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

struct Stroke {
    PlaneSet set;
    std::vector<Eigen::Vector3d> path;
    std::vector<double> s;
    ContactPlanes planes;

    explicit Stroke(int count) {
        Rng rng(42);
        const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
        while (set.size() < static_cast<std::uint32_t>(count)) {
            const Eigen::Vector3d n = direction(rng);
            if (n.dot(up) > std::cos(80 * M_PI / 180)) set.add(n, uniform(rng, -0.002, 0));
        }
        prepare(-0.005 * up, direction(rng));
    }
    void prepare(const Eigen::Vector3d& centre, const Eigen::Vector3d& side) {
        path.clear();
        for (int i = 0; i < 64; ++i) path.push_back(centre + 1e-4 * std::sin(i * M_PI / 32) * side);
        s.resize(set.c.size());
        planes = {set.nx.data(), set.ny.data(), set.nz.data(), s.data(), set.size()};
    }
    double shift(const Eigen::Vector3d& p) {
        return shift_to_probe(set.nx.data(), set.ny.data(), set.nz.data(), set.c.data(), set.size(), p,
                              s.data());
    }
};

void naive_sum(benchmark::State& state) {
    Stroke stroke(static_cast<int>(state.range(0)));
    const PlaneSet& set = stroke.set;
    std::size_t at = 0;
    for (auto _ : state) {
        const Eigen::Vector3d& p = stroke.path[at++ & 63];
        double fx = 0, fy = 0, fz = 0;
        for (std::uint32_t i = 0; i < set.size(); ++i) {
            const double depth = set.c[i] - (set.nx[i] * p.x() + set.ny[i] * p.y() + set.nz[i] * p.z());
            const double f = depth > 0 ? 1000 * depth : 0;
            fx += f * set.nx[i], fy += f * set.ny[i], fz += f * set.nz[i];
        }
        benchmark::DoNotOptimize(fx);
        benchmark::DoNotOptimize(fy);
        benchmark::DoNotOptimize(fz);
    }
}

void joint(benchmark::State& state, bool keep) {
    Stroke stroke(static_cast<int>(state.range(0)));
    ContactSolution solution;
    std::size_t at = 0;
    for (auto _ : state) {
        const double worst = stroke.shift(stroke.path[at++ & 63]);
        if (!keep) solution.active.count = 0;
        solve_contact(stroke.planes, worst, 0, solution);
        benchmark::DoNotOptimize(solution.dx);
    }
}

void cold(benchmark::State& state) {
    joint(state, false);
}
void warm(benchmark::State& state) {
    joint(state, true);
}

// As called by a scene, in the corner of a room where up to three planes push and the others are near.
void corner(benchmark::State& state) {
    Stroke stroke(0);
    const Eigen::Vector3d walls[] = {{0, 0, 1},      {0.958, 0, 0.287}, {0, 0.958, 0.287},
                                     {-0.1, 0.7, 1}, {0.2, 0.7, 1},     {0.5, 0.7, 1}};
    for (int i = 0; i < state.range(0); ++i) stroke.set.add(walls[i].normalized(), i < 3 ? 0 : -0.02);
    stroke.prepare({-0.005, -0.005, -0.005}, {0.6, 0.7, 0.3});
    ContactSolution solution;
    double give = 0;
    std::size_t at = 0;
    for (auto _ : state) {
        const double worst = stroke.shift(stroke.path[at++ & 63]);
        solve_contact_relaxed(stroke.planes, worst, give, solution);
        benchmark::DoNotOptimize(solution.dx);
    }
}

void sizes(benchmark::internal::Benchmark* b) {
    for (const int n : {1, 2, 3, 4, 5, 6, 16, 64, 256}) b->Arg(n);
}

BENCHMARK(naive_sum)->Apply(sizes);
BENCHMARK(cold)->Apply(sizes);
BENCHMARK(warm)->Apply(sizes);
BENCHMARK(corner)->DenseRange(1, 6);

}  // namespace

BENCHMARK_MAIN();
