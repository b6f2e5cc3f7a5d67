// Any bytes as STL, OBJ or PLY. They are refused in one line, or become triangles of their vertices.

#include <cstdint>
#include <stdexcept>
#include <string>

#include <knurl/meshfile/mesh_file.hpp>
#include <knurl/meshfile/soup.hpp>

#include "../../fuzz/refusal.hpp"

using knurl::fuzz::check_refusal;
using knurl::fuzz::require;

knurl::meshfile::Soup knurl::meshfile::read_by_assimp(const std::string& path, const ReadLimits&) {
    bad(path, "is of another format");
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    static const std::string names[] = {"file.stl", "file.obj", "file.ply", "file"};
    const std::string& name = names[data[0] % 4];
    try {
        const knurl::meshfile::MeshFile file =
            knurl::meshfile::read_mesh({reinterpret_cast<const char*>(data + 1), size - 1}, name);
        require(!file.triangles.empty() && file.materials.size() == file.triangles.size(),
                "each triangle has a material");
        for (const knurl::Triangle& triangle : file.triangles)
            for (const std::uint32_t corner : triangle)
                require(corner < file.vertices.size(), "a corner is one of the vertices");
        for (const std::uint8_t material : file.materials)
            require(material == 0 || material < file.material_names.size(), "a material has a name");
        for (const std::string& note : file.notes) check_refusal(note, "");
        file.far_middle();
    } catch (const std::runtime_error& error) {
        check_refusal(error.what(), name);
    }
    return 0;
}
