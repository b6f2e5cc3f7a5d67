#pragma once

#include <string>
#include <vector>

#include <knurl/bridge/endpoint.hpp>

namespace knurl::detail {

/// "knurl://HOST:PORT": the bridge there, its name looked up: all addresses. None: on this box. Throws Error.
std::vector<bridge::Endpoint> bridge_endpoints(const std::string& address);

/// "knurl:NAME" or "NAME" -> NAME, a socket's path as it is. Throws Error for what can be no servo's.
std::string servo_name(const std::string& address);

}  // namespace knurl::detail
