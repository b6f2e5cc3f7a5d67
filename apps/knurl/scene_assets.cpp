#include "scene_assets.hpp"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <mesh_file.hpp>
#include <progress.hpp>
#include <unit.hpp>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>

namespace knurl::cli {

namespace {

using scenefile::AssetEntry;

std::unique_ptr<Mesh> mesh_of_file(const std::string& scene, const AssetEntry& entry) {
    if (entry.unit.empty())
        throw std::runtime_error("a mesh has no unit of its own; write unit = \"mm\", or cm, m, in, um");
    const meshfile::Unit unit = meshfile::unit_of(entry.unit);
    meshfile::MeshFile file = [&] {
        const meshfile::ReadingLimit limit("knurl");
        return meshfile::load_mesh((std::filesystem::path(scene).parent_path() / entry.mesh).string());
    }();
    for (Point3& vertex : file.vertices)
        for (double& x : vertex) x *= unit.metres;
    return std::make_unique<Mesh>(file.triangles_of(), MeshBuild{.exact = entry.exact});
}

}  // namespace

SceneAssets build_assets(const scenefile::SceneFile& scene) {
    SceneAssets built;
    measure::Progress progress("knurl");
    for (const AssetEntry& entry : scene.assets) {
        const std::string where =
            fmt::format("{}:{}: asset {}", scene.path, entry.line, built.assets.size() + 1);
        progress.show(fmt::format("builds shape {} of {}", built.assets.size() + 1, scene.assets.size()));
        try {
            if (!entry.heights.empty()) {
                built.assets.push_back(std::make_unique<HeightField>(entry.heights, entry.grid));
                continue;
            }
            auto mesh = !entry.mesh.empty() ? mesh_of_file(scene.path, entry)
                                            : std::make_unique<Mesh>(Triangles{.vertices = entry.vertices,
                                                                               .triangles = entry.triangles},
                                                                     MeshBuild{.exact = entry.exact});
            for (const std::string& line : meshfile::notes_of(mesh->notes()))
                built.remarks.push_back(fmt::format("{}: {}", where, line));
            built.assets.push_back(std::move(mesh));
        } catch (const std::exception& error) {
            throw std::runtime_error(fmt::format("{}: {}", where, error.what()));
        }
    }
    return built;
}

}  // namespace knurl::cli
