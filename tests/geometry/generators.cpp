#include "generators.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace knurl::test {

using exact::V;

void MadeMesh::append(const MadeMesh& other) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& t : other.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

double MadeMesh::size() const {
    std::array<double, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (const auto& v : vertices) {
        for (std::size_t i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], v[i]), high[i] = std::max(high[i], v[i]);
        }
    }
    return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

MadeMesh icosphere(int subdivisions, double radius) {
    MadeMesh s{.name = "icosphere", .vertices = {}, .triangles = {}};
    const exact::Real g = (1 + std::sqrt(exact::Real(5))) / 2;
    for (const V& v : {V{-1, g, 0}, V{1, g, 0}, V{-1, -g, 0}, V{1, -g, 0}, V{0, -1, g}, V{0, 1, g},
                       V{0, -1, -g}, V{0, 1, -g}, V{g, 0, -1}, V{g, 0, 1}, V{-g, 0, -1}, V{-g, 0, 1}}) {
        s.add(radius * exact::unit(v));
    }
    s.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                   {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                   {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int n = 0; n < subdivisions; ++n) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [found, fresh] = middles.try_emplace(std::minmax(a, b), 0);
            if (fresh) found->second = s.add(radius * exact::unit(s.at(a) + s.at(b)));
            return found->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        finer.reserve(4 * s.triangles.size());
        for (const auto& [a, b, c] : s.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const auto& t : {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c},
                                  std::array{ab, bc, ca}}) {
                finer.push_back(t);
            }
        }
        s.triangles = std::move(finer);
    }
    return s;
}

MadeMesh torus(int around, int across, double ring, double tube) {
    MadeMesh s{.name = "torus", .vertices = {}, .triangles = {}};
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / across;
            const double rho = ring + tube * std::cos(v);
            s.vertices.push_back({rho * std::cos(u), rho * std::sin(u), tube * std::sin(v)});
        }
    }
    const auto at = [&](int i, int j) {
        return static_cast<std::uint32_t>((i % around) * across + j % across);
    };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return s;
}

MadeMesh noisy_sphere(int subdivisions, double height, std::uint64_t seed, double radius) {
    MadeMesh s = icosphere(subdivisions, radius);
    s.name = "noisy sphere";
    Rng rng(seed);
    struct Wave {
        std::array<double, 3> k;
        double phase, height;
    };
    std::vector<Wave> waves;
    double sum = 0;
    for (int i = 0; i < 24; ++i) {
        const double many = 2 * std::pow(16, i / 23.0);  // waves around
        std::array<double, 3> k;
        for (double& x : k) x = between(rng, -1, 1) * many / radius;
        waves.push_back({k, between(rng, 0, 2 * M_PI), 1 / many});
        sum += waves.back().height;
    }
    for (auto& v : s.vertices) {
        double bump = 0;
        for (const Wave& w : waves) {
            bump += w.height * std::sin(w.k[0] * v[0] + w.k[1] * v[1] + w.k[2] * v[2] + w.phase);
        }
        for (double& x : v) x *= 1 + height * bump / sum;
    }
    return s;
}

MadeMesh hollow_sphere(int subdivisions) {
    MadeMesh s = icosphere(subdivisions, 0.1), inner = icosphere(subdivisions, 0.095);
    for (auto& t : inner.triangles) std::swap(t[1], t[2]);
    s.append(inner);
    s.name = "hollow sphere";
    return s;
}

MadeMesh blocks(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
                const Filled& filled) {
    MadeMesh s{.name = "blocks", .vertices = {}, .triangles = {}};
    const std::array<const std::vector<double>*, 3> lines{&x, &y, &z};
    const auto solid = [&](const std::array<int, 3>& c) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (c[i] < 0 || c[i] + 1 >= static_cast<int>(lines[i]->size())) return false;
        }
        return filled(c[0], c[1], c[2]);
    };
    std::map<std::array<int, 3>, std::uint32_t> known;
    const auto vertex = [&](const std::array<int, 3>& c) {
        const auto [found, fresh] = known.try_emplace(c, static_cast<std::uint32_t>(s.vertices.size()));
        if (fresh) {
            s.vertices.push_back({x[static_cast<std::size_t>(c[0])], y[static_cast<std::size_t>(c[1])],
                                  z[static_cast<std::size_t>(c[2])]});
        }
        return found->second;
    };
    std::array<int, 3> c;
    for (c[0] = 0; c[0] + 1 < static_cast<int>(x.size()); ++c[0]) {
        for (c[1] = 0; c[1] + 1 < static_cast<int>(y.size()); ++c[1]) {
            for (c[2] = 0; c[2] + 1 < static_cast<int>(z.size()); ++c[2]) {
                if (!solid(c)) continue;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    for (const int side : {0, 1}) {
                        std::array<int, 3> beyond = c;
                        beyond[axis] += side != 0 ? 1 : -1;
                        if (solid(beyond)) continue;
                        std::array<std::uint32_t, 4> q;
                        for (std::size_t i = 0; i < 4; ++i) {
                            std::array<int, 3> at = c;
                            at[axis] += side;
                            at[(axis + 1) % 3] += i == 1 || i == 2;
                            at[(axis + 2) % 3] += i >= 2;
                            q[i] = vertex(at);
                        }
                        if (side == 0) std::swap(q[1], q[3]);
                        s.triangles.push_back({q[0], q[1], q[2]});
                        s.triangles.push_back({q[0], q[2], q[3]});
                    }
                }
            }
        }
    }
    return s;
}

