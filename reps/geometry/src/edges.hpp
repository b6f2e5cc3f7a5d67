#pragma once
// The steps on which the pairing of edges depends.

#include <span>
#include <utility>
#include <vector>

#include "build.hpp"

namespace knurl::build {

/// Turns faces so that each agrees with those over its edges; `links` are then outdated. Throws MeshError if
/// a part has one side only.
void orient(Faces& faces, const Links& links, MeshNotes& notes, Slices& slices);

/// Pairs the half-edges of an edge where more than two faces meet: each with the first one that it sees in
/// front of it, or behind it. Two faces that lie on each other do not see each other.
enum class Through { space, solid };
void pair_radially(const Faces& faces, std::span<const Link> halves, Through through,
                   std::vector<std::pair<Link, Link>>& pairs, Slices& slices);

}  // namespace knurl::build
