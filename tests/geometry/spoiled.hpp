#pragma once
// Spoils good meshes in the ways in which meshes from outside are faulty. The surface stays in place, so the
// good mesh determines what the hand should feel.

#include "generators.hpp"

namespace knurl::test {

MadeMesh unwelded(const MadeMesh&);                             // each triangle has vertices of its own
MadeMesh jittered(const MadeMesh&, double by, Rng&);            // m, each vertex in any direction
MadeMesh duplicated(const MadeMesh&, double share, Rng&);       // faces are given twice
MadeMesh with_degenerate(const MadeMesh&, double share, Rng&);  // with triangles that are lines or points
// with vertices on an edge of one face that its other face does not have
MadeMesh with_t_junctions(const MadeMesh&, double share, Rng&);
MadeMesh flipped(const MadeMesh&, double share, Rng&);
MadeMesh shuffled(const MadeMesh&, Rng&);                          // triangles and vertices in another order
MadeMesh with_hole_of_nan(const MadeMesh&, std::uint32_t vertex);  // the vertex is NaN: its faces are lost
MadeMesh with_far_vertex(const MadeMesh&);                         // one more face, with a vertex at 1e30 m
MadeMesh without_vertex(const MadeMesh&, std::uint32_t vertex);    // without the vertex's faces
MadeMesh scaled(const MadeMesh&, double by);
MadeMesh moved(const MadeMesh&, const exact::V& by);

}  // namespace knurl::test
