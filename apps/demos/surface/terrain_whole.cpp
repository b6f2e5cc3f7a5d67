#include "terrain_whole.hpp"

#include <cmath>

namespace surface {

namespace {

/// Cells added at each side.
std::uint32_t margin(const Terrain& terrain) {
    return static_cast<std::uint32_t>(std::ceil(beyond_border / terrain.grid().cell));
}

}  // namespace

TerrainMesh::TerrainMesh(const Terrain& terrain) {
    const double cell = terrain.grid().cell;
    const std::uint32_t more = margin(terrain);
    const std::uint32_t rows = static_cast<std::uint32_t>(terrain.grid().rows) + 2 * more,
                        columns = static_cast<std::uint32_t>(terrain.grid().columns) + 2 * more;
    const double west = -terrain.half_width() - more * cell, north = terrain.half_length() + more * cell;
    for (std::uint32_t r = 0; r < rows; ++r)
        for (std::uint32_t c = 0; c < columns; ++c) {
            const double x = west + c * cell, y = north - r * cell;
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

TerrainField::TerrainField(const Terrain& terrain)
    : grid{.columns = static_cast<std::uint32_t>(terrain.grid().columns) + 2 * margin(terrain),
           .rows = static_cast<std::uint32_t>(terrain.grid().rows) + 2 * margin(terrain),
           .dx = terrain.grid().cell,
           .dy = terrain.grid().cell,
           .corner = {-terrain.half_width() - margin(terrain) * terrain.grid().cell,
                      -terrain.half_length() - margin(terrain) * terrain.grid().cell, 0}} {
    for (std::uint32_t j = 0; j < grid.rows; ++j)
        for (std::uint32_t i = 0; i < grid.columns; ++i)
            heights.push_back(static_cast<float>(
                terrain.height(grid.corner.x() + i * grid.dx, grid.corner.y() + j * grid.dy)));
}

}  // namespace surface
