// Which face lies over which edge.

#include <algorithm>

#include "build.hpp"

namespace knurl::build {
namespace {

struct HalfEdge {
    std::uint32_t far;  // the greater of its two vertices
    Link link;
};

/// Half-edges by their edge: those of lesser vertex v from start[v] to start[v + 1], by the greater one.
struct Edges {
    std::vector<std::uint32_t> start;
    std::vector<HalfEdge> halves;
};

Edges collect(const Faces& faces, Slices& slices) {
    Edges edges;
    edges.start.resize(faces.at.size() + 1);
    for (const Triangle& t : faces.corners) {
        slices();
        for (std::size_t e = 0; e < 3; ++e) ++edges.start[std::min(t[e], t[(e + 1) % 3]) + 1];
    }
    for (std::size_t v = 0; v < faces.at.size(); ++v) edges.start[v + 1] += edges.start[v];
    edges.halves.resize(faces.corners.size() * 3);
    std::vector<std::uint32_t> next(edges.start.begin(), edges.start.end() - 1);
    for (std::uint32_t f = 0; f < faces.corners.size(); ++f, slices(2)) {
        const Triangle& t = faces.corners[f];
        for (std::uint32_t e = 0; e < 3; ++e) {
            const auto [near, far] = std::minmax(t[e], t[(e + 1) % 3]);
            edges.halves[next[near]++] = {far, link_to(f, e)};
        }
    }
    for (std::size_t v = 0; v < faces.at.size(); ++v) {
        std::sort(edges.halves.begin() + edges.start[v], edges.halves.begin() + edges.start[v + 1],
                  [&slices](const HalfEdge& a, const HalfEdge& b) {
                      slices();
                      return a.far != b.far ? a.far < b.far : a.link < b.link;
                  });
    }
    return edges;
}

}  // namespace

bool pair_edges(Faces& faces, Links& links, MeshNotes& notes, Slices& slices) {
    slices.ask();
    const Edges edges = collect(faces, slices);
    links.assign(faces.corners.size(), {no_link, no_link, no_link});
    for (std::uint32_t v = 0; v < faces.at.size(); ++v) {
        for (std::uint32_t i = edges.start[v]; i < edges.start[v + 1];) {
            std::uint32_t end = i + 1;
            while (end < edges.start[v + 1] && edges.halves[end].far == edges.halves[i].far) ++end;
            if (end - i == 2) {
                const Link a = edges.halves[i].link, b = edges.halves[i + 1].link;
                if (faces.corners[face_of(a)][edge_of(a)] != faces.corners[face_of(b)][edge_of(b)]) {
                    links[face_of(a)][edge_of(a)] = b;
                    links[face_of(b)][edge_of(b)] = a;
                }
            }
            if (end - i == 1) ++notes.edges_open;
            if (end - i > 2) ++notes.edges_non_manifold;
            slices(end - i);
            i = end;
        }
    }
    return false;
}

std::vector<std::uint8_t> split_fans(const Faces& faces, Links& links, MeshNotes&, Slices& slices) {
    slices.ask();
    std::vector<bool> border(faces.at.size());
    std::vector<std::uint8_t> flags(links.size());
    for (std::size_t f = 0; f < links.size(); ++f, slices()) {
        for (std::size_t e = 0; e < 3; ++e) {
            if (links[f][e] == no_link)
                border[faces.corners[f][e]] = border[faces.corners[f][(e + 1) % 3]] = true;
        }
    }
    for (std::size_t f = 0; f < links.size(); ++f, slices()) {
        for (const std::uint32_t v : faces.corners[f]) {
            if (border[v]) flags[f] |= face_rim;
        }
    }
    return flags;
}

void find_crossings(MeshData&, Slices&) {}

}  // namespace knurl::build
