// One cycle of a scene, beside an empty one in the same run.

#include <algorithm>
#include <chrono>

#include <benchmark/benchmark.h>

#include <knurl/geometry/mesh.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

/// A hand that strokes 0.1 mm back and forth about 1 mm under the origin.
struct Hand {
    std::array<Probe, 64> probes;
    std::size_t next = 0;
    explicit Hand(const Vector& centre = {0, 0, -0.001}) {
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const double phase = static_cast<double>(i) * M_PI / 32;
            probes[i] = at(centre + 1e-4 * Vector(std::sin(phase), std::cos(phase), std::sin(2 * phase)),
                           {0.01, 0, 0});
        }
    }
    const Probe& operator()() { return probes[next++ & 63]; }
};

void run(benchmark::State& state, Scene& scene, Hand hand = Hand{}) {
    scene.settle();
    scene.evaluate(hand(), dt);
    for (auto _ : state) benchmark::DoNotOptimize(scene.evaluate(hand(), dt));
}

void empty(benchmark::State& state) {
    Scene scene = make_scene();
    run(state, scene);
}

void one_plane(benchmark::State& state) {
    Scene scene = make_scene();
    (void)scene.add({0, 1}, Plane{.stiffness = 1000});
    run(state, scene);
}

void add_corner(Scene& scene, double offset, double hardest) {
    (void)scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .offset = offset, .stiffness = 1000});
    (void)scene.add({1, 1}, Plane{.normal = {1, 0, 0.3}, .offset = offset, .stiffness = hardest});
    (void)scene.add({2, 1}, Plane{.normal = {0, 1, 0.3}, .offset = offset, .stiffness = 1000});
}

void corner_of_three(benchmark::State& state) {
    Scene scene = make_scene();
    add_corner(scene, 0, 1000);
    run(state, scene);
}

void corner_of_two_stiffnesses(benchmark::State& state) {
    Scene scene = make_scene();
    add_corner(scene, 0, 2000);
    run(state, scene);
}

void plane_while_fading(benchmark::State& state) {
    Scene scene = make_scene({}, {.automatic = 1000, .rise_speed = infinity});
    (void)scene.add({0, 1}, Plane{.stiffness = 1000, .recovery = 0});
    Hand hand;
    scene.evaluate(hand(), dt);
    (void)scene.update({0, 1}, Plane{.offset = 0.001, .stiffness = 1000});
    for (auto _ : state) benchmark::DoNotOptimize(scene.evaluate(hand(), 1e-9));
}

void plane_updated_every_cycle(benchmark::State& state) {
    Scene scene = make_scene();
    (void)scene.add({0, 1}, Plane{.stiffness = 1000});
    Hand hand;
    double offset = 0;
    for (auto _ : state) {
        offset = offset > 0 ? 0 : 1e-4;
        (void)scene.update({0, 1}, Plane{.offset = offset, .stiffness = 1000});
        benchmark::DoNotOptimize(scene.evaluate(hand(), dt));
    }
}

void planes_out_of_reach(benchmark::State& state) {
    Scene scene({.representations = 1024, .probes = 1}, {});
    for (std::uint32_t i = 0; i < state.range(0); ++i) {
        (void)scene.add({i, 1}, Plane{.offset = -0.1, .stiffness = 1000});
    }
    run(state, scene);
}

/// Size 2 cm.
struct Tetrahedron {
    const std::array<std::array<double, 3>, 4> corners{{{0, 0, 0}, {0.02, 0, 0}, {0, 0.02, 0}, {0, 0, 0.02}}};
    const std::array<Triangle, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    const Mesh mesh{{.vertices = corners, .triangles = faces, .materials = {}}};
};

