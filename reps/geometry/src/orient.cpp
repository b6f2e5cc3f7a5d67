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

/// Goes over the edges from face to face of one part after the other, each face as it has to be turned to agree
/// with the one before it.
class Orienter {
  public:
    Orienter(Faces& faces, const Links& links, Slices& slices)
        : faces_(faces), links_(links), slices_(slices), state_(links.size(), unseen) {}

    bool has_seen(std::uint32_t f) const { return state_[f] != unseen; }

    /// The part that this face is of; `one_sided` gets the faces that contradict what is known already.
    void find_part(std::uint32_t seed, Part& part, Named& one_sided) {
        state_[seed] = kept;
        part.faces.assign(1, seed);
        part.turned = 0, part.closed = true, part.volume = part.extent = 0;
        const Point3& middle = faces_.at[faces_.corners[seed][0]];
        for (std::size_t i = 0; i < part.faces.size(); ++i, slices_(4)) {
            const std::uint32_t f = part.faces[i];
            measure(f, middle, part);
            if (contradicted_over_edges(f, part)) one_sided.add(faces_.given[f]);
        }
    }

    /// Returns how many faces it turned over.
    std::uint64_t turn(const Part& part) {
        // A closed part is a body: its outside is the front. The rest as most of its faces say.
        const bool body = part.closed && std::abs(part.volume) > 1e-6 * part.extent;
        const bool other = body ? part.volume < 0 : 2 * part.turned > part.faces.size();
        std::uint64_t count = 0;
        for (const std::uint32_t f : part.faces) {
            slices_();
            if ((state_[f] == turned) == other) continue;
            std::swap(faces_.corners[f][1], faces_.corners[f][2]);
            ++count;
        }
        return count;
    }

  private:
    enum : std::uint8_t { unseen, kept, turned };

    void measure(std::uint32_t f, const Point3& middle, Part& part) const {
        const Triangle& t = faces_.corners[f];
        const double six = determinant(minus(faces_.at[t[0]], middle), minus(faces_.at[t[1]], middle),
                                       minus(faces_.at[t[2]], middle));
        part.volume += state_[f] == turned ? -six : six;
        part.extent += std::abs(six);
        part.turned += state_[f] == turned;
    }

    /// Adds the neighbours that are not seen yet to the part. True: one is turned as it must not be.
    bool contradicted_over_edges(std::uint32_t f, Part& part) {
        const Triangle& t = faces_.corners[f];
        bool contradicted = false;
        for (std::uint32_t e = 0; e < 3; ++e) {
            const Link over = links_[f][e];
            if (over == no_link) {
                part.closed = false;
                continue;
            }
            const std::uint32_t g = face_of(over);
            const bool alike = faces_.corners[g][edge_of(over)] != t[e];
            const auto right = alike ? state_[f] : static_cast<std::uint8_t>(kept + turned - state_[f]);
            if (state_[g] == unseen) {
                state_[g] = right;
                part.faces.push_back(g);
            }
            contradicted = contradicted || state_[g] != right;
        }
        return contradicted;
    }

    Faces& faces_;
    const Links& links_;
    Slices& slices_;
    std::vector<std::uint8_t> state_;  // of each face
};

}  // namespace

void orient(Faces& faces, const Links& links, MeshNotes& notes, Slices& slices) {
    slices.ask();
    Orienter orienter(faces, links, slices);
    Named one_sided;
    Part part;
    for (std::uint32_t seed = 0; seed < links.size(); ++seed, slices()) {
        if (orienter.has_seen(seed)) continue;
        orienter.find_part(seed, part, one_sided);
        if (part.turned > 0) notes.faces_turned += orienter.turn(part);
    }
    if (one_sided.count() > 0)
        throw MeshError(
            "the mesh has no front: " + one_sided.text() +
            " cannot be turned to agree with all neighbours (a Moebius strip?); cut the surface there, "
            "or give each edge at most two triangles that go on into each other");
}

}  // namespace knurl::build
