#include "spoiled.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace knurl::test {

namespace {

bool chosen(Rng& rng, double share) {
    return between(rng, 0, 1) < share;
}
MadeMesh spoiled(MadeMesh s, const char* how) {
    s.name += std::string(", ") + how;
    return s;
}

}  // namespace

MadeMesh unwelded(const MadeMesh& s) {
    MadeMesh out{.name = s.name + ", unwelded", .vertices = {}, .triangles = {}};
    for (const auto& t : s.triangles) {
        const auto first = static_cast<std::uint32_t>(out.vertices.size());
        for (const std::uint32_t v : t) out.vertices.push_back(s.vertices[v]);
        out.triangles.push_back({first, first + 1, first + 2});
    }
    return out;
}

MadeMesh jittered(const MadeMesh& s, double by, Rng& rng) {
    MadeMesh out = spoiled(s, "jittered");
    for (auto& v : out.vertices) {
        for (double& x : v) x += between(rng, -by, by);
    }
    return out;
}

MadeMesh duplicated(const MadeMesh& s, double share, Rng& rng) {
    MadeMesh out = spoiled(s, "faces twice");
    for (const auto& t : s.triangles) {
        if (chosen(rng, share)) out.triangles.push_back({t[1], t[2], t[0]});
    }
    return out;
}

MadeMesh with_degenerate(const MadeMesh& s, double share, Rng& rng) {
    MadeMesh out = spoiled(s, "degenerate faces");
    for (const auto& t : s.triangles) {
        if (!chosen(rng, share)) continue;
        const exact::V a = s.at(t[0]), b = s.at(t[1]);
        switch (below(rng, 3)) {
            case 0:
                out.triangles.push_back({t[0], t[0], t[0]});
                break;
            case 1:
                out.triangles.push_back({t[0], t[1], t[0]});
                break;
            default: {  // three vertices on a line
                const std::uint32_t between_them = out.add(0.5L * (a + b));
                out.triangles.push_back({t[0], between_them, t[1]});
            }
        }
    }
    return out;
}

MadeMesh with_t_junctions(const MadeMesh& s, double share, Rng& rng) {
    MadeMesh out{.name = s.name + ", t-junctions", .vertices = s.vertices, .triangles = {}};
    for (const auto& t : s.triangles) {
        if (!chosen(rng, share)) {
            out.triangles.push_back(t);
            continue;
        }
        const std::size_t i = below(rng, 3);
        const std::uint32_t a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3];
        const std::uint32_t middle = out.add(0.5L * (s.at(a) + s.at(b)));
        out.triangles.push_back({a, middle, c});
        out.triangles.push_back({middle, b, c});
    }
    return out;
}

MadeMesh flipped(const MadeMesh& s, double share, Rng& rng) {
    MadeMesh out = spoiled(s, "some turned");
    for (auto& t : out.triangles) {
        if (chosen(rng, share)) std::swap(t[1], t[2]);
    }
    return out;
}

MadeMesh shuffled(const MadeMesh& s, Rng& rng) {
    MadeMesh out = spoiled(s, "shuffled");
    std::vector<std::uint32_t> place(s.vertices.size());
    std::iota(place.begin(), place.end(), 0U);
    for (std::size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[below(rng, i)]);
    for (std::size_t i = 0; i < place.size(); ++i) out.vertices[place[i]] = s.vertices[i];
    for (auto& t : out.triangles) t = {place[t[0]], place[t[1]], place[t[2]]};
    for (std::size_t i = out.triangles.size(); i > 1; --i) {
        std::swap(out.triangles[i - 1], out.triangles[below(rng, i)]);
    }
    return out;
}

MadeMesh with_hole_of_nan(const MadeMesh& s, std::uint32_t vertex) {
    MadeMesh out = spoiled(s, "a vertex that is not a number");
    out.vertices[vertex][1] = std::numeric_limits<double>::quiet_NaN();
    return out;
}

MadeMesh with_far_vertex(const MadeMesh& s) {
    MadeMesh out = spoiled(s, "a vertex at 1e30");
    out.vertices.push_back({1e30, -1e30, 1e30});
    out.triangles.push_back({0, 1, static_cast<std::uint32_t>(out.vertices.size() - 1)});
    return out;
}

MadeMesh without_vertex(const MadeMesh& s, std::uint32_t vertex) {
    MadeMesh out{.name = s.name + ", a hole", .vertices = s.vertices, .triangles = {}};
    for (const auto& t : s.triangles) {
        if (std::find(t.begin(), t.end(), vertex) == t.end()) out.triangles.push_back(t);
    }
    return out;
}

MadeMesh scaled(const MadeMesh& s, double by) {
    MadeMesh out = s;
    out.name += " x " + std::to_string(by);
    for (auto& v : out.vertices) {
        for (double& x : v) x *= by;
    }
    return out;
}

MadeMesh moved(const MadeMesh& s, const exact::V& by) {
    MadeMesh out = s;
    out.name += ", " + std::to_string(static_cast<double>(exact::length(by))) + " m away";
    for (auto& v : out.vertices) {
        v = {static_cast<double>(v[0] + by.x), static_cast<double>(v[1] + by.y),
             static_cast<double>(v[2] + by.z)};
    }
    return out;
}

}  // namespace knurl::test