/// N shapes of 2 cm, of as many assets as a scene has, at least 12 cm from a hand at 0.1 m/s. The difference
/// to 0 shapes is their cost.
void meshes_apart(benchmark::State& state, double spin) {
    const auto n = static_cast<std::uint32_t>(state.range(0));
    const Tetrahedron mesh;
    Scene scene({.representations = 1024, .probes = 1}, {});
    for (std::uint32_t i = 0; i < max_assets; ++i) scene.set_asset(i + 1, &mesh.mesh);
    Rng rng(1);
    for (std::uint32_t i = 0; i < n; ++i) {
        const Vector to(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1));
        const Vec3 place = to_plain(Vector(to.normalized() * uniform(rng, 0.2, 0.4)));
        (void)scene.add({i, 1}, Shape{.asset = i % max_assets + 1,
                                      .position = place,
                                      .angular_velocity = {0, 0, spin},
                                      .stiffness = 500});
    }
    scene.settle();
    double t = 0;
    const auto next = [&] {
        t += 2e-3;  // rad: 0.1 m/s on a circle of 5 cm
        return at({0.05 * std::sin(t), 0.05 * std::cos(t), 0}, {0.1 * std::cos(t), -0.1 * std::sin(t), 0});
    };
    scene.evaluate(next(), dt);
    std::uint64_t evaluated = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(scene.evaluate(next(), dt));
        evaluated += scene.evaluated();
    }
    state.counters["evaluated"] = static_cast<double>(evaluated) / static_cast<double>(state.iterations());
}
void meshes_out_of_reach(benchmark::State& state) {
    meshes_apart(state, 0);
}
void turning_meshes_out_of_reach(benchmark::State& state) {
    meshes_apart(state, 1);
}
/// N shapes on circles at 0.2 m/s, whose pose and velocity an application sends 60 times a second, all at
/// once. Includes the cost of sending.
void carried_meshes_out_of_reach(benchmark::State& state) {
    const auto n = static_cast<std::uint32_t>(state.range(0));
    const auto every = static_cast<std::uint64_t>(state.range(1));  // cycles
    const Tetrahedron mesh;
    Scene scene({.representations = 1024, .probes = 1}, {});
    for (std::uint32_t i = 0; i < max_assets; ++i) scene.set_asset(i + 1, &mesh.mesh);
    Rng rng(1);
    constexpr double circle = 0.05, speed = 0.2;  // m, m/s
    std::vector<Vector> middles, arms;
    for (std::uint32_t i = 0; i < n; ++i) {
        const Vector out = direction(rng);
        middles.push_back(out * uniform(rng, 0.25, 0.45));
        arms.push_back(circle * out.cross(direction(rng)).normalized());
    }
    double t = 0;
    const auto shape = [&](std::uint32_t i) {
        const Vector out = middles[i].normalized(), arm = arms[i], other = out.cross(arm);
        const double angle = speed / circle * t;
        return Shape{
            .asset = i % max_assets + 1,
            .position = to_plain(Vector(middles[i] + std::cos(angle) * arm + std::sin(angle) * other)),
            .velocity = to_plain(Vector(speed / circle * (std::cos(angle) * other - std::sin(angle) * arm))),
            .angular_velocity = {0, 0, 1},
            .stiffness = 500};
    };
    for (std::uint32_t i = 0; i < n; ++i) (void)scene.add({i, 1}, shape(i));
    scene.settle();
    std::uint64_t cycle = 0, evaluated = 0;
    for (auto _ : state) {
        t += dt;
        if (++cycle % every == 0)
            for (std::uint32_t i = 0; i < n; ++i) (void)scene.update({i, 1}, shape(i));
        benchmark::DoNotOptimize(scene.evaluate(at({0.05 * std::sin(2 * t), 0.05 * std::cos(2 * t), 0}), dt));
        evaluated += scene.evaluated();
    }
    state.counters["evaluated"] = static_cast<double>(evaluated) / static_cast<double>(state.iterations());
}

void springs(benchmark::State& state) {
    Scene scene({.representations = 1024, .probes = 1}, {});
    for (std::uint32_t i = 0; i < state.range(0); ++i) {
        (void)scene.add({i, 1}, Spring{.anchor = {0.01 * i, 0, 0}, .stiffness = 100});
    }
    run(state, scene);
}

void two_probes_three_planes_four_springs(benchmark::State& state) {
    Scene scene = make_scene();
    (void)scene.place_probe(1, {.offset = {0.01, 0, 0}});
    add_corner(scene, 0, 1000);
    for (std::uint32_t i = 0; i < 4; ++i) {
        (void)scene.add({3 + i, 1},
                        Spring{.anchor = {0.01 * i, 0, 0}, .attach = {0, 0.01, 0}, .stiffness = 100},
                        {.probe = i % 2});
    }
    run(state, scene);
}

// Every one of N planes is updated, and all take effect in the next cycle.
const Limits device{.max_stiffness = 3105, .max_force = 8.5, .damping = 0.2, .mass = 0.15, .lag = 0.5e-3};

