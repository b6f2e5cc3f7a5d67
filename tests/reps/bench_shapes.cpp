// One contact of each curved surface, beside a plane and a sphere in the same run. Every iteration moves the
// probe along the same 64 points through the surface, from 2 mm outside to 2 mm inside.

#include <benchmark/benchmark.h>

#include <knurl/reps/cap.hpp>
#include <knurl/reps/capsule.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/torus.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

// `middle` is where the stroke crosses the surface, which faces (1, 0, 0) there.
template <class R>
void stroke(benchmark::State& state, const R& raw, const Vector& middle) {
    Rng rng(7);
    const R params = prepared(raw, {});
    typename R::State servo{};
    adopt(params, nullptr, servo, Probe{});
    std::vector<Probe> path;
    for (int i = 0; i < 64; ++i)
        path.push_back(
            at(middle + 0.002 * std::sin(i * M_PI / 32) * Vector::UnitX() + 1e-4 * direction(rng)));
    std::size_t next = 0;
    for (auto _ : state) {
        const Contact c = contact(params, servo, path[next++ & 63], dt);
        benchmark::DoNotOptimize(c.height);
        benchmark::DoNotOptimize(c.normal);
    }
}

const Vector origin = Vector::Zero(), side(0.02, 0, 0);
const Vec3 x = {1, 0, 0}, y = {0, 1, 0};

BENCHMARK_CAPTURE(stroke, sphere, Sphere{.radius = 0.02}, side);
BENCHMARK_CAPTURE(stroke, sphere_hollow, Sphere{.radius = 0.02, .side = Side::inside}, side);
BENCHMARK_CAPTURE(stroke, plane, Plane{.normal = x}, origin);
BENCHMARK_CAPTURE(stroke, cap_flat, Cap{.normal = x}, origin);
BENCHMARK_CAPTURE(stroke, cap_one_curvature, Cap{.normal = x, .curvature = -50}, origin);
BENCHMARK_CAPTURE(stroke, cap_beyond_its_rim, Cap{.normal = x, .curvature = -50}, Vector(0, 0.01, 0));
BENCHMARK_CAPTURE(stroke, cap_two_curvatures, Cap{.normal = x, .curvature = -50, .curvature2 = 20, .axis = y},
                  origin);
BENCHMARK_CAPTURE(stroke, capsule, Capsule{.radius = 0.02}, side);
BENCHMARK_CAPTURE(stroke, cylinder_wall, Cylinder{.radius = 0.02, .half_length = 0.02}, side);
BENCHMARK_CAPTURE(stroke, cylinder_end, Cylinder{.axis = x, .radius = 0.02, .half_length = 0.02}, side);
BENCHMARK_CAPTURE(stroke, cylinder_edge, Cylinder{.radius = 0.02, .half_length = 0.02},
                  Vector(0.02, 0, 0.02));
BENCHMARK_CAPTURE(stroke, torus, Torus{.radius = 0.015, .tube = 0.005}, side);

}  // namespace

BENCHMARK_MAIN();
