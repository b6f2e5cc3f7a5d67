// The time of a proxy's cycle on a mesh: strokes at 0.1 to 0.3 m/s that press 1 to 3 mm, and pokes, at 1
// kHz, on bumpy spheres of 1k to 1M faces. Warm: the fastest of three times eight repeats of each cycle.
// Cold: once, after 48 MiB were written. The same run measures other methods on the same path.
//
//   knurl_bench_walk [most faces]

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/geometry/proxy.hpp>

#include "active_set.hpp"
#include "bench/caches.hpp"
#include "generators.hpp"
#include "mesh_surface.hpp"
#include "paths.hpp"

#if defined(KNURL_EMBREE)
#include "bench/embree_scene.hpp"
#endif

namespace {

using namespace knurl;
using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;

double nanoseconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::nano>(to - from).count();
}

/// The time of reading the clock itself.
double clock_cost() {
    double least = 1e9;
    for (int i = 0; i < 10000; ++i) {
        const auto a = Clock::now();
        const auto b = Clock::now();
        least = std::min(least, nanoseconds(a, b));
    }
    return least;
}

struct Times {
    std::vector<double> ns;
    double at(double share) {
        if (ns.empty()) return NAN;
        std::sort(ns.begin(), ns.end());
        return ns[std::min(ns.size() - 1, static_cast<std::size_t>(share * static_cast<double>(ns.size())))];
    }
    void print(const char* what, std::size_t faces) {
        std::printf("%9zu  %-28s %8.0f %8.0f %9.0f  (%zu cycles)\n", faces, what, at(0.5), at(0.99), at(1),
                    ns.size());
    }
};

/// Restores the state, so that a cycle can be repeated: eight times between two clock readings.
template <class State, class Do>
double time_cycle(State& state, double clock, bool cold, Do&& cycle) {
    const State before = state;
    if (cold) {
        test::flush_caches();
        const auto a = Clock::now();
        cycle();
        return nanoseconds(a, Clock::now()) - clock;
    }
    double best = 1e18;
    for (int repeat = 0; repeat < 3; ++repeat) {
        const auto a = Clock::now();
        for (int i = 0; i < 8; ++i) {
            state = before;
            cycle();
        }
        best = std::min(best, (nanoseconds(a, Clock::now()) - clock) / 8);
    }
    return best;
}

std::vector<test::Hand> hands_on(const test::MadeMesh& shape, int strokes, int pokes) {
    test::Hands hands(shape, 7);
    std::vector<test::Hand> all;
    for (int i = 0; i < strokes; ++i) all.push_back(hands.stroke());
    for (int i = 0; i < pokes; ++i) all.push_back(hands.poke());
    return all;
}

void walk_on(const Asset& mesh, std::size_t faces, const std::vector<test::Hand>& hands, double clock,
             bool cold, double radius, const std::string& name) {
    Times touching, free;
    for (const auto& hand : hands) {
        Proxy proxy;
        Foot foot;
        Work work;
        std::size_t step = 0;
        for (const auto& p : hand) {
            const Vector3d h(p[0], p[1], p[2]);
            if (cold && ++step % 64 != 0) {
                follow(mesh, proxy, h, radius, foot, work);
                continue;
            }
            bool touches = false;
            const double ns =
                time_cycle(proxy, clock, cold, [&] { touches = follow(mesh, proxy, h, radius, foot, work); });
            (touches ? touching : free).ns.push_back(ns);
        }
    }
    touching.print((name + " touching").c_str(), faces);
    free.print((name + " free").c_str(), faces);
}

/// The method of Zilles and Salisbury in every cycle, on the same faces and tree.
void active_set_on(const Mesh& mesh, const std::vector<test::Hand>& hands, double clock) {
    const MeshData& data = mesh.data();
    const detail::MeshSurface<Face> surface(data, data.faces.data(), data.faces.size());
    Times touching;
    for (const auto& hand : hands) {
        const auto local = [&](const std::array<double, 3>& p) {
            return detail::to_vec(Vector3d(p[0], p[1], p[2]) - data.origin);
        };
        detail::Vec at = local(hand.front());
        for (const auto& p : hand) {
            const detail::Vec h = local(p);
            detail::Held held;
            Work work;
            const double ns = time_cycle(work, clock, false, [&] { held = hold(surface, at, h, work); });
            if (held.faces > 0) touching.ns.push_back(ns);
            at = held.at;
        }
    }
    touching.print("active set touching", mesh.faces());
}

/// The time of a single cold memory access, including code and page table.
void look_cold(std::size_t bytes, double clock) {
    const auto memory = std::make_unique<char[]>(bytes);
    std::fill_n(memory.get(), bytes, char{1});
    Times look;
    int sum = 0;
    for (std::size_t i = 0; i < 500; ++i) {
        const char* at = &memory[(i * 7919 * 4096) % bytes];
        look.ns.push_back(
            time_cycle(sum, clock, true, [&] { sum += *static_cast<const volatile char*>(at); }));
    }
    look.print("a look at memory, cold", 0);
}

// Around the mesh at a distance, where the hand is free.
void hover_over(const Mesh& mesh, double clock) {
    Times free;
    Proxy proxy;
    Foot foot;
    Work work;
    for (int i = 0; i < 20000; ++i) {
        const double angle = i * 2e-3;
        const Vector3d h = 0.13 * Vector3d(std::cos(angle), std::sin(angle), 0.3 * std::sin(3 * angle));
        free.ns.push_back(time_cycle(proxy, clock, false, [&] { follow(mesh, proxy, h, 0, foot, work); }));
    }
    free.print("walk, free, 3 cm away", mesh.faces());
}

