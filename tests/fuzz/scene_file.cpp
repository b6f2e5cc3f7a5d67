// Any bytes as a scene file: refused in one line, or its whole content is within the bounds of a scene.

#include <cmath>
#include <cstdint>
#include <string>

#include <knurl/reps/bounds.hpp>
#include <knurl/reps/check.hpp>
#include <knurl/scenefile/scene_file.hpp>

#include "refusal.hpp"

using namespace knurl;
using fuzz::require;

namespace {

void check_change(const scenefile::SceneFile& scene, const scenefile::Change& change) {
    require(std::isfinite(change.at) && change.at >= 0, "a change has a time");
    require(change.item < scene.items, "a change is of an item");
    require(change.kind < kinds().size() && change.params.size() == kinds()[change.kind].size,
            "a change has the parameters of its kind");
    require(change.line > 0 && !change.id.empty(), "a change has a place in the file");
    require(!!check_added(change.kind, change.params.data(), change.params.size(), change.options),
            "the servo takes what the reader takes");
}

void check_asset(const scenefile::AssetEntry& asset) {
    require(asset.line > 0, "an asset has a place in the file");
    const int forms = !asset.mesh.empty() + !asset.triangles.empty() + !asset.heights.empty();
    require(forms == 1, "an asset has one form");
    for (const Triangle& triangle : asset.triangles)
        for (const std::uint32_t corner : triangle)
            require(corner < asset.vertices.size(), "a corner is one of the vertices");
    require(
        asset.heights.empty() || asset.heights.size() == std::size_t{asset.grid.columns} * asset.grid.rows,
        "each place of a grid has a height");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const scenefile::SceneFile scene =
            scenefile::parse_scene({reinterpret_cast<const char*>(data), size}, "s.toml");
        require(scene.assets.size() <= max_assets && scene.probes.size() <= Scene::max_probes,
                "a scene keeps to its bounds");
        for (const ProbePlacement& probe : scene.probes)
            require(std::isfinite(probe.radius) && probe.radius >= 0, "a probe has a radius");
        for (const scenefile::AssetEntry& asset : scene.assets) check_asset(asset);
        double before = 0;
        for (const scenefile::Change& change : scene.changes) {
            check_change(scene, change);
            require(change.at >= before, "changes are in order of time");
            before = change.at;
        }
        for (const std::string& remark : scene.remarks) fuzz::check_refusal(remark, "s.toml:");
    } catch (const scenefile::SceneError& error) {
        fuzz::check_refusal(error.what(), "s.toml:", 800);
    }
    return 0;
}
