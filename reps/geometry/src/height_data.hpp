#pragma once
// What the walk reads of a height field: the heights, and the lowest and highest of blocks of 8 by 8 cells,
// of 8 by 8 such blocks, and so on.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace knurl {

struct HeightData {
    struct Span {
        float low, high;  // m, from origin
    };
    struct Level {
        std::uint32_t columns, rows;
        std::vector<Span> blocks;
    };
    static constexpr std::uint32_t shift = 3;  // a block is 8 by 8 of what is below it

    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m, in the field's frame
    double size = 0, dx = 0, dy = 0;                   // m
    double low_x = 0, low_y = 0;                       // m, of the first height, from origin
    std::uint32_t columns = 0, rows = 0;               // of cells
    std::uint8_t material = 0;
    std::vector<float> heights;  // m, from origin; columns + 1 in a row
    std::vector<Level> levels;   // the last one is one block
};

}  // namespace knurl
