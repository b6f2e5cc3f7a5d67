#pragma once
// What of a mesh hangs together over edges, and whether that is a body. Takes its time, allocates.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <knurl/geometry/mesh.hpp>

namespace knurl {

struct MeshPart {
    std::uint32_t first = 0, faces = 0;  // of MeshParts::triangles
    bool closed = true;                  // every edge has a neighbour
    double volume = 0;                   // m^3 if it is closed; below 0: its front is inside
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  // m, its box
};

struct MeshParts {
    std::vector<MeshPart> parts;
    std::vector<std::uint32_t> triangles;  // as they were given, part after part; those left out are in none
};

MeshParts parts_of(const Mesh& mesh);

}  // namespace knurl
