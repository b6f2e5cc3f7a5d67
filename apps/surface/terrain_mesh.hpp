#pragma once

#include <vector>

#include <knurl/geometry/triangles.hpp>

#include "terrain.hpp"

namespace surface {

/// The relief at its samples, two triangles a cell: what an application has that only draws it.
class TerrainMesh {
  public:
    explicit TerrainMesh(const Terrain& terrain);
    knurl::Triangles triangles() const { return {.vertices = vertices_, .triangles = triangles_}; }

  private:
    std::vector<knurl::Point3> vertices_;
    std::vector<knurl::Triangle> triangles_;
};

}  // namespace surface
