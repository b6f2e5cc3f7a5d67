#pragma once
// Mesh files: STL, OBJ and PLY by readers of this project, in double and to the last face; other formats by
// Assimp.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/geometry/mesh.hpp>

namespace knurl::meshfile {

/// As in the file, in the file's own unit.
struct MeshFile {
    std::string path, format;
    std::vector<knurl::Point3> vertices;
    std::vector<knurl::Triangle> triangles;
    std::vector<std::uint8_t> materials;  // index, of each triangle
    std::vector<std::string> material_names;
    std::vector<std::string> notes;  // what was changed, or is odd; one line each

    knurl::Triangles triangles_of() const {
        return {.vertices = vertices, .triangles = triangles, .materials = materials};
    }
    /// The diagonal of the box of all finite vertices.
    double size() const;
    /// The middle of that box, if it is so far from the origin that precision is lost there.
    std::optional<knurl::Point3> far_middle() const;
};

/// Throws std::runtime_error: one line with the path, what is wrong and where, and what to do. Ends after a
/// minute at most, for any file.
MeshFile load_mesh(const std::string& path);
/// The same of a file's bytes; formats that Assimp reads are read from `path`.
MeshFile read_mesh(std::string_view bytes, const std::string& path);

/// Turns closed parts that lie in no other part and have a negative volume, with all that lies in them. The
/// walls of a cavity stay. `mesh` was built from the file's triangles, at any scale. Returns how many such
/// parts were turned.
std::size_t turn_inside_out(MeshFile& file, const knurl::Mesh& mesh);

/// What a builder found and repaired, one line each; none: nothing was wrong.
std::vector<std::string> notes_of(const knurl::MeshNotes& notes);

}  // namespace knurl::meshfile
