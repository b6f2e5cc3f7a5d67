#pragma once
// The data that the walk reads. Faces lie in the order of the tree's leaves, corners in metres from `origin`.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <knurl/geometry/mesh.hpp>

namespace knurl {

/// A neighbour and its edge that is crossed: face << 2 | edge.
using Link = std::uint32_t;
inline constexpr Link no_link = 0xffffffff;
inline constexpr Link link_to(std::uint32_t face, std::uint32_t edge) noexcept {
    return face << 2 | edge;
}
inline constexpr std::uint32_t face_of(Link link) noexcept {
    return link >> 2;
}
inline constexpr std::uint32_t edge_of(Link link) noexcept {
    return link & 3;
}

// Edge i of a face runs from corner i to corner i + 1 (mod 3); the neighbour's edge runs the other way.
enum FaceFlag : std::uint8_t {
    face_crossed = 1,  // another face passes through it, and the walk alone might pass below
    face_rim =
        2,  // one of its edges or vertices has no neighbour: where the walk rests there, the tree is queried
    face_knot = 4,  // faces around one of its vertices pass through each other, and the walk goes around that
                    // vertex
};

/// All that one step of the walk needs: one cache line.
struct alignas(64) Face {
    float corner[3][3];
    Link over[3];
    std::uint32_t triangle;  // number of the original triangle
    std::uint8_t material, flags;
    std::uint16_t reserved;
};
static_assert(sizeof(Face) == 64);

struct alignas(32) ExactFace {
    double corner[3][3];
    Link over[3];
    std::uint32_t triangle;
    std::uint8_t material, flags;
    std::uint16_t reserved;
};
static_assert(sizeof(ExactFace) == 96);

/// Boxes around eight children, rounded outwards.
struct alignas(32) MeshNode {
    static constexpr std::uint32_t fan = 8;
    float low[3][fan], high[3][fan];  // m, from origin; an empty place has low > high
    /// A node's index, or leaf_bit | (count - 1) << 28 | first face, 1 to 4 of them.
    std::uint32_t child[fan];
    static constexpr std::uint32_t leaf_bit = 0x80000000;
};
static_assert(sizeof(MeshNode) == 224);
inline constexpr bool is_leaf(std::uint32_t child) noexcept {
    return (child & MeshNode::leaf_bit) != 0;
}
inline constexpr std::uint32_t leaf_count(std::uint32_t child) noexcept {
    return ((child >> 28) & 7) + 1;
}
inline constexpr std::uint32_t leaf_first(std::uint32_t child) noexcept {
    return child & 0x0fffffff;
}

/// Memory of a mesh that this process built. One that was built elsewhere lies in the other's memory.
struct MeshMemory {
    std::vector<Face> faces;  // `faces` or `exact` is empty
    std::vector<ExactFace> exact_faces;
    std::vector<MeshNode> nodes;
};

struct MeshData {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m, in the mesh's frame
    double size = 0;                                   // m, the box's diagonal
    bool exact = false;
    bool open = false;      // an edge has no neighbour
    std::span<Face> faces;  // `faces` or `exact` is empty
    std::span<ExactFace> exact_faces;
    std::span<MeshNode> nodes;  // the root is the first; every child comes after its parent
    MeshNotes notes;
    std::shared_ptr<const void> keeper;  // of the memory that the spans refer to
};

}  // namespace knurl
