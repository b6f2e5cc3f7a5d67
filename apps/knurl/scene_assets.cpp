#include "scene_assets.hpp"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/measure/progress.hpp>
#include <knurl/meshfile/mesh_file.hpp>
#include <knurl/meshfile/unit.hpp>

namespace knurl::cli {

namespace {

using scenefile::AssetEntry;

std::unique_ptr<Mesh> mesh_of_file(const std::string& scene, const AssetEntry& entry,
                                   std::vector<std::string>& notes) {
    if (entry.unit.empty())
        throw std::runtime_error("a mesh has no unit of its own; write unit = \"mm\", or cm, m, in, um");
    const knurl::meshfile::Unit unit = knurl::meshfile::unit_of(entry.unit);
    knurl::meshfile::MeshFile file =
        knurl::meshfile::load_mesh((std::filesystem::path(scene).parent_path() / entry.mesh).string());
    notes = file.notes;
    for (Point3& vertex : file.vertices)
        for (double& x : vertex) x *= unit.metres;
    const auto built = [&] {
        return std::make_unique<Mesh>(file.triangles_of(), MeshBuild{.exact = entry.exact});
    };
    auto mesh = built();
    const std::size_t turned = entry.inside ? 0 : knurl::meshfile::turn_inside_out(file, *mesh);
    if (turned == 0) return mesh;
    notes.push_back(
        fmt::format("{} wound inside out and turned; inside = true keeps it so",
                    turned == 1 ? "a closed part was" : fmt::format("{} closed parts were", turned)));
    return built();
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
            std::vector<std::string> notes;
            auto mesh = !entry.mesh.empty() ? mesh_of_file(scene.path, entry, notes)
                                            : std::make_unique<Mesh>(Triangles{.vertices = entry.vertices,
                                                                               .triangles = entry.triangles},
                                                                     MeshBuild{.exact = entry.exact});
            for (std::string& line : knurl::meshfile::notes_of(mesh->notes()))
                notes.push_back(std::move(line));
            for (const std::string& line : notes) built.remarks.push_back(fmt::format("{}: {}", where, line));
            built.assets.push_back(std::move(mesh));
        } catch (const std::exception& error) {
            throw std::runtime_error(fmt::format("{}: {}", where, error.what()));
        }
    }
    return built;
}

}  // namespace knurl::cli
