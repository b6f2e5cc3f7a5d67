#pragma once
// The last message of the builder's process, sent with the memory that it has built.

#include <array>
#include <cstdint>

#include <knurl/protocol/asset.hpp>

namespace knurl::servo {

struct AssetAnswer {
    std::uint32_t refused = 0;
    std::uint32_t material_count = 0;
    std::uint64_t block_bytes = 0;
    protocol::AssetReady ready;
    protocol::AssetDigest digest = {};  // of the source
    char text[512] = {};                // refused: one line
    std::array<AssetMaterial, protocol::max_asset_materials> materials = {};
};

}  // namespace knurl::servo
