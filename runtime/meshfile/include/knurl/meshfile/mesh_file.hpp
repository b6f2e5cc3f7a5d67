#pragma once
// Meshes as files: STL, OBJ and PLY by readers of our own, in double and to the last face; what else Assimp
// reads, by Assimp.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/geometry/mesh.hpp>

namespace knurl::meshfile {

/// As it stands in the file, in the file's own unit.
struct MeshFile {
    std::string path, format;
    std::vector<knurl::Point3> vertices;
    std::vector<knurl::Triangle> triangles;
    std::vector<std::uint8_t> materials;  // of each triangle
    std::vector<std::string> material_names;
    std::vector<std::string> notes;  // what is not as it stands there, or odd; a line each

    knurl::Triangles triangles_of() const {
        return {.vertices = vertices, .triangles = triangles, .materials = materials};
    }
    /// The diagonal of the box of its vertices that are numbers.
    double size() const;
    /// That box's middle, if it lies so far from the origin that a mesh there is less exact than one at it.
    std::optional<knurl::Point3> far_middle() const;
};

/// Throws std::runtime_error: one line with the path, what is wrong with it and where, and what to do. Ends
/// after a minute at most, whatever the file is.
MeshFile load_mesh(const std::string& path);
/// The same of a file's bytes; formats that Assimp reads are read from `path`.
MeshFile read_mesh(std::string_view bytes, const std::string& path);

/// Turns what is wound inside out: closed parts that lie in no other and have a volume below 0, each with
/// what lies in it. The walls of a cavity stay what they are. `mesh` was built of the file's triangles, at
/// any scale. Returns how many such parts were turned.
std::size_t turn_inside_out(MeshFile& file, const knurl::Mesh& mesh);

/// What a builder found and mended, a line each; none: nothing was wrong.
std::vector<std::string> notes_of(const knurl::MeshNotes& notes);

}  // namespace knurl::meshfile
