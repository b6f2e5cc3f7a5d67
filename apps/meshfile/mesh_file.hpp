#pragma once
// Meshes as files: STL, OBJ, PLY and what else Assimp reads.

#include <cstdint>
#include <string>
#include <vector>

#include <knurl/geometry/mesh.hpp>

namespace meshfile {

/// As it stands in the file, in the file's own unit.
struct MeshFile {
    std::string path, format;
    std::vector<knurl::Point3> vertices;
    std::vector<knurl::Triangle> triangles;
    std::vector<std::uint8_t> materials;  // of each triangle
    std::vector<std::string> material_names;
    std::uint64_t faces_of_other_kinds = 0;  // points and lines, left out

    knurl::Triangles triangles_of() const {
        return {.vertices = vertices, .triangles = triangles, .materials = materials};
    }
    /// The diagonal of the box of its vertices that are numbers.
    double size() const;
};

/// Throws std::runtime_error: one line with the path, what is wrong with it and what to do.
MeshFile load_mesh(const std::string& path);

/// What a builder found and mended, a line each; none: nothing was wrong.
std::vector<std::string> notes_of(const knurl::MeshNotes& notes);

/// While it is there a program that takes more than a minute ends with one line: a file that was damaged in
/// its header can keep Assimp busy for ever. One at a time; uses SIGALRM.
class ReadingLimit {
  public:
    explicit ReadingLimit(const std::string& program);
    ~ReadingLimit();
    ReadingLimit(const ReadingLimit&) = delete;
    ReadingLimit& operator=(const ReadingLimit&) = delete;
};

}  // namespace meshfile
