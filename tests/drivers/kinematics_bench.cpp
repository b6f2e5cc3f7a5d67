// Forward kinematics + Jacobian + J^T F, as a servo's cycle does them. Inputs change each time.

#include <array>
#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>

#include <knurl/drivers/serial_chain.hpp>
#include <knurl/drivers/sim_profile.hpp>

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

BENCHMARK(three_sincos);
BENCHMARK(cartesian);
BENCHMARK(three_axes);
BENCHMARK(six_axes);
BENCHMARK(seven_axes);

}  // namespace

BENCHMARK_MAIN();
