#include "raw_mesh.hpp"

#include <cmath>
#include <map>

namespace knurl::test {

void RawMesh::add(const RawMesh& other) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void RawMesh::move(const Point3& by) {
    for (Point3& p : vertices)
        for (std::size_t k = 0; k < 3; ++k) p[k] += by[k];
}

void RawMesh::scale(double by) {
    for (Point3& p : vertices)
        for (double& x : p) x *= by;
}

RawMesh RawMesh::unwelded() const {
    RawMesh out;
    for (const Triangle& t : triangles) {
        const auto first = static_cast<std::uint32_t>(out.vertices.size());
        for (const std::uint32_t v : t) out.vertices.push_back(vertices[v]);
        out.triangles.push_back({first, first + 1, first + 2});
    }
    return out;
}

RawMesh raw_sphere(int subdivisions, double radius, double bumps) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    RawMesh m{{{-1, g, 0},
               {1, g, 0},
               {-1, -g, 0},
               {1, -g, 0},
               {0, -1, g},
               {0, 1, g},
               {0, -1, -g},
               {0, 1, -g},
               {g, 0, -1},
               {g, 0, 1},
               {-g, 0, -1},
               {-g, 0, 1}},
              {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
               {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
               {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
    for (int i = 0; i < subdivisions; ++i) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [it, added] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(m.vertices.size()));
            if (added) {
                const Point3 p = m.vertices[a], q = m.vertices[b];
                m.vertices.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
            }
            return it->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : m.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        m.triangles = finer;
    }
    for (Point3& p : m.vertices) {
        const double length = std::hypot(p[0], p[1], p[2]);
        const double bump = std::sin(20 * p[0] / length) * std::cos(17 * p[1] / length);
        for (double& x : p) x *= radius * (1 + bumps * bump) / length;
    }
    return m;
}

RawMesh raw_box(double x, double y, double z) {
    return {{{0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0}, {0, 0, z}, {x, 0, z}, {x, y, z}, {0, y, z}},
            {{0, 2, 1},
             {0, 3, 2},
             {4, 5, 6},
             {4, 6, 7},
             {0, 1, 5},
             {0, 5, 4},
             {1, 2, 6},
             {1, 6, 5},
             {2, 3, 7},
             {2, 7, 6},
             {3, 0, 4},
             {3, 4, 7}}};
}

RawMesh raw_grid(int nx, int ny, double step) {
    RawMesh m;
    for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i) m.vertices.push_back({i * step, j * step, 0});
    const auto at = [nx](int i, int j) { return static_cast<std::uint32_t>(j * (nx + 1) + i); };
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return m;
}

RawMesh raw_cone(int sides) {
    RawMesh m{{{0, 0, 0.1}, {0, 0, 0}}, {}};
    for (int i = 0; i < sides; ++i)
        m.vertices.push_back(
            {0.05 * std::cos(2 * M_PI * i / sides), 0.05 * std::sin(2 * M_PI * i / sides), 0});
    const auto n = static_cast<std::uint32_t>(sides);
    for (std::uint32_t i = 0; i < n; ++i) {
        m.triangles.push_back({0, 2 + i, 2 + (i + 1) % n});
        m.triangles.push_back({1, 2 + (i + 1) % n, 2 + i});
    }
    return m;
}

RawMesh raw_strip(int quads, bool twisted) {
    RawMesh m;
    for (int i = 0; i < quads; ++i) {
        const double at = 2 * M_PI * i / quads, lean = twisted ? at / 2 : 0;
        for (const double side : {-0.01, 0.01}) {
            const double r = 0.05 + side * std::sin(lean);
            m.vertices.push_back({r * std::cos(at), r * std::sin(at), side * std::cos(lean)});
        }
    }
    const auto n = static_cast<std::uint32_t>(2 * quads);
    for (std::uint32_t i = 0; i < n; i += 2) {
        std::uint32_t c = (i + 2) % n, d = (i + 3) % n;
        if (twisted && i + 2 == n) std::swap(c, d);
        m.triangles.push_back({i, c, d});
        m.triangles.push_back({i, d, i + 1});
    }
    return m;
}

double between(std::mt19937_64& random, double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

RawMesh raw_soup(std::mt19937_64& random, int triangles, double length) {
    RawMesh m;
    for (int t = 0; t < triangles; ++t) {
        const Point3 middle{between(random, 0, 1), between(random, 0, 1), between(random, 0, 1)};
        const auto first = static_cast<std::uint32_t>(m.vertices.size());
        for (int i = 0; i < 3; ++i) {
            Point3 p = middle;
            for (double& x : p) x += between(random, -length, length);
            m.vertices.push_back(p);
        }
        m.triangles.push_back({first, first + 1, first + 2});
    }
    return m;
}

}  // namespace knurl::test
