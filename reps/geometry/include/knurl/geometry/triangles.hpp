#pragma once
// A surface as it comes from a file or an application: nothing is promised of it.

#include <array>
#include <cstdint>
#include <span>

namespace knurl {

using Point3 = std::array<double, 3>;           // m
using Triangle = std::array<std::uint32_t, 3>;  // vertices, counter-clockwise as seen from free space

struct Triangles {
    std::span<const Point3> vertices;
    std::span<const Triangle> triangles;
    std::span<const std::uint8_t> materials = {};  // of each triangle; empty: all are of material 0
};

}  // namespace knurl
