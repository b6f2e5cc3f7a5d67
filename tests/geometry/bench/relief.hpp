#pragma once
// A relief of 24 by 24 cm with bumps of 12 to 60 mm, of any number of triangles: as a mesh, and as the
// heights of the same triangles. Its area is that of a bunny of 15 cm, so that its triangles have a usual
// size.

#include <cmath>
#include <vector>

#include <knurl/geometry/height_field.hpp>

#include "generators.hpp"

namespace knurl::test {

struct Relief {
    explicit Relief(std::uint32_t cells_a_side, double length = 0.24) : cells(cells_a_side), side(length) {
        const std::uint32_t n = cells + 1;
        const double cell = side / cells;
        for (std::uint32_t j = 0; j < n; ++j) {
            for (std::uint32_t i = 0; i < n; ++i) {
                const double x = i * cell - side / 2, y = j * cell - side / 2;
                heights.push_back(static_cast<float>(z(x, y)));
                shape.vertices.push_back({x, y, heights.back()});
                if (i == cells || j == cells) continue;
                const std::uint32_t a = j * n + i;
                shape.triangles.push_back({a, a + 1, a + 1 + n});
                shape.triangles.push_back({a, a + 1 + n, a + n});
            }
        }
    }
    std::size_t triangles() const { return shape.triangles.size(); }
    HeightGrid grid() const {
        return {cells + 1, cells + 1, side / cells, side / cells, {-side / 2, -side / 2, 0}};
    }

    static double z(double x, double y) {
        double sum = 0;
        for (int k = 1; k < 6; ++k) {
            const double along = x * std::cos(1.7 * k) + y * std::sin(1.7 * k);
            sum += 0.003 / std::pow(k, 1.3) * std::sin(2 * M_PI * k * along / 0.06 + k * k);
        }
        return sum;
    }

    std::uint32_t cells;
    double side;  // m; its middle is the origin
    std::vector<float> heights;
    MadeMesh shape{.name = "relief", .vertices = {}, .triangles = {}};
};

}  // namespace knurl::test
