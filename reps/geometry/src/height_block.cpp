#include "height_block.hpp"

#include <algorithm>
#include <cstring>

#include <knurl/geometry/height_field.hpp>

namespace knurl {

HeightLayout::HeightLayout(std::uint32_t columns, std::uint32_t rows) {
    const auto part = [&](std::size_t bytes) {
        const std::size_t begin = total;
        total += (bytes + 63) / 64 * 64;
        return begin;
    };
    part(sizeof(HeightHeader));
    heights = part((std::size_t{columns} + 1) * (std::size_t{rows} + 1) * sizeof(float));
    do {
        columns = (columns + 7) / 8, rows = (rows + 7) / 8;
        levels[level_count++] = {columns, rows, part(std::size_t{columns} * rows * sizeof(HeightData::Span))};
    } while (columns > 1 || rows > 1);
}

HeightField::HeightField(std::span<const std::byte> block, std::shared_ptr<const void> keeper)
    : Asset(AssetKind::height_field), data_(std::make_unique<HeightData>()) {
    HeightHeader header;
    if (block.size() >= sizeof header) std::memcpy(&header, block.data(), sizeof header);
    if (block.size() < sizeof header || header.magic != HeightHeader::magic_word || header.columns == 0 ||
        header.rows == 0 || header.columns >= HeightData::most_heights ||
        header.rows >= HeightData::most_heights ||
        (std::uint64_t{header.columns} + 1) * (std::uint64_t{header.rows} + 1) > HeightData::most_heights ||
        HeightLayout(header.columns, header.rows).total != block.size() ||
        reinterpret_cast<std::uintptr_t>(block.data()) % 64 != 0)
        throw HeightFieldError("the height field's block is not of this build; build it anew");
    const HeightLayout layout(header.columns, header.rows);
    HeightData& d = *data_;
    d.size = header.size;
    d.dx = header.dx, d.dy = header.dy;
    d.low_x = -header.dx * header.columns / 2, d.low_y = -header.dy * header.rows / 2;
    d.columns = header.columns, d.rows = header.rows;
    d.material = static_cast<std::uint8_t>(header.material);
    for (int k = 0; k < 3; ++k) {
        d.origin[k] = header.origin[k];
        low[k] = header.low[k];
        high[k] = header.high[k];
    }
    d.heights = {reinterpret_cast<const float*>(block.data() + layout.heights),
                 (std::size_t{header.columns} + 1) * (std::size_t{header.rows} + 1)};
    d.level_count = layout.level_count;
    for (std::uint32_t i = 0; i < layout.level_count; ++i) {
        const auto& [columns, rows, at] = layout.levels[i];
        d.levels[i] = {
            columns,
            rows,
            {reinterpret_cast<const HeightData::Span*>(block.data() + at), std::size_t{columns} * rows}};
    }
    d.block = block;
    d.keeper = std::move(keeper);
}

std::size_t HeightField::block_bytes() const noexcept {
    return data_->block.size();
}

void HeightField::write(std::span<std::byte> block) const {
    if (block.size() != data_->block.size())
        throw HeightFieldError("the height field's block takes " + std::to_string(data_->block.size()) +
                               " bytes, not " + std::to_string(block.size()) + "; ask block_bytes()");
    std::copy(data_->block.begin(), data_->block.end(), block.begin());
}

}  // namespace knurl
