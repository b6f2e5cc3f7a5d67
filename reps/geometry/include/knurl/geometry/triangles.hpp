#pragma once

/// @file
/// A surface as it comes from a file or an application: nothing is promised of it.

#include <array>
#include <cstdint>
#include <span>

namespace knurl {

/// A point (m).
using Point3 = std::array<double, 3>;
/// Three vertices, counter-clockwise as seen from free space.
using Triangle = std::array<std::uint32_t, 3>;

/// A mesh as given.
struct Triangles {
    /// The vertices (m).
    std::span<const Point3> vertices;
    /// The triangles.
    std::span<const Triangle> triangles;
    /// Material of each triangle; empty: all are of material 0.
    std::span<const std::uint8_t> materials = {};
};

}  // namespace knurl
