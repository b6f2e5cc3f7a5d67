#pragma once
// A height field as one piece of memory: header, heights, then the levels. Each part begins on a cache line.

#include <array>
#include <cstddef>
#include <cstdint>

#include "height_data.hpp"

namespace knurl {

struct HeightHeader {
    static constexpr std::uint64_t magic_word = 0x746867'65484c4e4b;  // "KNLHeght"
    std::uint64_t magic = magic_word;
    std::uint32_t columns = 0, rows = 0;  // of cells
    double dx = 0, dy = 0, origin[3] = {}, size = 0, low[3] = {}, high[3] = {};
    std::uint64_t material = 0;
};

/// Where the parts lie for so many cells (bytes from the beginning).
struct HeightLayout {
    struct Level {
        std::uint32_t columns, rows;  // of blocks
        std::size_t at;
    };
    std::size_t heights = 0, total = 0;
    std::array<Level, HeightData::most_levels> levels{};
    std::uint32_t level_count = 0;
    /// At most HeightData::most_heights heights.
    HeightLayout(std::uint32_t columns, std::uint32_t rows);
};
}  // namespace knurl
