#pragma once
// The whole relief at its samples: what an application has that only draws it. Beyond its border it continues
// level for a bit, like the true surface, so that a hand beyond the border does not slip off.

#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/triangles.hpp>

#include "terrain.hpp"

namespace surface {

inline constexpr double beyond_border = 4e-3;  // m

/// Two triangles per cell.
class TerrainMesh {
  public:
    explicit TerrainMesh(const Terrain& terrain);
    knurl::Triangles triangles() const { return {.vertices = vertices_, .triangles = triangles_}; }

  private:
    std::vector<knurl::Point3> vertices_;
    std::vector<knurl::Triangle> triangles_;
};

/// The same two triangles per cell, as heights: from the south, and from the west.
struct TerrainField {
    knurl::HeightGrid grid;
    std::vector<float> heights;  // m
    explicit TerrainField(const Terrain& terrain);
};

}  // namespace surface
