// Planes: the error of each method against the nearest free point, in random corners with the probe up to 10
// mm inside.

#include <cstdio>
#include <cstdlib>

#include "../kkt.hpp"
#include "panel.hpp"
#include "plane_methods.hpp"

namespace knurl::error {
namespace {

using test::PlaneSet;
using test::Rng;

/// One corner, and a stroke of 64 points of 0.1 mm in it. In both precisions.
struct Scene {
    PlaneSet set;
    std::vector<Eigen::Vector3d> path;
    std::vector<Vector<long double>> exact;  // dx at each point
    std::vector<float> fnx, fny, fnz, fc;
    Eigen::Vector3d free;  // a point that no plane violates
};

bool inside(const PlaneSet& set, const Eigen::Vector3d& p) {
    std::vector<double> s(set.size());
    return shift_to_probe(set.nx.data(), set.ny.data(), set.nz.data(), set.c.data(), set.size(), p,
                          s.data()) > 1e-4;
}

/// The oracle: a set of touching planes that the KKT conditions prove, in long double.
Vector<long double> exact_at(PlaneSet& set, const Eigen::Vector3d& p) {
    set.probe = p;
    const PlaneSet::Shifted at = set.shifted();
    ContactSolution guess;
    solve_contact(at.planes, at.worst, 0, guess);
    const test::Kkt proof = test::kkt(at.planes, guess.active);
    if (proof.violation > 1e-13L * proof.size || proof.weight < -1e-13L * proof.size) {
        std::fprintf(stderr, "knurl_bench_error: the reference does not satisfy the KKT conditions\n");
        std::exit(1);
    }
    return proof.x;
}

Scene make_scene(Rng& rng, int count) {
    Scene scene;
    const Eigen::Vector3d axis = test::direction(rng), side = test::direction(rng);
    do {
        scene.set = PlaneSet{};
        for (int i = 0; i < count; ++i) {
            Eigen::Vector3d n;
            do {
                n = test::direction(rng);
            } while (n.dot(axis) < std::cos(80 * M_PI / 180));
            scene.set.add(n, test::uniform(rng, -2e-3, 0));
        }
        scene.set.probe = -test::uniform(rng, 3e-3, 10e-3) * axis;
    } while (!inside(scene.set, scene.set.probe + 1e-4 * side) ||
             !inside(scene.set, scene.set.probe - 1e-4 * side));
    const Eigen::Vector3d centre = scene.set.probe;
    for (int i = 0; i < 64; ++i) {
        scene.path.push_back(centre + 1e-4 * std::sin(i * M_PI / 32) * side);
        scene.exact.push_back(exact_at(scene.set, scene.path.back()));
    }
    for (std::uint32_t i = 0; i < scene.set.size(); ++i) {
        const Eigen::Vector3f n = scene.set.normal(i).cast<float>();
        scene.fnx.push_back(n.x()), scene.fny.push_back(n.y()), scene.fnz.push_back(n.z());
        scene.fc.push_back(static_cast<float>(scene.set.c[i]));
    }
    scene.free = 0.1 * axis;
    return scene;
}

/// State that a method may keep between calls.
struct Memory {
    std::vector<double> s, multiplier;
    std::vector<float> fs, fmultiplier;
    ContactSolution solution;
    ActiveSetMethod<double> plain;
    ActiveSetMethod<float> small;
};

template <class Real>
Shifted<Real> shift(const Scene& scene, const Eigen::Vector3d& p, Memory& memory);

template <>
Shifted<double> shift(const Scene& scene, const Eigen::Vector3d& p, Memory& memory) {
    const PlaneSet& set = scene.set;
    for (std::uint32_t i = 0; i < set.size(); ++i)
        memory.s[i] = set.c[i] - (set.nx[i] * p.x() + set.ny[i] * p.y() + set.nz[i] * p.z());
    return {set.nx.data(), set.ny.data(), set.nz.data(), memory.s.data(), set.size()};
}
// Shifted in double first: the error of float coordinates would exceed all others.
template <>
Shifted<float> shift(const Scene& scene, const Eigen::Vector3d& p, Memory& memory) {
    const PlaneSet& set = scene.set;
    for (std::uint32_t i = 0; i < set.size(); ++i)
        memory.fs[i] =
            static_cast<float>(set.c[i] - (set.nx[i] * p.x() + set.ny[i] * p.y() + set.nz[i] * p.z()));
    return {scene.fnx.data(), scene.fny.data(), scene.fnz.data(), memory.fs.data(), set.size()};
}

template <class Real>
std::vector<Real>& multipliers(Memory& memory) {
    if constexpr (std::is_same_v<Real, double>)
        return memory.multiplier;
    else
        return memory.fmultiplier;
}

using Method = Eigen::Vector3d (*)(const Scene&, const Eigen::Vector3d&, Memory&);

// In one pass: a sum reads each plane once.
template <class Real>
Eigen::Vector3d by_sum(const Scene& scene, const Eigen::Vector3d& p, Memory&) {
    if constexpr (std::is_same_v<Real, double>) {
        const PlaneSet& set = scene.set;
        return naive_sum<double>({set.nx.data(), set.ny.data(), set.nz.data(), set.c.data(), set.size()}, p);
    } else {
        return naive_sum<float>(
                   {scene.fnx.data(), scene.fny.data(), scene.fnz.data(), scene.fc.data(), scene.set.size()},
                   p.cast<float>())
            .cast<double>();
    }
}
template <class Real, int sweeps>
Eigen::Vector3d by_hildreth(const Scene& scene, const Eigen::Vector3d& p, Memory& memory) {
    return hildreth(shift<Real>(scene, p, memory), sweeps, multipliers<Real>(memory)).template cast<double>();
}
template <class Real>
Eigen::Vector3d by_projections(const Scene& scene, const Eigen::Vector3d& p, Memory& memory) {
    return sequential_projections(shift<Real>(scene, p, memory), 10).template cast<double>();
}
template <class Real>
Eigen::Vector3d by_proxy(const Scene& scene, const Eigen::Vector3d& p, Memory& memory) {
    return three_step_proxy<Real>(shift<Real>(scene, p, memory), (scene.free - p).cast<Real>())
        .template cast<double>();
}
template <bool warm>
Eigen::Vector3d by_active_set(const Scene& scene, const Eigen::Vector3d& p, Memory& memory) {
    const PlaneSet& set = scene.set;
    const double worst = shift_to_probe(set.nx.data(), set.ny.data(), set.nz.data(), set.c.data(), set.size(),
                                        p, memory.s.data());
    if (!warm) memory.solution.active.count = 0;
    double give = 0;
    solve_contact_relaxed({set.nx.data(), set.ny.data(), set.nz.data(), memory.s.data(), set.size()}, worst,
                          give, memory.solution);
    return memory.solution.dx;
}
// Without Knurl's shortcuts, to compare the precisions.
template <class Real, bool warm>
Eigen::Vector3d by_plain_active_set(const Scene& scene, const Eigen::Vector3d& p, Memory& memory) {
    auto& method = [&]() -> auto& {
        if constexpr (std::is_same_v<Real, double>)
            return memory.plain;
        else
            return memory.small;
    }
    ();
    if (!warm) method.count = 0;
    return method.solve(shift<Real>(scene, p, memory)).template cast<double>();
}

struct Entry {
    const char* name;
    Method method;
    bool knurl = false;
};
constexpr Entry entries[] = {
    {"naive sum", by_sum<double>},
    {"naive sum, float", by_sum<float>},
    {"10 Hildreth sweeps", by_hildreth<double, 10>},
    {"10 Hildreth sweeps, float", by_hildreth<float, 10>},
    {"100 Hildreth sweeps", by_hildreth<double, 100>},
    {"100 Hildreth sweeps, float", by_hildreth<float, 100>},
    {"10 sweeps of projections", by_projections<double>},
    {"10 sweeps of projections, float", by_projections<float>},
    {"3-step proxy", by_proxy<double>},
    {"3-step proxy, float", by_proxy<float>},
    {"plain active set, cold", by_plain_active_set<double, false>},
    {"plain active set, cold, float", by_plain_active_set<float, false>},
    {"plain active set, warm", by_plain_active_set<double, true>},
    {"plain active set, warm, float", by_plain_active_set<float, true>},
    {"active set, cold", by_active_set<false>},
    {"active set, warm", by_active_set<true>, true},
};

}  // namespace

Panel planes(const measure::Stopwatch& watch) {
    Panel panel{.name = "planes",
                .error_unit = "m",
                .error_meaning = "largest distance from the nearest free point",
                .exact = 1e-12,
                .points = {}};
    Rng rng(1);
    for (const int count : {1, 2, 3, 6, 16, 64, 256}) {
        std::vector<Scene> scenes;
        for (int i = 0; i < 32; ++i) scenes.push_back(make_scene(rng, count));
        std::vector<Point> points;
        std::vector<Memory> memories;
        for (const Entry& entry : entries) {
            double error = 0;
            Memory fresh;
            fresh.s.resize(static_cast<std::size_t>(count));
            fresh.fs.resize(static_cast<std::size_t>(count));
            for (const Scene& scene : scenes) {
                Memory memory = fresh;
                for (std::size_t i = 0; i < scene.path.size(); i += 4) {
                    const Eigen::Vector3d dx = entry.method(scene, scene.path[i], memory);
                    error = std::max(error,
                                     static_cast<double>((dx.cast<long double>() - scene.exact[i]).norm()));
                }
            }
            points.push_back({.scene = std::to_string(count) + (count == 1 ? " plane" : " planes"),
                              .size = static_cast<double>(count),
                              .implementation = entry.name,
                              .error = error,
                              .knurl = entry.knurl});
            memories.push_back(fresh);
        }
        std::vector<Contender> contenders;
        for (std::size_t e = 0; e < std::size(entries); ++e) {
            contenders.push_back({&points[e], [&, e, next = std::size_t{0}](int calls) mutable {
                                      // A stroke in one corner, then the next corner.
                                      for (int i = 0; i < calls; ++i, ++next) {
                                          const Scene& scene = scenes[(next >> 6) % scenes.size()];
                                          keep(entries[e].method(scene, scene.path[next & 63], memories[e]));
                                      }
                                  }});
        }
        race(watch, contenders);
        panel.points.insert(panel.points.end(), points.begin(), points.end());
    }
    return panel;
}

}  // namespace knurl::error
