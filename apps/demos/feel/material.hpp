#pragma once
// The names of a mesh file's materials, and the values that the hand gets for them.

#include <string>
#include <vector>

#include <knurl/geometry/asset.hpp>

namespace feel {

/// `settings`: "NAME=STIFFNESS[,DAMPING[,FRICTION]]", shares of the whole mesh's values. Returns one material
/// for each of the file's `names`, 1 where no setting names it. Throws std::runtime_error: one line with what
/// is wrong.
std::vector<knurl::AssetMaterial> materials_of(const std::vector<std::string>& names,
                                               const std::vector<std::string>& settings);

}  // namespace feel
