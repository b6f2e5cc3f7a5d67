#pragma once
// What pairing asks of its neighbours.

#include <span>

#include "build.hpp"

namespace knurl::build {

/// Turns faces so that each agrees with those over its edges; `links` are then old. Throws MeshError if a
/// part has one side only.
void orient(Faces& faces, const Links& links, MeshNotes& notes, Slices& slices);

/// Links the half-edges of an edge where more than two faces meet, each to the first that it sees.
void pair_radially(const Faces& faces, std::span<const Link> halves, Links& links, Slices& slices);

}  // namespace knurl::build
