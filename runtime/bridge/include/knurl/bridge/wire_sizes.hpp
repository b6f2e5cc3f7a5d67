#pragma once

/// @file
/// How large what a bridge sends is: what a measurement beside it has to be compared with.

#include <cstddef>

namespace knurl::bridge {

/// Bytes of what a bridge sends, from the first of the bridge's own on.
struct WireSizes {
    /// A report to a claim with one representation.
    std::size_t datagram = 0;
    /// An `arm`; its answer is as long.
    std::size_t command = 0;
};
/// The sizes with or without encryption.
WireSizes wire_sizes(bool encrypted) noexcept;

}  // namespace knurl::bridge
