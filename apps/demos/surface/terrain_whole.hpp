#pragma once
// The relief at its samples, whole: what an application has that only draws it. Beyond its border it goes on
// level for a bit, as the true surface does: a hand that strays over the border has not slipped off.

#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/triangles.hpp>

#include "terrain.hpp"

namespace surface {

inline constexpr double beyond_border = 4e-3;  // m

/// Two triangles a cell.
class TerrainMesh {
  public:
    explicit TerrainMesh(const Terrain& terrain);
    knurl::Triangles triangles() const { return {.vertices = vertices_, .triangles = triangles_}; }

  private:
    std::vector<knurl::Point3> vertices_;
    std::vector<knurl::Triangle> triangles_;
};

/// The same two triangles a cell, as heights: from the south, and from the west.
struct TerrainField {
    knurl::HeightGrid grid;
    std::vector<float> heights;  // m
    explicit TerrainField(const Terrain& terrain);
};

}  // namespace surface
