#include "fetched.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>

namespace knurl::test {

std::optional<MadeMesh> fetched(const std::string& name) {
    const char* folder = std::getenv("KNURL_MESHES");
    std::ifstream file(std::string(folder != nullptr ? folder : KNURL_MESHES) + "/" + name + ".mesh",
                       std::ios::binary);
    char magic[8];
    std::uint32_t counts[2];
    if (!file.read(magic, 8) || std::memcmp(magic, "KNURLMSH", 8) != 0) return {};
    file.read(reinterpret_cast<char*>(counts), sizeof counts);
    MadeMesh s{.name = name, .vertices = {}, .triangles = {}};
    s.vertices.resize(counts[0]);
    s.triangles.resize(counts[1]);
    file.read(reinterpret_cast<char*>(s.vertices.data()), static_cast<std::streamsize>(counts[0]) * 24);
    file.read(reinterpret_cast<char*>(s.triangles.data()), static_cast<std::streamsize>(counts[1]) * 12);
    if (!file) return {};
    return s;
}

MadeMesh subdivided(const MadeMesh& s) {
    using exact::V;
    struct Edge {
        std::uint32_t vertex = 0;
        V opposite;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, Edge> edges;
    MadeMesh out{.name = s.name, .vertices = s.vertices, .triangles = {}};
    std::vector<V> around(s.vertices.size());
    std::vector<int> count(s.vertices.size());
    for (const auto& t : s.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i], b = t[(i + 1) % 3];
            edges[std::minmax(a, b)].opposite += s.at(t[(i + 2) % 3]);
            around[a] += s.at(b);  // each neighbour once: another face has the reversed edge
            ++count[a];
        }
    }
    for (auto& [ends, edge] : edges) {
        edge.vertex = out.add(0.375L * (s.at(ends.first) + s.at(ends.second)) + 0.125L * edge.opposite);
    }
    for (std::uint32_t v = 0; v < s.vertices.size(); ++v) {
        if (count[v] == 0) continue;
        const exact::Real n = count[v], c = 0.375L + std::cos(2 * exact::pi / n) / 4;
        const exact::Real share = (0.625L - c * c) / n;
        const V p = (1 - n * share) * s.at(v) + share * around[v];
        out.vertices[v] = {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
    }
    for (const auto& [a, b, c] : s.triangles) {
        const std::uint32_t ab = edges[std::minmax(a, b)].vertex, bc = edges[std::minmax(b, c)].vertex,
                            ca = edges[std::minmax(c, a)].vertex;
        for (const auto& t :
             {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}}) {
            out.triangles.push_back(t);
        }
    }
    return out;
}

}  // namespace knurl::test
