// The cost per cycle of one polygon, half-plane or box, beside a plane in the same run. The probe wanders
// over the same 64 points: free (over the middle of the face), over an edge, or held below the face. At the
// end the cost of touching boxes in a scene.

#include <benchmark/benchmark.h>

#include <knurl/reps/box.hpp>
#include <knurl/reps/half_plane.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/polygon.hpp>
#include <knurl/reps/scene.hpp>

using namespace knurl;

namespace {

enum Where { free_over, edge, held };

Polygon regular(std::uint32_t corners) {
    Polygon polygon;
    polygon.stiffness = 1000;
    polygon.vertices.count = corners;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double angle = 2 * M_PI * i / corners;
        polygon.vertices.at[i] = {0.05 * std::cos(angle), 0.05 * std::sin(angle), 0};
    }
    return polygon;
}

template <class R>
void wander(benchmark::State& state, const R& raw, Where where) {
    const R params = prepared(raw, {});
    typename R::State memory{};
    Probe probe;
    adopt(params, nullptr, memory, probe);
    probe.position = {0, 0, 0.06};
    contact(params, memory, probe, 1e-3);
    std::vector<Eigen::Vector3d> path;
    for (int i = 0; i < 64; ++i) {
        const double s = 1e-3 * std::sin(i * M_PI / 32), c = 1e-3 * std::cos(i * M_PI / 32);
        path.emplace_back(where == edge ? 0.06 + s : s, c, where == held ? -0.003 + s : 0.06 + s);
    }
    std::size_t at = 0;
    for (auto _ : state) {
        probe.position = path[at++ & 63];
        Contact felt = contact(params, memory, probe, 1e-3);
        benchmark::DoNotOptimize(felt);
    }
}

// The plane, the half-plane's edge and the box's top face match the polygons: z = 0, x <= 0.05.
HalfPlane half() {
    return {.edge_offset = 0.05, .stiffness = 1000};
}
Box box(Side side) {
    return {.center = {0, 0, -0.05}, .orientation = {2, 0, 0, 1}, .side = side, .stiffness = 1000};
}

BENCHMARK_CAPTURE(wander, plane, Plane{.stiffness = 1000}, held);
BENCHMARK_CAPTURE(wander, half_plane_free, half(), free_over);
BENCHMARK_CAPTURE(wander, half_plane_edge, half(), edge);
BENCHMARK_CAPTURE(wander, half_plane_held, half(), held);
BENCHMARK_CAPTURE(wander, triangle_free, regular(3), free_over);
BENCHMARK_CAPTURE(wander, triangle_edge, regular(3), edge);
BENCHMARK_CAPTURE(wander, triangle_held, regular(3), held);
BENCHMARK_CAPTURE(wander, square_held, regular(4), held);
BENCHMARK_CAPTURE(wander, octagon_free, regular(8), free_over);
BENCHMARK_CAPTURE(wander, octagon_edge, regular(8), edge);
BENCHMARK_CAPTURE(wander, octagon_held, regular(8), held);
BENCHMARK_CAPTURE(wander, box_free, box(Side::outside), free_over);
BENCHMARK_CAPTURE(wander, box_edge, box(Side::outside), edge);
BENCHMARK_CAPTURE(wander, box_held, box(Side::outside), held);
BENCHMARK_CAPTURE(wander, box_hollow, box(Side::inside), held);

// A whole cycle of a scene: the hand is held by one box, alone or with others that stand flush beside it.
void boxes_in_a_scene(benchmark::State& state) {
    Scene scene({.representations = 8, .probes = 1}, {});
    const auto count = static_cast<std::uint32_t>(state.range(0));
    for (std::uint32_t i = 0; i < count; ++i) {
        const Box each{.center = {0.1 * i, 0, -0.05}, .stiffness = 1000};
        if (!scene.add({.slot = i, .generation = 1}, each)) return state.SkipWithError("refused");
    }
    Probe probe;
    probe.position = {0.04, 0, 0.001};
    scene.evaluate(probe, 1e-3);
    std::uint32_t cycle = 0;
    for (auto _ : state) {
        probe.position.z() = -0.001 - 1e-5 * (cycle++ & 63);
        benchmark::DoNotOptimize(scene.evaluate(probe, 1e-3));
    }
}
BENCHMARK(boxes_in_a_scene)->Arg(1)->Arg(2);

}  // namespace

BENCHMARK_MAIN();
