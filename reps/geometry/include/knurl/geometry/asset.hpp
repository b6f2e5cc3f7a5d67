#pragma once
// A large immutable thing that is sent once and then named: what the servo holds of it.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace knurl {

enum class AssetKind : std::uint32_t { mesh = 1, height_field = 2 };

/// What a material makes of the surface's own stiffness, damping and friction.
struct AssetMaterial {
    double stiffness = 1;  // 1, 0 to 1: shares of the representation's
    double damping = 1;    // 1, 0 or more
    double friction = 1;   // 1, 0 or more
};

/// Lies in its own frame; never changes once it is built, so any number of scenes may read it.
struct Asset {
    explicit Asset(AssetKind k) : kind(k) {}
    Asset(const Asset&) = delete;
    Asset& operator=(const Asset&) = delete;
    virtual ~Asset() = default;
    virtual std::size_t bytes() const noexcept = 0;  // of memory, all of it
    virtual std::size_t faces() const noexcept = 0;
    /// As one piece of memory of so many bytes, for another process of the same build.
    virtual std::size_t block_bytes() const noexcept = 0;
    virtual void write(std::span<std::byte> block) const = 0;

    const AssetKind kind;
    std::vector<AssetMaterial> materials;  // set before any scene reads it; those beyond are the default
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  // m, its box
};

/// What was written by Asset::write() in a process of the same build, where it lies (aligned to 64): `keeper`
/// keeps it there. Its materials are not in it. Counts are checked against `block`, a mesh's indices are not:
/// take it from your own builder alone. Throws MeshError or HeightFieldError.
std::unique_ptr<Asset> asset_of(std::span<const std::byte> block, std::shared_ptr<const void> keeper);

}  // namespace knurl