/// Five fingers on a desk of 1000 N/m, each a probe, with the servo's budget in each cycle: the load of all
/// of them, its eigenvalues, the scales.
void five_fingers_in_a_budget(benchmark::State& state) {
    Scene scene = make_scene(device);
    for (std::uint32_t finger = 0; finger < 5; ++finger) {
        (void)scene.place_probe(finger, {.offset = {0.01 * finger, 0, 0}});
        (void)scene.add({finger, 1}, Plane{.stiffness = 1000}, {.probe = finger});
    }
    scene.settle();
    HandBudget budget;
    Hand hand;
    for (auto _ : state) {
        scene.set_scales(budget.scales());
        benchmark::DoNotOptimize(scene.evaluate(hand(), dt));
        if (scene.load_bound().exceeds()) budget.advance(scene.load(), 0, dt);
    }
    state.counters["k of the hand, N/m"] = 5 * 1000 * budget.scales().contacts;
}

/// The alternative: a rigid glove. All contacts are one problem in the hand's displacement. So the desk acts
/// five times at one place, and the hand feels no more than one finger's stiffness.
void five_fingers_of_a_rigid_glove(benchmark::State& state) {
    Scene scene = make_scene(device);
    for (std::uint32_t finger = 0; finger < 5; ++finger)
        (void)scene.add({finger, 1}, Plane{.stiffness = 1000});
    run(state, scene);
    state.counters["k of the hand, N/m"] = scene.evaluate(at({0, 0, -1e-3}), 0).force.z() / 1e-3;
}

void batch_of_updates(benchmark::State& state) {
    const auto n = static_cast<std::uint32_t>(state.range(0));
    Scene scene({.representations = 1024, .probes = 1}, {});
    for (std::uint32_t i = 0; i < n; ++i) (void)scene.add({i, 1}, Plane{.offset = -0.1, .stiffness = 1000});
    Hand hand;
    scene.evaluate(hand(), dt);
    double offset = -0.1;
    for (auto _ : state) {
        offset = offset > -0.1 ? -0.1 : -0.09;
        for (std::uint32_t i = 0; i < n; ++i)
            (void)scene.update({i, 1}, Plane{.offset = offset, .stiffness = 1000});
        benchmark::DoNotOptimize(scene.evaluate(hand(), dt));
    }
    state.SetItemsProcessed(state.iterations() * n);
}

void put(Plane& plane, double height) {
    plane.offset = height;
}
void put(Shape& shape, double height) {
    shape.position.z = height;
}
void put(auto& solid, double height) {
    solid.center.z = height;
}

/// A thousand surfaces out of reach that are moved, each by so many bytes of its parameters, as in the entry
/// of a batch.
template <class R>
void batch_of_poses(benchmark::State& state, R surface, std::size_t bytes) {
    constexpr std::uint32_t n = 1000;
    const Tetrahedron mesh;
    Scene scene({.representations = 1024, .probes = 1}, {});
    scene.set_asset(1, &mesh.mesh);
    put(surface, -0.3);
    for (std::uint32_t i = 0; i < n; ++i) (void)scene.add({i, 1}, surface);
    Hand hand;
    scene.evaluate(hand(), dt);
    bool low = true;
    for (auto _ : state) {
        low = !low;
        put(surface, low ? -0.3 : -0.29);
        for (std::uint32_t i = 0; i < n; ++i) (void)scene.update({i, 1}, kind_of<R>, &surface, bytes);
        benchmark::DoNotOptimize(scene.evaluate(hand(), dt));
    }
    state.SetItemsProcessed(state.iterations() * n);
}

/// A thousand planes with a new stiffness.
void batch_of_stiffnesses(benchmark::State& state) {
    constexpr std::uint32_t n = 1000;
    Scene scene({.representations = 1024, .probes = 1}, {});
    Plane plane{.offset = -0.1, .stiffness = 1000};
    for (std::uint32_t i = 0; i < n; ++i) (void)scene.add({i, 1}, plane);
    Hand hand;
    scene.evaluate(hand(), dt);
    for (auto _ : state) {
        plane.stiffness = plane.stiffness < 1000 ? 1000 : 900;
        for (std::uint32_t i = 0; i < n; ++i) (void)scene.update({i, 1}, plane);
        benchmark::DoNotOptimize(scene.evaluate(hand(), dt));
    }
    state.SetItemsProcessed(state.iterations() * n);
}

