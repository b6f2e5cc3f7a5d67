#pragma once

#include <cstddef>
#include <span>

#include <knurl/protocol/asset.hpp>

namespace knurl::servo {

/// By which a recording knows what an asset was made of.
protocol::AssetDigest digest_of(std::span<const std::byte> source) noexcept;

}  // namespace knurl::servo
