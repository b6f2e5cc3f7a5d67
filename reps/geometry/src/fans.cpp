// The faces around each vertex, as the walk reaches them: over edges. Where they form several fans, or one
// that is too large, the walk sees several vertices, and a flag on these faces says so.

#include <algorithm>
#include <span>

#include <Eigen/Geometry>

#include <knurl/geometry/proxy.hpp>

#include "build.hpp"

namespace knurl::build {
namespace {

// The corner where the link's edge starts stands for the fan's face: face << 2 | corner.
using Corner = Link;

Corner onwards(const Links& links, Corner c) {  // over the edge that ends there
    return links[face_of(c)][(edge_of(c) + 2) % 3];
}
Corner back(const Links& links, Corner c) {  // over the edge that begins there
    const Link over = links[face_of(c)][edge_of(c)];
    return over == no_link ? no_link : link_to(face_of(over), (edge_of(over) + 1) % 3);
}

Eigen::Vector3d unit_normal(const Faces& faces, std::uint32_t f) {
    const Triangle& t = faces.corners[f];
    const auto at = [&](std::size_t k) { return Eigen::Vector3d(faces.at[t[k]].data()); };
    return (at(1) - at(0)).cross(at(2) - at(0)).normalized();
}

/// Cuts a fan, in its order, so that no piece has more than max_fan faces. Cuts where it is flattest, since
/// there the missing neighbour's normal has the least effect.
void cut(const Faces& faces, Links& links, std::span<const Corner> fan, bool closed, Slices& slices) {
    const std::size_t n = fan.size();
    const auto flatness = [&](std::size_t i) {  // between face i and the next one
        slices(8);
        return unit_normal(faces, face_of(fan[i % n])).dot(unit_normal(faces, face_of(fan[(i + 1) % n])));
    };
    const auto flattest = [&](std::size_t begin, std::size_t end) {
        std::size_t best = begin;
        double most = flatness(begin);
        for (std::size_t i = begin + 1; i < end; ++i) {
            if (const double flat = flatness(i); flat > most) most = flat, best = i;
        }
        return best;
    };
    const auto open = [&](std::size_t i) {
        Link& here = links[face_of(fan[i % n])][(edge_of(fan[i % n]) + 2) % 3];
        links[face_of(here)][edge_of(here)] = no_link;
        here = no_link;
    };
    std::size_t last = 0, end = n;  // the faces from last up to end are connected
    if (closed) {
        const std::size_t i = flattest(0, n);
        open(i);
        last = i + 1;
        end = last + n;
    }
    while (end - last > max_fan) {
        const std::size_t i = flattest(last + max_fan / 2, last + max_fan);
        open(i);
        last = i + 1;
    }
}

/// The fan that a corner is of, from it onwards, in order if it is larger than max_fan; `seen` says so of each of
/// its corners. True: it is closed.
bool collect(const Links& links, Corner seed, std::vector<Corner>& fan, std::vector<bool>& seen,
             Slices& slices) {
    fan.assign(1, seed);
    seen[seed] = true;
    Corner at = onwards(links, seed);
    for (; at != no_link && at != seed; at = onwards(links, at), slices()) {
        fan.push_back(at);
        seen[at] = true;
    }
    if (at == seed) return true;
    const std::size_t ahead = fan.size();
    for (at = back(links, seed); at != no_link; at = back(links, at), slices()) {
        fan.push_back(at);
        seen[at] = true;
    }
    if (fan.size() > max_fan) {  // those behind the seed come before it, the last first
        std::rotate(fan.begin(), fan.begin() + static_cast<std::ptrdiff_t>(ahead), fan.end());
        std::reverse(fan.begin(), fan.end() - static_cast<std::ptrdiff_t>(ahead));
    }
    return false;
}

/// Adds the vertices of edges without a neighbour.
void add_borders(const Faces& faces, const Links& links, std::vector<bool>& vertices, Slices& slices) {
    for (std::size_t f = 0; f < links.size(); ++f, slices()) {
        for (std::size_t e = 0; e < 3; ++e) {
            if (links[f][e] == no_link)
                vertices[faces.corners[f][e]] = vertices[faces.corners[f][(e + 1) % 3]] = true;
        }
    }
}

}  // namespace

std::vector<std::uint8_t> split_fans(const Faces& faces, Links& links, MeshNotes& notes, Slices& slices) {
    slices.ask();
    std::vector<bool> seen(links.size() * 4), once(faces.at.size()), several(faces.at.size());
    std::vector<Corner> fan;
    for (std::uint32_t f = 0; f < links.size(); ++f) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            const Corner seed = link_to(f, c);
            if (seen[seed]) continue;
            const bool closed = collect(links, seed, fan, seen, slices);
            slices();
            const std::uint32_t v = faces.corners[f][c];
            if (once[v] || fan.size() > max_fan) {
                notes.vertices_split += !several[v];
                several[v] = true;
            }
            once[v] = true;
            if (fan.size() > max_fan) cut(faces, links, fan, closed, slices);
        }
    }
    // Flags all places where the walk may rest without seeing all faces: `several` now also marks borders.
    add_borders(faces, links, several, slices);
    std::vector<std::uint8_t> flags;
    flags.reserve(links.size());
    for (const Triangle& t : faces.corners) {
        slices();
        const bool rim = several[t[0]] || several[t[1]] || several[t[2]];
        flags.push_back(rim ? std::uint8_t{face_rim} : std::uint8_t{0});
    }
    return flags;
}

}  // namespace knurl::build
