#pragma once

#include <cstddef>
#include <span>

#include <knurl/protocol/asset.hpp>

namespace knurl::servo {

/// Digest by which a recording knows from what an asset was made.
protocol::AssetDigest digest_of(std::span<const std::byte> source) noexcept;

}  // namespace knurl::servo
