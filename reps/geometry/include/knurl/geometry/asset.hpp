#pragma once

/// @file
/// An asset: large immutable data that is sent once and then named. This is the servo's form of it.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace knurl {

/// Kinds of assets.
enum class AssetKind : std::uint32_t {
    /// A triangle mesh: Mesh.
    mesh = 1,
    /// A height field: HeightField.
    height_field = 2,
};

/// What a material makes of the surface's own stiffness, damping and friction.
struct AssetMaterial {
    /// Factor on the representation's stiffness (1), 0 to 1.
    double stiffness = 1;
    /// Factor on the representation's damping (1), 0 or more.
    double damping = 1;
    /// Factor on the representation's friction (1), 0 or more.
    double friction = 1;
};

/// A surface as triangles to draw, in its own frame, in single precision.
struct DrawnTriangles {
    /// Vertices (m): x, y, z of each.
    std::vector<float> vertices;
    /// Three numbers of vertices for each triangle.
    std::vector<std::uint32_t> triangles;
};

/// A surface in its own frame. It never changes once it is built, so any number of scenes may read it.
struct Asset {
    /// An asset of that kind.
    explicit Asset(AssetKind k) : kind(k) {}
    Asset(const Asset&) = delete;
    Asset& operator=(const Asset&) = delete;
    virtual ~Asset() = default;
    /// Bytes of memory, all of it.
    virtual std::size_t bytes() const noexcept = 0;
    /// Number of triangles.
    virtual std::size_t faces() const noexcept = 0;
    /// Bytes that write() writes.
    virtual std::size_t block_bytes() const noexcept = 0;
    /// Writes it as one piece of memory of block_bytes(), for another process of the same build.
    virtual void write(std::span<std::byte> block) const = 0;

    /// As triangles to draw. Of a mesh, triangles do not share vertices.
    virtual DrawnTriangles drawn() const = 0;

    /// Its kind.
    const AssetKind kind;
    /// Its materials, set before any scene reads it; those beyond are the default.
    std::vector<AssetMaterial> materials;
    /// Lowest corner of its bounding box (m).
    Eigen::Vector3d low = Eigen::Vector3d::Zero();
    /// Highest corner of its bounding box (m).
    Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

/// Reads what Asset::write() wrote in a process of the same build, where it lies (aligned to 64): `keeper`
/// keeps it there. Its materials are not in it. Counts are checked against `block`, a mesh's indices are not:
/// take it from your own builder alone. Throws MeshError or HeightFieldError.
std::unique_ptr<Asset> asset_of(std::span<const std::byte> block, std::shared_ptr<const void> keeper);

}  // namespace knurl
