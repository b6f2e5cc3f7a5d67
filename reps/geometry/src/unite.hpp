#pragma once
// What touches or crosses becomes one surface: the walk goes over edges, and below a sheet that shares no
// edge with its own it would pass unhindered.
//
//   pairs that are near ──> gaps shut ──> cut where they meet ──> what lies inside of a body goes

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "build.hpp"

namespace knurl::build {

/// Two bodies with an edge in common are two.
Parts find_parts(Links links, const SolidLinks& solid, Slices& slices);

struct Near {      // of the size, as lengths (m)
    double touch;  // what is nearer is one point
    double gap;    // so wide between two parts, face to face, is none
    bool as_float;
};

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// They meet otherwise than in corners and edges that they have in common. `across`: one's edge goes through
/// the other, or crosses an edge of it.
bool meet(const Faces& faces, std::uint32_t f, std::uint32_t g, bool across, double touch);

/// A face and where it comes from.
struct Piece {
    Triangle corners;
    std::uint32_t face;  // that it is of
    std::uint8_t flat;   // edges over which its surface goes on level, a bit each
    bool meets;          // its face meets others, and is not only split with those that do
    bool there;
};

/// Splits the faces of pairs that meet, and those around them, until they meet in common corners and edges
/// alone. Gives the pieces of all faces that `touched` then says, or none if there is nothing to split. Nothing,
/// and nothing changed, if it takes more than `most`.
std::optional<std::vector<Piece>> cut(Faces& faces, const Pairs& pairs, const Near& near, std::size_t most,
                                      std::vector<bool>& touched, MeshNotes& notes, Slices& slices);

/// Drops walls between closed parts that lie on each other, and patches with changed faces whose front lies
/// inside of closed parts. Returns how many faces. Nothing: the cuts are not sound, since a body would be open
/// without them, or one patch lies inside and outside.
std::optional<std::uint64_t> drop_inside(Faces& faces, const std::vector<std::uint32_t>& part,
                                         const std::vector<bool>& changed, const std::vector<bool>& closed,
                                         const Near& near, Slices& slices);

/// All of that. `crossed`: faces of one part may meet as well. nothing: nothing to do, nothing changed. too_much:
/// more than `most`, and uncut. unsound: `faces` are of no use any more.
enum class United { nothing, changed, too_much, unsound };
United unite(Faces& faces, std::span<const MeshNode> nodes, const Parts& parts, bool crossed,
             const Near& near, std::size_t most, MeshNotes& notes, Slices& slices);

}  // namespace knurl::build
