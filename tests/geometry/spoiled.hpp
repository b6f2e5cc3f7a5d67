#pragma once
// What is wrong with meshes that come from outside, done to good ones: the surface stays where it was, so the
// good one says what should be felt.

#include "generators.hpp"

namespace knurl::test {

Shape unwelded(const Shape&);                              // each triangle has vertices of its own
Shape jittered(const Shape&, double by, Rng&);             // m, each vertex in any direction
Shape duplicated(const Shape&, double share, Rng&);        // faces told twice
Shape with_degenerate(const Shape&, double share, Rng&);   // triangles that are lines and points added
Shape with_t_junctions(const Shape&, double share, Rng&);  // a vertex on an edge that its other face has not
Shape flipped(const Shape&, double share, Rng&);
Shape shuffled(const Shape&, Rng&);                          // triangles and vertices in another order
Shape with_hole_of_nan(const Shape&, std::uint32_t vertex);  // not a number: its faces are lost
Shape with_far_vertex(const Shape&);                         // at 1e30 m, of one more face
Shape without_vertex(const Shape&, std::uint32_t vertex);    // its faces left out
Shape scaled(const Shape&, double by);
Shape moved(const Shape&, const exact::V& by);

}  // namespace knurl::test
