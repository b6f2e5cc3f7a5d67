#pragma once
// What a mesh file calls its materials, and what the hand is to feel of them.

#include <string>
#include <vector>

#include <knurl/geometry/asset.hpp>

namespace feel {

/// `settings`: "NAME=STIFFNESS[,DAMPING[,FRICTION]]", shares of what the whole is given; of the file's
/// `names` in their order, 1 for those that no setting names. Throws std::runtime_error: one line with what
/// is wrong.
std::vector<knurl::AssetMaterial> materials_of(const std::vector<std::string>& names,
                                               const std::vector<std::string>& settings);

}  // namespace feel
