#pragma once
// How large what a bridge sends is: what a measurement beside it has to be compared with.

#include <cstddef>

namespace knurl::bridge {

/// Bytes, from the first of the bridge's own on.
struct WireSizes {
    std::size_t datagram = 0;  // a report to a claim with one representation
    std::size_t command = 0;   // an `arm`; its answer is as long
};
WireSizes wire_sizes(bool encrypted) noexcept;

}  // namespace knurl::bridge
