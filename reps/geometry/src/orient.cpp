// Contradictory windings: compared from face to face over edges that two faces share.

#include <algorithm>
#include <cmath>

#include "edges.hpp"

namespace knurl::build {
namespace {

/// One part, starting at its first face.
struct Part {
    std::vector<std::uint32_t> faces;
    std::size_t turned = 0;  // faces wound against the first one
    bool closed = true;
    double volume = 0;  // 6 x m^3, if all faces are wound as the first
    double extent = 0;  // m^3, the sum of all absolute contributions
};

double determinant(const Point3& a, const Point3& b, const Point3& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

Point3 minus(const Point3& a, const Point3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

}  // namespace

void orient(Faces& faces, const Links& links, MeshNotes& notes, Slices& slices) {
    slices.ask();
    enum : std::uint8_t { unseen, kept, turned };
    std::vector<std::uint8_t> state(links.size(), unseen);
    Named one_sided;
    Part part;
    for (std::uint32_t seed = 0; seed < links.size(); ++seed, slices()) {
        if (state[seed] != unseen) continue;
        state[seed] = kept;
        part.faces.assign(1, seed);
        part.turned = 0, part.closed = true, part.volume = part.extent = 0;
        const Point3& middle = faces.at[faces.corners[seed][0]];
        for (std::size_t i = 0; i < part.faces.size(); ++i, slices(4)) {
            const std::uint32_t f = part.faces[i];
            const Triangle& t = faces.corners[f];
            const double six = determinant(minus(faces.at[t[0]], middle), minus(faces.at[t[1]], middle),
                                           minus(faces.at[t[2]], middle));
            part.volume += state[f] == turned ? -six : six;
            part.extent += std::abs(six);
            part.turned += state[f] == turned;
            bool contradicted = false;
            for (std::uint32_t e = 0; e < 3; ++e) {
                const Link over = links[f][e];
                if (over == no_link) {
                    part.closed = false;
                    continue;
                }
                const std::uint32_t g = face_of(over);
                const bool alike = faces.corners[g][edge_of(over)] != t[e];
                const auto right = alike ? state[f] : static_cast<std::uint8_t>(kept + turned - state[f]);
                if (state[g] == unseen) {
                    state[g] = right;
                    part.faces.push_back(g);
                }
                contradicted = contradicted || state[g] != right;
            }
            if (contradicted) one_sided.add(faces.given[f]);
        }
        if (part.turned == 0) continue;
        // A closed part is a body: its outside is the front. Other parts follow the majority of their faces.
        const bool body = part.closed && std::abs(part.volume) > 1e-6 * part.extent;
        const bool other = body ? part.volume < 0 : 2 * part.turned > part.faces.size();
        for (const std::uint32_t f : part.faces) {
            slices();
            if ((state[f] == turned) == other) continue;
            std::swap(faces.corners[f][1], faces.corners[f][2]);
            ++notes.faces_turned;
        }
    }
    if (one_sided.count() > 0)
        throw MeshError(
            "the mesh has no front: " + one_sided.text() +
            " cannot be turned to agree with all neighbours (a Moebius strip?); cut the surface there, "
            "or give each edge at most two triangles that go on into each other");
}

}  // namespace knurl::build
