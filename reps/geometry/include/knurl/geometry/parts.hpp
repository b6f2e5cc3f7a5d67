#pragma once

/// @file
/// What of a mesh hangs together over edges, and whether that is a body. Takes its time, allocates.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <knurl/geometry/mesh.hpp>

namespace knurl {

/// Faces that hang together over edges.
struct MeshPart {
    /// Its first face, in MeshParts::triangles.
    std::uint32_t first = 0;
    /// How many faces it has there.
    std::uint32_t faces = 0;
    /// True: every edge has a neighbour.
    bool closed = true;
    /// Volume if it is closed (m^3); below 0: its front is inside.
    double volume = 0;
    /// Lowest corner of its bounding box (m).
    Eigen::Vector3d low = Eigen::Vector3d::Zero();
    /// Highest corner of its bounding box (m).
    Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

/// The parts of a mesh.
struct MeshParts {
    /// The parts.
    std::vector<MeshPart> parts;
    /// Triangles as they were given, part after part; those that were dropped are in none.
    std::vector<std::uint32_t> triangles;
};

/// Finds the parts of a mesh.
MeshParts parts_of(const Mesh& mesh);

}  // namespace knurl
