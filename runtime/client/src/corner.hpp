#pragma once
// Where a surface is folded towards the hand, one plane would let the hand sink into the other side until the
// next update. So both sides (in the corner of a room all three) are sent together.

#include <span>
#include <vector>

#include "face.hpp"

namespace knurl::detail {

inline constexpr double beside = 1e-3;  // m at the hand, from a corner to the points at which its faces are
                                        // tested

/// `faces` holds the face that is sent in any case. Adds those of `candidates` that meet it in a concave
/// corner at the hand, up to max_faces in total, as the model has them right beside the corner. Nearest
/// points are ambiguous in a corner (behind both sides they are on its edge), so every pair is tested again
/// there:
///
///           | q_1      c: where all faces meet, nearest to the hand
///     free  |          q: on one face, 1 mm away from the others
///           c--q_2--   a corner, if the model has its foot at q, with that normal
///
/// `landing` is where the hand will be when the update acts. A face is not added if it would push there and
/// the model would not.
void add_corner(std::vector<Face>& faces, std::span<const Face> candidates, const Eigen::Vector3d& landing,
                double tolerance, Questions& questions);

/// Their normals are so similar that they are the same side of a corner.
bool same(const Face& a, const Face& b);

/// The two meet in a concave corner near the hand.
bool is_corner(const Face& a, const Face& b, const Eigen::Vector3d& hand, Questions& questions);

}  // namespace knurl::detail
