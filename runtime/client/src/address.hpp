#pragma once

#include <optional>
#include <string>

#include <knurl/bridge/endpoint.hpp>

namespace knurl::detail {

/// "knurl://HOST:PORT": the bridge there, its name looked up. Nothing: an address on this box. Throws Error.
std::optional<bridge::Endpoint> bridge_endpoint(const std::string& address);

/// "knurl:NAME" or "NAME" -> NAME. Throws Error for a name that can be no servo's.
std::string servo_name(const std::string& address);

}  // namespace knurl::detail
