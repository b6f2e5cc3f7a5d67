#include <cstring>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>

#include "height_block.hpp"

namespace knurl {

std::unique_ptr<Asset> asset_of(std::span<const std::byte> block, std::shared_ptr<const void> keeper) {
    std::uint64_t magic = 0;
    if (block.size() >= sizeof magic) std::memcpy(&magic, block.data(), sizeof magic);
    if (magic == HeightHeader::magic_word) return std::make_unique<HeightField>(block, std::move(keeper));
    return std::make_unique<Mesh>(block, std::move(keeper));
}

}  // namespace knurl