/// N spheres in a cube of 0.2 m, sized so that about three are near (within half a radius) and one is
/// touched; a hand at 0.06 m/s. Percentiles of single cycles, minus an empty pair of clock readings.
void spheres(benchmark::State& state) {
    const auto n = static_cast<std::uint32_t>(state.range(0));
    Scene scene({.representations = n, .probes = 1}, {});
    Rng rng(1);
    const double radius = 0.2 * std::cbrt(3.0 * 3 / (4 * M_PI * n)) / 1.5;
    for (std::uint32_t i = 0; i < n; ++i) {
        const Vec3 center{uniform(rng, -0.1, 0.1), uniform(rng, -0.1, 0.1), uniform(rng, -0.1, 0.1)};
        (void)scene.add({i, 1}, Sphere{.center = center, .radius = radius, .stiffness = 500},
                        {.feedback = 0});
    }
    scene.settle();
    scene.evaluate(at({0, 0, 0}), dt);
    scene.index();
    std::vector<double> taken;
    std::vector<double> empty_pair;
    using Clock = std::chrono::steady_clock;
    const auto between_readings = [](auto work) {
        const auto begin = Clock::now();
        work();
        return std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
    };
    double t = 0;
    std::uint64_t evaluated = 0;
    for (auto _ : state) {
        t += dt;
        const Probe probe =
            at({0.06 * std::sin(t), 0.06 * std::sin(1.3 * t + 1), 0.06 * std::sin(0.7 * t + 2)});
        taken.push_back(between_readings([&] { benchmark::DoNotOptimize(scene.evaluate(probe, dt)); }));
        empty_pair.push_back(between_readings([] {}));
        evaluated += scene.evaluated();
    }
    std::sort(taken.begin(), taken.end());
    std::sort(empty_pair.begin(), empty_pair.end());
    const double clock = empty_pair[empty_pair.size() / 2];
    state.counters["median_ns"] = taken[taken.size() / 2] - clock;
    state.counters["p99_ns"] = taken[taken.size() * 99 / 100] - clock;
    state.counters["evaluated"] = static_cast<double>(evaluated) / static_cast<double>(taken.size());
}

BENCHMARK(empty);
BENCHMARK(spheres)->Arg(10)->Arg(100)->Arg(1000)->Arg(10000)->Arg(100000)->Iterations(100000);
BENCHMARK(one_plane);
BENCHMARK(corner_of_three);
BENCHMARK(corner_of_two_stiffnesses);
BENCHMARK(plane_while_fading);
BENCHMARK(plane_updated_every_cycle);
BENCHMARK(planes_out_of_reach)->Arg(16)->Arg(64)->Arg(256)->Arg(1000);
BENCHMARK(meshes_out_of_reach)->Arg(0)->Arg(1)->Arg(100)->Arg(1000);
BENCHMARK(turning_meshes_out_of_reach)->Arg(1)->Arg(100);
BENCHMARK(carried_meshes_out_of_reach)->Args({100, 1'000'000'000})->Args({100, 17});
BENCHMARK(springs)->Arg(1)->Arg(6)->Arg(64)->Arg(1000);
BENCHMARK(two_probes_three_planes_four_springs);
BENCHMARK(five_fingers_in_a_budget);
BENCHMARK(five_fingers_of_a_rigid_glove);
BENCHMARK(batch_of_updates)->Arg(10)->Arg(100)->Arg(1000);
BENCHMARK(batch_of_stiffnesses);
BENCHMARK_CAPTURE(batch_of_poses, planes, Plane{.stiffness = 1000}, geometry_bytes<Plane>());
BENCHMARK_CAPTURE(batch_of_poses, spheres, Sphere{.stiffness = 1000}, geometry_bytes<Sphere>());
BENCHMARK_CAPTURE(batch_of_poses, boxes, Box{.stiffness = 1000}, geometry_bytes<Box>());
BENCHMARK_CAPTURE(batch_of_poses, moving_shapes,
                  Shape{.asset = 1, .velocity = {0, 0, 0.01}, .stiffness = 1000}, geometry_bytes<Shape>());

}  // namespace

BENCHMARK_MAIN();