namespace {

std::vector<double> even(int divisions, double low, double high) {
    std::vector<double> at;
    for (int i = 0; i <= divisions; ++i) at.push_back(low + (high - low) * i / divisions);
    return at;
}
MadeMesh named(MadeMesh s, const char* name) {
    s.name = name;
    return s;
}

}  // namespace

MadeMesh cube(int divisions, double side) {
    const std::vector<double> at = even(divisions, -side / 2, side / 2);
    return named(blocks(at, at, at, [](int, int, int) { return true; }), "cube");
}

MadeMesh staircase() {
    return named(blocks(even(20, -0.1, 0.1), even(10, -0.05, 0.05), even(20, -0.1, 0.1),
                        [](int i, int, int k) { return k <= i; }),
                 "staircase");
}

MadeMesh comb() {
    std::vector<double> x;
    for (int tooth = 0; tooth <= 20; ++tooth) {
        x.push_back(-0.025 + 0.0025 * tooth);
        x.push_back(-0.025 + 0.0025 * tooth + 0.0005);
    }
    return named(blocks(x, even(10, -0.05, 0.05), even(6, -0.01, 0.02),
                        [](int i, int, int k) { return i % 2 == 0 || k < 2; }),
                 "comb");
}

MadeMesh thin_plate() {
    return named(blocks(even(40, -0.07, 0.07), even(40, -0.07, 0.07), {-0.00005, 0.00005},
                        [](int, int, int) { return true; }),
                 "thin plate");
}

MadeMesh needle_box() {
    return named(blocks(even(10, -0.05, 0.05), even(600, -0.003, 0.003), even(2, -0.01, 0.01),
                        [](int, int, int) { return true; }),
                 "needle box");
}

MadeMesh grid(int nx, int ny, double dx, double dy) {
    MadeMesh s{.name = "grid", .vertices = {}, .triangles = {}};
    for (int j = 0; j <= ny; ++j) {
        for (int i = 0; i <= nx; ++i) s.vertices.push_back({(i - nx / 2.0) * dx, (j - ny / 2.0) * dy, 0});
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (nx + 1) + i); };
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return s;
}

MadeMesh plane_grid() {
    return named(grid(20, 20, 0.002, 0.002), "plane grid");
}
MadeMesh needles() {
    return named(grid(4, 1000, 0.01, 1e-5), "needles");
}

MadeMesh crossing_sheets() {
    MadeMesh s = grid(20, 20, 0.0101, 0.0103);
    MadeMesh wall = grid(20, 20, 0.0107, 0.0109);
    for (auto& v : wall.vertices) v = {0, v[0], v[1]};  // the normal z becomes x
    s.append(wall);
    s.name = "crossing sheets";
    return s;
}

MadeMesh two_sided_sheet() {
    MadeMesh s = plane_grid();
    const auto front = s.triangles;
    for (const auto& t : front) s.triangles.push_back({t[0], t[2], t[1]});
    s.name = "two-sided sheet";
    return s;
}

MadeMesh three_sheets() {
    MadeMesh s = named(grid(10, 10, 0.01, 0.01), "three sheets");
    // A fin on the line x = 0, front to +x, whose lowest vertices are the floor's.
    std::array<std::array<std::uint32_t, 11>, 6> at;
    for (std::uint32_t j = 0; j <= 10; ++j) {
        at[0][j] = j * 11 + 5;
        for (std::uint32_t k = 1; k <= 5; ++k) at[k][j] = s.add(s.at(at[0][j]) + V{0, 0, 0.01L * k});
    }
    for (std::size_t k = 0; k < 5; ++k) {
        for (std::size_t j = 0; j < 10; ++j) {
            s.triangles.push_back({at[k][j], at[k][j + 1], at[k + 1][j + 1]});
            s.triangles.push_back({at[k][j], at[k + 1][j + 1], at[k + 1][j]});
        }
    }
    return s;
}

MadeMesh cubes_at_an_edge() {
    const std::vector<double> at = even(8, -0.04, 0.04), high = even(4, -0.02, 0.02);
    return named(blocks(at, at, high, [](int i, int j, int) { return (i < 4) == (j < 4); }),
                 "cubes at an edge");
}

MadeMesh cubes_at_a_corner() {
    const std::vector<double> at = even(8, -0.04, 0.04);
    return named(
        blocks(at, at, at, [](int i, int j, int k) { return (i < 4) == (j < 4) && (j < 4) == (k < 4); }),
        "cubes at a corner");
}

MadeMesh moebius() {
    MadeMesh s{.name = "moebius", .vertices = {}, .triangles = {}};
    constexpr std::uint32_t around = 64, across = 4;
    for (std::uint32_t i = 0; i < around; ++i) {
        const double u = 2 * M_PI * i / around;
        for (std::uint32_t j = 0; j <= across; ++j) {
            const double v = 0.01 * (j - 2.0), rho = 0.06 + v * std::cos(u / 2);
            s.vertices.push_back({rho * std::cos(u), rho * std::sin(u), v * std::sin(u / 2)});
        }
    }
    const auto at = [&](std::uint32_t i, std::uint32_t j) {  // after one turn the other side is up
        return i == around ? across - j : i * (across + 1) + j;
    };
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t j = 0; j < across; ++j) {
            s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return s;
}

std::vector<MadeMesh> clean_shapes(std::uint64_t seed) {
    std::vector<MadeMesh> all{icosphere(3),     torus(96, 48), noisy_sphere(5, 0.6, seed),
                              hollow_sphere(4), cube(10),      staircase(),
                              comb(),           thin_plate()};
    return all;
}

}  // namespace knurl::test
