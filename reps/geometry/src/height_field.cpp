#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <knurl/geometry/height_field.hpp>

#include "height_data.hpp"

namespace knurl {
namespace {

constexpr std::uint64_t most_cells = std::uint64_t{1} << 28;  // a link has 30 bits for a face

void check(std::span<const float> heights, const HeightGrid& grid) {
    const std::string shape = std::to_string(grid.columns) + " by " + std::to_string(grid.rows);
    if (grid.columns < 2 || grid.rows < 2)
        throw HeightFieldError("the height field has " + shape + " heights; it needs at least 2 by 2");
    if (std::uint64_t{grid.columns} * grid.rows > most_cells)
        throw HeightFieldError("the height field has " + shape + " heights; send at most " +
                               std::to_string(most_cells) + ", the rest as another one");
    if (heights.size() != std::size_t{grid.columns} * grid.rows)
        throw HeightFieldError("the height field of " + shape + " has " + std::to_string(heights.size()) +
                               " heights; send one for each");
    const auto sensible = [](double x) { return x > 0 && x < 1e7; };
    if (!sensible(grid.dx) || !sensible(grid.dy) || !(grid.dx * grid.columns < 1e7) ||
        !(grid.dy * grid.rows < 1e7))
        throw HeightFieldError("the height field's cells are " + std::to_string(grid.dx) + " by " +
                               std::to_string(grid.dy) + " m; they must be above 0, all of them below 1e7");
    if (!(grid.corner.cwiseAbs().maxCoeff() < 1e7))
        throw HeightFieldError("the height field's corner is not a place within 1e7 m; move it");
    for (std::size_t i = 0; i < heights.size(); ++i) {
        if (!(std::abs(heights[i]) < 1e7f))
            throw HeightFieldError("the height of column " + std::to_string(i % grid.columns) + ", row " +
                                   std::to_string(i / grid.columns) +
                                   " is not a number within 1e7 m; fill it in");
    }
}

}  // namespace

HeightField::HeightField(std::span<const float> heights, const HeightGrid& grid, std::uint8_t material)
    : Asset(AssetKind::height_field), data_(std::make_unique<HeightData>()) {
    check(heights, grid);
    HeightData& d = *data_;
    const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
    const double width = grid.dx * (grid.columns - 1), depth = grid.dy * (grid.rows - 1);
    const double middle = (double{*least} + double{*most}) / 2;
    d.dx = grid.dx, d.dy = grid.dy;
    d.low_x = -width / 2, d.low_y = -depth / 2;
    d.columns = grid.columns - 1, d.rows = grid.rows - 1;
    d.material = material;
    d.origin = grid.corner + Eigen::Vector3d(width / 2, depth / 2, middle);
    d.size = std::sqrt(width * width + depth * depth + std::pow(double{*most} - double{*least}, 2));
    d.heights.resize(heights.size());
    for (std::size_t i = 0; i < heights.size(); ++i)
        d.heights[i] = static_cast<float>(double{heights[i]} - middle);
    const Eigen::Vector3d half(width / 2, depth / 2, (double{*most} - double{*least}) / 2 * (1 + 1e-6));
    low = d.origin - half, high = d.origin + half;

    // The lowest level looks at heights, each further one at the level before it.
    std::uint32_t columns = d.columns, rows = d.rows;
    do {
        const HeightData::Level* below = d.levels.empty() ? nullptr : &d.levels.back();
        HeightData::Level level{.columns = (columns + 7) / 8, .rows = (rows + 7) / 8, .blocks = {}};
        level.blocks.resize(std::size_t{level.columns} * level.rows);
        for (std::uint32_t y = 0; y < level.rows; ++y) {
            for (std::uint32_t x = 0; x < level.columns; ++x) {
                HeightData::Span span{std::numeric_limits<float>::max(),
                                      std::numeric_limits<float>::lowest()};
                const std::uint32_t more =
                    below == nullptr ? 1 : 0;  // a cell has a height at its far side too
                for (std::uint32_t j = y * 8; j < std::min(y * 8 + 8, rows) + more; ++j) {
                    for (std::uint32_t i = x * 8; i < std::min(x * 8 + 8, columns) + more; ++i) {
                        if (below == nullptr) {
                            const float z = d.heights[std::size_t{j} * (columns + 1) + i];
                            span = {std::min(span.low, z), std::max(span.high, z)};
                        } else {
                            const HeightData::Span& s = below->blocks[std::size_t{j} * columns + i];
                            span = {std::min(span.low, s.low), std::max(span.high, s.high)};
                        }
                    }
                }
                level.blocks[std::size_t{y} * level.columns + x] = span;
            }
        }
        columns = level.columns, rows = level.rows;
        d.levels.push_back(std::move(level));
    } while (columns > 1 || rows > 1);
}

HeightField::~HeightField() = default;

std::size_t HeightField::bytes() const noexcept {
    std::size_t sum = sizeof(*this) + sizeof(HeightData) + data_->heights.capacity() * sizeof(float);
    for (const HeightData::Level& level : data_->levels)
        sum += sizeof(level) + level.blocks.capacity() * sizeof(HeightData::Span);
    return sum;
}

std::size_t HeightField::faces() const noexcept {
    return std::size_t{data_->columns} * data_->rows * 2;
}

}  // namespace knurl
