// Forward kinematics + Jacobian + J^T F, as a servo's cycle does them. Inputs change each time.
//   knurl_bench_kinematics [Google Benchmark's options]
//   knurl_bench_kinematics --error FILE.json     the delta's run time against error: scripts/plot_kinematics.py

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>

#include <benchmark/benchmark.h>

#include <knurl/drivers/delta.hpp>
#include <knurl/drivers/serial_chain.hpp>
#include <knurl/drivers/sim_profile.hpp>
#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>

#include "delta_error.hpp"

namespace {

using namespace knurl::drivers;

void cycle(benchmark::State& state, const Mechanism& mechanism, const JointArray& centre) {
    constexpr std::size_t postures = 256;
    std::array<JointArray, postures> joints;
    for (std::size_t i = 0; i < postures; ++i) {
        for (std::size_t j = 0; j < max_joints; ++j) {
            joints[i][j] = centre[j] + 0.2 * std::sin(0.1 * static_cast<double>(i) + static_cast<double>(j));
        }
    }
    const auto n = static_cast<std::size_t>(mechanism.joints());
    TipPose pose;
    Jacobian jacobian;
    std::size_t i = 0;
    for (auto _ : state) {
        mechanism.forward({joints[i++ % postures].data(), n}, pose, jacobian);
        std::array<double, max_joints> efforts{};
        const Eigen::Vector3d force = pose.position;
        for (std::size_t j = 0; j < n; ++j) {
            efforts[j] = jacobian.block<3, 1>(0, static_cast<Eigen::Index>(j)).dot(force);
        }
        benchmark::DoNotOptimize(efforts);
    }
}

void three_axes(benchmark::State& state) {
    const SimProfile profile = sim_profile("premium15");
    cycle(state, *profile.mechanism, profile.centre);
}
void six_axes(benchmark::State& state) {
    const SimProfile profile = sim_profile("generic6");
    cycle(state, *profile.mechanism, profile.centre);
}
void seven_axes(benchmark::State& state) {
    constexpr double quarter = std::numbers::pi / 2;
    const SerialChain chain({.rows = {{.d = 0.3, .alpha = quarter},
                                      {.alpha = -quarter},
                                      {.d = 0.3, .alpha = quarter},
                                      {.alpha = -quarter},
                                      {.d = 0.3, .alpha = quarter},
                                      {.alpha = -quarter},
                                      {.d = 0.1}}});
    cycle(state, chain, {0, 0.5, 0, 1, 0, 0.5, 0});
}
void cartesian(benchmark::State& state) {
    const SimProfile profile = sim_profile("cartesian3");
    cycle(state, *profile.mechanism, profile.centre);
}
void delta(benchmark::State& state) {
    const Delta falcon(falcon_delta());
    cycle(state, falcon, {0.48, 0.48, 0.48});
}
/// The reference beside them: three sines and cosines.
void three_sincos(benchmark::State& state) {
    double x = 0.1;
    for (auto _ : state) {
        x += 1e-3;
        double sum = 0;
        for (const double angle : {x, x + 0.3, 1 - x}) {
            sum += std::sin(angle) * std::cos(angle);
        }
        benchmark::DoNotOptimize(sum);
    }
}

int write_errors(const char* path, const knurl::measure::Machine& machine) {
    knurl::Json json = knurl::Json::parse(knurl::measure::to_json({.machine = machine, .results = {}}));
    json["points"] = knurl::Json::array();
    for (const DeltaPoint& point : delta_run_time_against_error()) {
        const std::string steps =
            point.steps == DeltaPoint::until_settled ? "all" : std::to_string(point.steps);
        std::printf("%4.2f m/s  %-20s %3s steps  %6.1f ns  worst %.2g m  median %.2g m%s\n", point.speed,
                    point.start.c_str(), steps.c_str(), point.ns, point.worst, point.median,
                    point.knurl ? "  <- Knurl" : "");
        json["points"].push_back({{"start", point.start},
                                  {"speed", point.speed},
                                  {"steps", point.steps},
                                  {"ns", point.ns},
                                  {"worst", point.worst},
                                  {"median", point.median},
                                  {"knurl", point.knurl}});
    }
    try {
        knurl::measure::write_file(path, json.dump(1) + '\n');
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl_bench_kinematics: %s\n", error.what());
        return 1;
    }
    return 0;
}

BENCHMARK(three_sincos);
BENCHMARK(cartesian);
BENCHMARK(three_axes);
BENCHMARK(six_axes);
BENCHMARK(seven_axes);
BENCHMARK(delta);

}  // namespace

int main(int argc, char** argv) {
    const knurl::measure::Machine machine = knurl::measure::this_machine();
    std::fprintf(stderr, "%s, %u CPUs, Linux %s, load %s; %s, %s\n", machine.processor.c_str(), machine.cpus,
                 machine.kernel.c_str(), machine.load.c_str(), machine.build.c_str(), machine.date.c_str());
    if (argc == 3 && std::strcmp(argv[1], "--error") == 0) {
        return write_errors(argv[2], machine);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
        return 2;
    }
    benchmark::RunSpecifiedBenchmarks();
}
