#pragma once
// What is wrong with meshes that come from outside, done to good ones: the surface stays where it was, so the
// good one says what should be felt.

#include "generators.hpp"

namespace knurl::test {

MadeMesh unwelded(const MadeMesh&);                             // each triangle has vertices of its own
MadeMesh jittered(const MadeMesh&, double by, Rng&);            // m, each vertex in any direction
MadeMesh duplicated(const MadeMesh&, double share, Rng&);       // faces told twice
MadeMesh with_degenerate(const MadeMesh&, double share, Rng&);  // triangles that are lines and points added
// a vertex on an edge that its other face has not
MadeMesh with_t_junctions(const MadeMesh&, double share, Rng&);
MadeMesh flipped(const MadeMesh&, double share, Rng&);
MadeMesh shuffled(const MadeMesh&, Rng&);                          // triangles and vertices in another order
MadeMesh with_hole_of_nan(const MadeMesh&, std::uint32_t vertex);  // not a number: its faces are lost
MadeMesh with_far_vertex(const MadeMesh&);                         // at 1e30 m, of one more face
MadeMesh without_vertex(const MadeMesh&, std::uint32_t vertex);    // its faces left out
MadeMesh scaled(const MadeMesh&, double by);
MadeMesh moved(const MadeMesh&, const exact::V& by);

}  // namespace knurl::test
