#include "mesh_file.hpp"

#include <cmath>
#include <csignal>
#include <filesystem>
#include <stdexcept>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <unistd.h>

namespace meshfile {

namespace {

constexpr unsigned most_materials = 256;

[[noreturn]] void bad(const std::string& path, const std::string& text) {
    throw std::runtime_error(path + ": " + text);
}

/// Every mesh of the scene, wherever it stands in it.
void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, MeshFile& file) {
    const aiMatrix4x4 here = above * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
        const auto first = static_cast<std::uint32_t>(file.vertices.size());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D at = here * mesh.mVertices[v];
            file.vertices.push_back({double{at.x}, double{at.y}, double{at.z}});
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices < 3) {
                ++file.faces_of_other_kinds;
                continue;
            }
            // A polygon as a fan. (Assimp's own triangulation ends the program where a file is cut off.)
            for (unsigned i = 2; i < face.mNumIndices; ++i) {
                file.triangles.push_back(
                    {first + face.mIndices[0], first + face.mIndices[i - 1], first + face.mIndices[i]});
                file.materials.push_back(
                    static_cast<std::uint8_t>(std::min(mesh.mMaterialIndex, most_materials - 1)));
            }
        }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(scene, *node.mChildren[c], here, file);
}

}  // namespace

double MeshFile::size() const {
    Eigen::AlignedBox3d box;
    for (const knurl::Point3& v : vertices)
        if (std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]))
            box.extend(Eigen::Vector3d(v.data()));
    return box.isEmpty() ? 0 : box.diagonal().norm();
}

MeshFile load_mesh(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        bad(path, std::filesystem::exists(path, error) ? "is no file; give a mesh as STL, OBJ or PLY"
                                                       : "is not there; give the path of a mesh");
    Assimp::Importer importer;
    // Nothing is joined, split or smoothed here: the servo's builder does what is needed, and says so.
    const aiScene* scene = importer.ReadFile(path, 0);
    if (scene == nullptr || scene->mRootNode == nullptr) {
        std::string why = importer.GetErrorString();
        if (why.empty()) why = "no mesh in it";
        std::replace(why.begin(), why.end(), '\n', ' ');
        bad(path, fmt::format("cannot be read as a mesh ({}); is it whole, and an STL, OBJ or PLY?", why));
    }
    MeshFile file;
    file.path = path;
    const aiImporterDesc* format =
        importer.GetImporterInfo(static_cast<std::size_t>(importer.GetPropertyInteger("importerIndex", 0)));
    file.format = format != nullptr ? format->mName : "mesh";
    add(*scene, *scene->mRootNode, aiMatrix4x4(), file);
    if (file.triangles.empty())
        bad(path, file.vertices.empty() ? "holds nothing; give a file with triangles"
                                        : "holds points or lines but no triangle; give a surface");
    if (scene->mNumMaterials > most_materials)
        bad(path,
            fmt::format("has {} materials; at most {}: join some", scene->mNumMaterials, most_materials));
    for (unsigned m = 0; m < scene->mNumMaterials; ++m)
        file.material_names.emplace_back(scene->mMaterials[m]->GetName().C_Str());
    return file;
}

std::vector<std::string> notes_of(const knurl::MeshNotes& n) {
    std::vector<std::string> lines;
    const auto note = [&](std::uint64_t count, const char* what) {
        if (count > 0) lines.push_back(fmt::format("{} {}", count, what));
    };
    note(n.vertices_not_finite, "vertices are no numbers, or beyond 1e7 m: their triangles are left out");
    note(n.vertices_far, "vertices lie far from all others: their triangles are left out");
    note(n.vertices_welded, "vertices became one with a neighbour");
    note(n.faces_degenerate, "triangles without an area are left out");
    note(n.faces_duplicate, "triangles that were there twice are left out");
    note(n.faces_turned, "triangles were wound against their neighbours and are turned");
    note(n.edges_open, "edges are open: past them the hand slips off");
    note(n.edges_non_manifold, "edges have more than two triangles");
    note(n.faces_crossed, "triangles cross others");
    return lines;
}

namespace {
std::string too_long;  // what the signal's handler writes
}

ReadingLimit::ReadingLimit(const std::string& program) {
    too_long = program + ": the file takes more than a minute to read; it is damaged, or far too large\n";
    std::signal(SIGALRM, [](int) {
        [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, too_long.data(), too_long.size());
        _exit(1);
    });
    alarm(60);
}
ReadingLimit::~ReadingLimit() {
    alarm(0);
}

}  // namespace meshfile
