#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <knurl/geometry/height_field.hpp>

#include "height_block.hpp"

namespace knurl {
namespace {

constexpr std::size_t besides = sizeof(HeightField) + sizeof(HeightData);  // bytes besides the block

std::string length(double m) {
    char text[32];  // with a point in every locale, which printf's has not
    return {text, std::to_chars(text, text + sizeof text, m, std::chars_format::general, 6).ptr};
}

void check(std::span<const float> heights, const HeightGrid& grid, std::size_t budget) {
    const std::string shape = std::to_string(grid.columns) + " by " + std::to_string(grid.rows);
    if (grid.columns < 2 || grid.rows < 2)
        throw HeightFieldError("the height field has " + shape + " heights; it needs at least 2 by 2");
    if (std::uint64_t{grid.columns} * grid.rows > HeightData::most_heights)
        throw HeightFieldError("the height field has " + shape + " heights; send at most " +
                               std::to_string(HeightData::most_heights) + ", the rest as another one");
    if (heights.size() != std::size_t{grid.columns} * grid.rows)
        throw HeightFieldError("the height field of " + shape + " has " + std::to_string(heights.size()) +
                               " heights; send one for each");
    const std::size_t need = besides + HeightLayout(grid.columns - 1, grid.rows - 1).total;
    if (need > budget)
        throw HeightFieldError("the height field of " + shape + " would take " + std::to_string(need) +
                               " bytes, but the budget is " + std::to_string(budget) +
                               "; raise it, or send fewer heights");
    const auto sensible = [](double x) { return x >= 1e-9 && x < 1e7; };  // squares of smaller values
                                                                          // underflow
    if (!sensible(grid.dx) || !sensible(grid.dy) || !(grid.dx * grid.columns < 1e7) ||
        !(grid.dy * grid.rows < 1e7))
        throw HeightFieldError("the height field's cells are " + length(grid.dx) + " by " + length(grid.dy) +
                               " m; give them 1e-9 m or more, all of them together less than 1e7");
    if (!(grid.corner.array().abs() < 1e7).all())
        throw HeightFieldError("the height field's corner is not a place within 1e7 m; move it");
    for (std::size_t i = 0; i < heights.size(); ++i) {
        if (!(std::abs(heights[i]) < 1e7f))
            throw HeightFieldError("the height of column " + std::to_string(i % grid.columns) + ", row " +
                                   std::to_string(i / grid.columns) +
                                   " is not a number within 1e7 m; fill it in");
    }
}

struct alignas(64) Line {
    std::byte bytes[64];
};

/// The lowest and highest height of each block: from the heights for the first level, else from the level
/// below.
void sum_up(std::span<std::byte> block, const HeightLayout& layout, std::uint32_t columns,
            std::uint32_t rows) {
    const auto* heights = reinterpret_cast<const float*>(block.data() + layout.heights);
    const HeightData::Span* below = nullptr;
    for (std::uint32_t l = 0; l < layout.level_count; ++l) {
        const HeightLayout::Level& level = layout.levels[l];
        auto* blocks = reinterpret_cast<HeightData::Span*>(block.data() + level.at);
        const std::uint32_t more = below == nullptr ? 1 : 0;  // the far side of a cell has a height, too
        for (std::uint32_t y = 0; y < level.rows; ++y) {
            for (std::uint32_t x = 0; x < level.columns; ++x) {
                HeightData::Span span{std::numeric_limits<float>::max(),
                                      std::numeric_limits<float>::lowest()};
                for (std::uint32_t j = y * 8; j < std::min(y * 8 + 8, rows) + more; ++j) {
                    for (std::uint32_t i = x * 8; i < std::min(x * 8 + 8, columns) + more; ++i) {
                        const float* z = heights + std::size_t{j} * (columns + 1) + i;
                        const HeightData::Span s =
                            below == nullptr ? HeightData::Span{*z, *z} : below[std::size_t{j} * columns + i];
                        span = {std::min(span.low, s.low), std::max(span.high, s.high)};
                    }
                }
                blocks[std::size_t{y} * level.columns + x] = span;
            }
        }
        below = blocks, columns = level.columns, rows = level.rows;
    }
}

}  // namespace

/// Checks the input and brings it into the form that is read.
HeightField::Block HeightField::built(std::span<const float> heights, const HeightGrid& grid,
                                      std::uint8_t material, std::size_t budget) {
    check(heights, grid, budget);
    const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
    const double width = grid.dx * (grid.columns - 1), depth = grid.dy * (grid.rows - 1);
    const double middle = (double{*least} + double{*most}) / 2, range = double{*most} - double{*least};
    const Eigen::Vector3d origin = grid.corner + Eigen::Vector3d(width / 2, depth / 2, middle),
                          half(width / 2, depth / 2, range / 2 * (1 + 1e-6));
    HeightHeader header{.columns = grid.columns - 1,
                        .rows = grid.rows - 1,
                        .dx = grid.dx,
                        .dy = grid.dy,
                        .size = std::sqrt(width * width + depth * depth + range * range),
                        .material = material};
    for (int k = 0; k < 3; ++k) {
        header.origin[k] = origin[k];
        header.low[k] = origin[k] - half[k];
        header.high[k] = origin[k] + half[k];
    }
    const HeightLayout layout(header.columns, header.rows);
    auto memory = std::make_shared<std::vector<Line>>(layout.total / sizeof(Line));
    const std::span<std::byte> block = std::as_writable_bytes(std::span(*memory));
    std::memcpy(block.data(), &header, sizeof header);
    auto* to = reinterpret_cast<float*>(block.data() + layout.heights);
    for (const float z : heights) *to++ = static_cast<float>(double{z} - middle);
    sum_up(block, layout, header.columns, header.rows);
    return {block, memory};
}

HeightField::HeightField(std::span<const float> heights, const HeightGrid& grid, std::uint8_t material,
                         std::size_t budget)
    : HeightField(built(heights, grid, material, budget)) {}

HeightField::~HeightField() = default;

std::size_t HeightField::bytes() const noexcept {
    return besides + data_->block.size();
}

DrawnTriangles HeightField::drawn() const {
    const HeightData& d = *data_;
    const std::uint32_t across = d.columns + 1;
    DrawnTriangles drawn;
    drawn.vertices.reserve(3 * d.heights.size());
    drawn.triangles.reserve(3 * faces());
    for (std::uint32_t j = 0; j <= d.rows; ++j) {
        for (std::uint32_t i = 0; i <= d.columns; ++i) {
            const double height = d.heights[std::size_t{j} * across + i];
            for (const double value : {d.origin.x() + d.low_x + i * d.dx, d.origin.y() + d.low_y + j * d.dy,
                                       d.origin.z() + height})
                drawn.vertices.push_back(static_cast<float>(value));
        }
    }
    for (std::uint32_t j = 0; j < d.rows; ++j) {
        for (std::uint32_t i = 0; i < d.columns; ++i) {
            const std::uint32_t corner = j * across + i;
            drawn.triangles.insert(drawn.triangles.end(), {corner, corner + 1, corner + across + 1, corner,
                                                           corner + across + 1, corner + across});
        }
    }
    return drawn;
}

std::size_t HeightField::faces() const noexcept {
    return std::size_t{data_->columns} * data_->rows * 2;
}

}  // namespace knurl