// In every cycle the hand jumps by 20 mm, near the surface. Prints the least disturbed of three equal runs.
void throw_about(const Mesh& mesh, const test::MadeMesh& shape, double clock) {
    Times best;
    for (int run = 0; run < 3; ++run) {
        Times thrown;
        test::Rng rng(5);
        Proxy proxy;
        Foot foot;
        Work work;
        const auto& from = shape.vertices[0];
        Vector3d at(from[0], from[1], from[2]);
        for (int i = 0; i < 20000; ++i) {
            Vector3d step(test::between(rng, -1, 1), test::between(rng, -1, 1), test::between(rng, -1, 1));
            at += 0.02 * step.normalized();
            at *= (0.1 + test::between(rng, -0.004, 0.002)) / at.norm();
            thrown.ns.push_back(
                time_cycle(proxy, clock, false, [&] { follow(mesh, proxy, at, 0, foot, work); }));
        }
        if (run == 0 || thrown.at(1) / thrown.at(0.999) < best.at(1) / best.at(0.999)) best = thrown;
    }
    std::printf("%9zu  %-28s %8.0f %8.0f %9.0f  (99.9 %%: %.0f; most is %.2f times that)\n", mesh.faces(),
                "walk, thrown about by 20 mm", best.at(0.5), best.at(0.99), best.at(1), best.at(0.999),
                best.at(1) / best.at(0.999));
}

#if defined(KNURL_EMBREE)
void embree_on(const test::MadeMesh& shape, const std::vector<test::Hand>& hands, double clock, bool cold) {
    const test::EmbreeScene embree(shape);
    Times point, sweep;
    float sum = 0;
    for (const auto& hand : hands) {
        for (std::size_t i = 1; i < hand.size(); i += cold ? 64 : 1) {
            const Vector3d from(hand[i - 1][0], hand[i - 1][1], hand[i - 1][2]),
                to(hand[i][0], hand[i][1], hand[i][2]);
            point.ns.push_back(time_cycle(sum, clock, cold, [&] { sum += embree.nearest(to).distance; }));
            sweep.ns.push_back(time_cycle(sum, clock, cold, [&] { sum += embree.sweep(from, to); }));
        }
    }
    point.print(cold ? "Embree point query, cold" : "Embree point query", shape.triangles.size());
    sweep.print(cold ? "Embree sweep, cold" : "Embree sweep", shape.triangles.size());
    if (sum == 0.1f) std::puts("");
}
#endif

// The same triangles as a height field and as a mesh: 403 by 344 heights, 0.5 mm apart.
void height_field(double clock) {
    constexpr std::uint32_t columns = 403, rows = 344;
    constexpr double cell = 0.0005;
    std::vector<float> heights;
    test::MadeMesh shape;
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            double z = 0;
            for (int k = 1; k < 9; ++k)
                z +=
                    0.004 / k * std::sin(0.011 * k * (i * std::cos(k * 1.7) + j * std::sin(k * 1.7)) + k * k);
            heights.push_back(static_cast<float>(z));
            shape.vertices.push_back({i * cell, j * cell, heights.back()});
            if (i + 1 == columns || j + 1 == rows) continue;
            const std::uint32_t a = j * columns + i;
            shape.triangles.push_back({a, a + 1, a + 1 + columns});
            shape.triangles.push_back({a, a + 1 + columns, a + columns});
        }
    }
    const HeightField field(heights, {columns, rows, cell, cell, {0, 0, 0}});
    const Mesh mesh({.vertices = shape.vertices, .triangles = shape.triangles},
                    {.budget = std::size_t{1} << 30, .find_crossings = false});
    const auto hands = hands_on(shape, 40, 60);
    std::printf("height field: %.2f bytes a triangle; as a mesh %.1f\n",
                double(field.bytes()) / double(field.faces()), double(mesh.bytes()) / double(mesh.faces()));
    walk_on(field, field.faces(), hands, clock, false, 0, "height field");
    walk_on(field, field.faces(), hands, clock, true, 0, "height field, cold,");
    walk_on(mesh, mesh.faces(), hands, clock, false, 0, "as a mesh");
    walk_on(mesh, mesh.faces(), hands, clock, true, 0, "as a mesh, cold,");
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t most = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 2'000'000;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const double clock = clock_cost();
    std::printf("the clock's own %.0f ns are taken off\n", clock);
#if !defined(KNURL_EMBREE)
    std::puts("WITHOUT EMBREE: built without it; install libembree-dev, then configure again");
#endif
    std::printf("%9s  %-28s %8s %8s %9s\n", "faces", "ns", "median", "99 %", "most");
    look_cold(std::size_t{64} << 20, clock);
    if (most >= 276'000) height_field(clock);
    for (const int subdivisions : {3, 5, 6, 7, 8}) {
        if ((std::size_t{20} << 2 * subdivisions) > most) break;
        const test::MadeMesh shape = test::noisy_sphere(subdivisions, 0.1, 3);
        const auto hands = hands_on(shape, 40, 60);
        const Mesh mesh({.vertices = shape.vertices, .triangles = shape.triangles},
                        {.budget = std::size_t{1} << 30, .find_crossings = false});
        walk_on(mesh, mesh.faces(), hands, clock, false, 0, "walk");
        walk_on(mesh, mesh.faces(), hands, clock, true, 0, "walk, cold,");
        walk_on(mesh, mesh.faces(), hands, clock, false, 0.002, "ball of 2 mm");
        active_set_on(mesh, hands, clock);
        throw_about(mesh, shape, clock);
        hover_over(mesh, clock);
#if defined(KNURL_EMBREE)
        embree_on(shape, hands, clock, false);
        embree_on(shape, hands, clock, true);
#endif
    }
}
