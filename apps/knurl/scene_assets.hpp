#pragma once
// Builds the assets of a scene file in this process.

#include <memory>
#include <string>
#include <vector>

#include <knurl/geometry/asset.hpp>
#include <knurl/scenefile/scene_file.hpp>

namespace knurl::cli {

struct SceneAssets {
    std::vector<std::unique_ptr<Asset>> assets;  // 1, 2, ...
    std::vector<std::string> remarks;            // one line each: what was repaired
};

/// Throws std::runtime_error: one line with the place in the scene file, what is wrong and what to do.
SceneAssets build_assets(const scenefile::SceneFile& scene);

}  // namespace knurl::cli
