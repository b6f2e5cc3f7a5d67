#include "terrain_mesh.hpp"

namespace surface {

TerrainMesh::TerrainMesh(const Terrain& terrain) {
    const HeightGrid& grid = terrain.grid();
    const auto rows = static_cast<std::uint32_t>(grid.rows),
               columns = static_cast<std::uint32_t>(grid.columns);
    for (std::uint32_t r = 0; r < rows; ++r)
        for (std::uint32_t c = 0; c < columns; ++c) {
            const double x = c * grid.cell - terrain.half_width(), y = terrain.half_length() - r * grid.cell;
            vertices_.push_back({x, y, terrain.height(x, y)});
        }
    for (std::uint32_t r = 0; r + 1 < rows; ++r)
        for (std::uint32_t c = 0; c + 1 < columns; ++c) {
            // Row r lies north of row r + 1; counter-clockwise from above.
            const std::uint32_t nw = r * columns + c, ne = nw + 1, sw = nw + columns, se = sw + 1;
            triangles_.push_back({nw, sw, ne});
            triangles_.push_back({ne, sw, se});
        }
}

}  // namespace surface
