#pragma once
// What touches or crosses becomes one surface. The walk goes over edges, so it would pass below a sheet that
// shares no edge with its own.
//
//   pairs that are near ──> gaps shut ──> cut where they meet ──> drop what lies inside a body

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "build.hpp"

namespace knurl::build {

/// Two bodies with a common edge are two parts.
Parts find_parts(Links links, const SolidLinks& solid, Slices& slices);

struct Near {      // of the size, as lengths (m)
    double touch;  // points nearer than this are merged
    double gap;    // a gap this wide between two parts, face to face, is closed
    bool as_float;
};

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Do the faces meet other than in common corners and edges? `across`: an edge of one passes through the
/// other, or crosses an edge of it.
bool meet(const Faces& faces, std::uint32_t f, std::uint32_t g, bool across, double touch);

/// A piece of a face, and its face.
struct Piece {
    Triangle corners;
    std::uint32_t face;  // that it is of
    std::uint8_t flat;   // edges over which the surface continues in the same plane, a bit each
    bool meets;          // its face meets others; false: it is only split with those that do
    bool there;
};

/// Splits the faces of pairs that meet, and the faces around them, until they meet only in common corners and
/// edges. Returns the pieces of all `touched` faces, or an empty list if there is nothing to split. Nothing,
/// with nothing changed, if it takes more than `most`.
std::optional<std::vector<Piece>> cut(Faces& faces, const Pairs& pairs, const Near& near, std::size_t most,
                                      std::vector<bool>& touched, MeshNotes& notes, Slices& slices);

/// Drops walls between closed parts that lie on each other, and patches with changed faces whose front lies
/// inside closed parts. Returns how many faces. Nothing: the cuts are not sound, since a body would be open
/// without the faces, or one patch lies inside and outside.
std::optional<std::uint64_t> drop_inside(Faces& faces, const std::vector<std::uint32_t>& part,
                                         const std::vector<bool>& changed, const std::vector<bool>& closed,
                                         const Near& near, Slices& slices);

/// Performs all these steps. `crossed`: faces of one part may meet as well. nothing: no change. too_much:
/// more than `most`, and uncut. unsound: `faces` can no longer be used.
enum class United { nothing, changed, too_much, unsound };
United unite(Faces& faces, std::span<const MeshNode> nodes, const Parts& parts, bool crossed,
             const Near& near, std::size_t most, MeshNotes& notes, Slices& slices);

}  // namespace knurl::build
