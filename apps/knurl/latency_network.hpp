#pragma once
// What `knurl latency` prints about the network: the same as text and for programs.

#include <string>

#include <knurl/bridge/wire_sizes.hpp>
#include <knurl/json/json.hpp>
#include <knurl/link/network.hpp>

namespace knurl::cli {

/// In some lines.
std::string network_text(const Network& network, const bridge::WireSizes& sizes);
/// Times in us, drift in ppm.
knurl::Json network_json(const Network& network, const bridge::WireSizes& sizes);

}  // namespace knurl::cli
