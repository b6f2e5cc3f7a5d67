// Representations: of one claim, and of a scene in this process.

#include <stdexcept>

#include <benchmark/benchmark.h>

#include <knurl/reps/plane.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/spring.hpp>

#include "lab.hpp"
#include "rig.hpp"

namespace knurl::servo::scaling {

namespace {

using measure::Growth;

/// The n-th of them; `random` is the same for all sizes.
using Adds = std::function<void(OfflineClaim&, int n, std::mt19937_64& random)>;

double uniform(std::mt19937_64& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

struct Kind {
    const char* name;
    Growth design;
    const char* why;
    bool touched;
    Adds add;
};

Plane tilted(std::mt19937_64& random, double offset) {
    const Vec3 normal{uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5), 1};
    return {.normal = normal, .offset = offset, .stiffness = 20};
}

const Kind kinds[] = {
    {"representations.planes.far", Growth::linear, "a plane has no end: each is asked", false,
     [](OfflineClaim& claim, int, std::mt19937_64& random) { claim.add(tilted(random, -1)); }},
    {"representations.planes.near", Growth::linear,
     "each is asked; the joint solution looks at each some times", true,
     [](OfflineClaim& claim, int, std::mt19937_64& random) { claim.add(tilted(random, 1)); }},
    {"representations.spheres.far", Growth::linear, "all are scanned, but only when the hand has come nearer",
     false,
     [](OfflineClaim& claim, int, std::mt19937_64& random) {
         claim.add(
             Sphere{.center = {uniform(random, 1, 1.2), uniform(random, 1, 1.2), uniform(random, 1, 1.2)},
                    .radius = 0.01,
                    .stiffness = 20});
     }},
    {"representations.springs", Growth::linear, "each pulls, and says how much", true,
     [](OfflineClaim& claim, int n, std::mt19937_64&) {
         claim.add(Spring{.anchor = {1e-4 * n, 0, 0}, .stiffness = 0.1});
     }},
};

/// Spheres in a cube of 0.2 m, sized so that about three are near (within half a radius) and one is touched
/// by a hand that moves among them; or none, 1 m away.
struct Spheres {
    Scene scene;
    Eigen::Vector3d beside = Eigen::Vector3d::Zero();
    double t = 0;
    std::uint64_t asked = 0;

    Spheres(double size, bool near)
        : scene({.representations = static_cast<std::uint32_t>(size), .probes = 1}, Limits{}) {
        if (!near) beside = {1, 0, 0};
        std::mt19937_64 random(1);
        const auto place = [&random] { return uniform(random, -0.1, 0.1); };
        const double radius = 0.2 * std::cbrt(3.0 * 3 / (4 * M_PI * size)) / 1.5;
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(size); ++i)
            (void)scene.add({i, 1},
                            Sphere{.center = {place(), place(), place()}, .radius = radius, .stiffness = 500},
                            {.feedback = 0});
        scene.settle();
        cycle();
        scene.index();
    }
    void cycle() {
        constexpr double dt = 1e-3;
        t += dt;
        const Probe probe{.position = beside + 0.06 * Eigen::Vector3d(std::sin(t), std::sin(1.3 * t + 1),
                                                                      std::sin(0.7 * t + 2))};
        benchmark::DoNotOptimize(scene.evaluate(probe, dt));
        asked += scene.evaluated();
    }
};

}  // namespace

std::vector<Series> representations(Lab& lab) {
    std::vector<Series> axis;
    for (const Kind& kind : kinds) {
        Series series{.name = kind.name,
                      .axis = "representations of a claim",
                      .design = kind.design,
                      .why = kind.why,
                      .points = {}};
        std::vector<double> sizes = geometric(1, protocol::max_representations, 2);
        sizes.insert(sizes.begin(), 0);
        for (const double n : sizes) {
            const auto rig = std::make_shared<Rig>();
            OfflineClaim& claim = rig->claim(protocol::max_representations);
            std::mt19937_64 random(1);
            for (int i = 0; i < static_cast<int>(n); ++i) {
                kind.add(claim, i, random);
                rig->step();
            }
            claim.commit();
            rig->step();
            for (const protocol::Reply& reply : claim.replies())
                if (reply.code != 0) throw std::runtime_error(series.name + ": one was refused");
            if (n > 0 && kind.touched != rig->touching())
                throw std::runtime_error(series.name +
                                         (kind.touched ? ": nothing is touched" : ": one is touched"));
            // In silence they would fade, so the application commits before every stretch.
            series.points.push_back(
                {.n = n,
                 .sample =
                     [rig, &claim,
                      cycles = lab.in_a_row([rig] { rig->step(); }, lab.options().quick ? 20 : 50)] {
                         claim.commit();
                         rig->step();
                         return cycles();
                     },
                 .samples = 5});
        }
        axis.push_back(std::move(series));
    }
    lab.measure(axis);
    return axis;
}

std::vector<Series> scenes(Lab& lab) {
    std::vector<Series> axis = {{.name = "scene.spheres.near",
                                 .axis = "spheres in a scene",
                                 .design = Growth::logarithmic,
                                 .why = "a tree finds the three that are near",
                                 .points = {}},
                                {.name = "scene.spheres.far",
                                 .axis = "spheres in a scene",
                                 .design = Growth::constant,
                                 .why = "none is asked until the hand has come nearer",
                                 .points = {}}};
    const bool quick = lab.options().quick;
    for (Series& series : axis)
        for (const double n : geometric(10, quick ? 10'000 : 100'000, std::sqrt(10.0))) {
            const auto spheres = std::make_shared<Spheres>(n, &series == &axis[0]);
            series.points.push_back(
                {.n = n,
                 .sample = lab.in_a_row([spheres] { spheres->cycle(); }, quick ? 100 : 1000),
                 .samples = 5});
        }
    lab.measure(axis);
    return axis;
}

}  // namespace knurl::servo::scaling
