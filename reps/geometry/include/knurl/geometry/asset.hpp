#pragma once
// A large immutable thing that is sent once and then named: what the servo holds of it.

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace knurl {

enum class AssetKind : std::uint32_t { mesh = 1, height_field = 2 };

/// Lies in its own frame; never changes once it is built, so any number of scenes may read it.
struct Asset {
    explicit Asset(AssetKind k) : kind(k) {}
    Asset(const Asset&) = delete;
    Asset& operator=(const Asset&) = delete;
    virtual ~Asset() = default;
    virtual std::size_t bytes() const noexcept = 0;  // of memory, all of it

    const AssetKind kind;
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  // m, its box
};

}  // namespace knurl
