#pragma once
// The part of a height field that the walk reads: the heights, and the lowest and highest height of blocks of
// 8 by 8 cells, of 8 by 8 such blocks, and so on. All of it lies in one piece of memory, which other
// processes of the same build read directly (height_block.cpp).

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>

namespace knurl {

struct HeightData {
    struct Span {
        float low, high;  // m, from origin
    };
    struct Level {
        std::uint32_t columns = 0, rows = 0;
        std::span<const Span> blocks = {};
    };
    static constexpr std::uint64_t most_heights = std::uint64_t{1} << 28;  // a link has 30 bits for a face
    static constexpr std::size_t most_levels = 9;                          // for so many heights in two rows
    static constexpr std::uint32_t shift = 3;  // a block is 8 by 8 of the level below

    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m, in the field's frame
    double size = 0, dx = 0, dy = 0;                   // m
    double low_x = 0, low_y = 0;                       // m, of the first height, from origin
    std::uint32_t columns = 0, rows = 0;               // of cells
    std::uint8_t material = 0;
    std::span<const float> heights;              // m, from origin; columns + 1 in a row
    std::array<Level, most_levels> levels = {};  // the last one is one block
    std::uint32_t level_count = 0;
    std::span<const std::byte> block;
    std::shared_ptr<const void> keeper;  // of the memory
};

}  // namespace knurl
