// Which face lies over which edge.

#include <algorithm>
#include <memory>

#include "build.hpp"
#include "edges.hpp"

namespace knurl::build {
namespace {

struct Half {
    std::uint32_t far;  // the higher of its two vertices
    Link link;
};

/// Half-edges sorted by edge: those with lower vertex v from start[v] to start[v + 1], sorted by the higher
/// vertex.
struct Edges {
    std::vector<std::uint32_t> start;
    std::unique_ptr<Half[]> halves;  // a vector would touch all its pages at once
};

Edges collect(const Faces& faces, Slices& slices) {
    slices.ask();
    Edges edges;
    edges.start.resize(faces.at.size() + 1);
    for (const Triangle& t : faces.corners) {
        slices();
        for (std::size_t e = 0; e < 3; ++e) ++edges.start[std::min(t[e], t[(e + 1) % 3]) + 1];
    }
    for (std::size_t v = 0; v < faces.at.size(); ++v) edges.start[v + 1] += edges.start[v];
    edges.halves = std::make_unique_for_overwrite<Half[]>(faces.corners.size() * 3);
    std::vector<std::uint32_t> next(edges.start.begin(), edges.start.end() - 1);
    for (std::uint32_t f = 0; f < faces.corners.size(); ++f, slices(2)) {
        const Triangle& t = faces.corners[f];
        for (std::uint32_t e = 0; e < 3; ++e) {
            const auto [near, far] = std::minmax(t[e], t[(e + 1) % 3]);
            edges.halves[next[near]++] = {far, link_to(f, e)};
        }
    }
    for (std::size_t v = 0; v < faces.at.size(); ++v) {
        std::sort(edges.halves.get() + edges.start[v], edges.halves.get() + edges.start[v + 1],
                  [&slices](const Half& a, const Half& b) {
                      slices();
                      return a.far != b.far ? a.far < b.far : a.link < b.link;
                  });
    }
    return edges;
}

/// Calls `with(halves)` for each edge; its half-edges are in the order of their faces.
template <class With>
void for_each_edge(const Edges& edges, Slices& slices, With with) {
    std::vector<Link> halves;
    for (std::size_t v = 0; v + 1 < edges.start.size(); ++v) {
        const std::uint32_t last = edges.start[v + 1];
        for (std::uint32_t i = edges.start[v]; i < last;) {
            halves.clear();
            const std::uint32_t far = edges.halves[i].far;
            for (; i < last && edges.halves[i].far == far; ++i) halves.push_back(edges.halves[i].link);
            slices(static_cast<std::uint32_t>(halves.size()));
            with(std::span<const Link>(halves));
        }
    }
}

std::uint32_t from(const Faces& faces, Link half) {
    return faces.corners[face_of(half)][edge_of(half)];
}
std::uint32_t opposite(const Faces& faces, Link half) {
    return faces.corners[face_of(half)][(edge_of(half) + 2) % 3];
}

/// Drops all but the first of equal faces with equal winding. Each has an equal face over each of its edges.
bool drop_duplicates(Faces& faces, const Edges& edges, MeshNotes& notes, Slices& slices) {
    std::vector<bool> dropped;
    std::vector<Link> sorted;
    for_each_edge(edges, slices, [&](std::span<const Link> halves) {
        if (halves.size() < 2) return;
        if (halves.size() == 2 && opposite(faces, halves[0]) != opposite(faces, halves[1])) return;
        const auto key = [&](Link h) { return std::pair(opposite(faces, h), from(faces, h)); };
        sorted.assign(halves.begin(), halves.end());
        std::sort(sorted.begin(), sorted.end(), [&](Link a, Link b) {
            slices();
            return std::pair(key(a), a) < std::pair(key(b), b);
        });
        for (std::size_t i = 1; i < sorted.size(); ++i) {
            if (key(sorted[i]) != key(sorted[i - 1])) continue;
            dropped.resize(faces.corners.size());
            dropped[face_of(sorted[i])] = true;
        }
    });
    if (dropped.empty()) return false;
    std::size_t kept = 0;
    for (std::size_t f = 0; f < dropped.size(); ++f, slices()) {
        if (dropped[f]) continue;
        faces.corners[kept] = faces.corners[f];
        faces.given[kept++] = faces.given[f];
    }
    notes.faces_duplicate += dropped.size() - kept;
    faces.corners.resize(kept);
    faces.given.resize(kept);
    return true;
}

void link_up(Links& links, Link a, Link b) {
    links[face_of(a)][edge_of(a)] = b;
    links[face_of(b)][edge_of(b)] = a;
}

}  // namespace

Parts find_parts(const Links& links, Slices& slices) {
    Parts parts;
    constexpr std::uint32_t none = 0xffffffff;
    parts.of.assign(links.size(), none);
    std::vector<std::uint32_t> open;
    for (std::uint32_t seed = 0; seed < links.size(); ++seed, slices()) {
        if (parts.of[seed] != none) continue;
        const auto part = static_cast<std::uint32_t>(parts.closed.size());
        parts.closed.push_back(true);
        parts.of[seed] = part;
        open.push_back(seed);
        while (!open.empty()) {
            const std::uint32_t f = open.back();
            open.pop_back();
            slices(2);
            for (const Link over : links[f]) {
                if (over == no_link) {
                    parts.closed[part] = false;
                } else if (parts.of[face_of(over)] == none) {
                    parts.of[face_of(over)] = part;
                    open.push_back(face_of(over));
                }
            }
        }
    }
    return parts;
}

bool pair_edges(Faces& faces, Links& links, SolidLinks& solid, MeshNotes& notes, Slices& slices) {
    Edges edges = collect(faces, slices);
    if (drop_duplicates(faces, edges, notes, slices)) return true;

    const auto unlinked = [&] {
        links.clear();
        links.reserve(faces.corners.size());
        for (std::size_t f = 0; f < faces.corners.size(); ++f, slices())
            links.push_back({no_link, no_link, no_link});
    };
    unlinked();
    bool twisted = false;
    for_each_edge(edges, slices, [&](std::span<const Link> halves) {
        if (halves.size() != 2) return;
        link_up(links, halves[0], halves[1]);
        twisted = twisted || from(faces, halves[0]) == from(faces, halves[1]);
    });
    if (twisted) {
        orient(faces, links, notes, slices);
        edges = collect(faces, slices);
        unlinked();
    }
    SolidLinks pairs;
    solid.clear();
    for_each_edge(edges, slices, [&](std::span<const Link> halves) {
        if (halves.size() > 2) {
            ++notes.edges_non_manifold;
            pairs.clear();
            pair_radially(faces, halves, Through::space, pairs, slices);
            for (const auto& [a, b] : pairs) link_up(links, a, b);
            for (const Link h : halves) solid.emplace_back(h, no_link);
            pair_radially(faces, halves, Through::solid, solid, slices);
        } else if (halves.size() == 2 && twisted) {
            link_up(links, halves[0], halves[1]);
        }
        for (const Link h : halves) notes.edges_open += links[face_of(h)][edge_of(h)] == no_link;
    });
    notes.parts = find_parts(links, slices).closed.size();
    return false;
}

}  // namespace knurl::build
