#pragma once

#include <string>
#include <vector>

#include <knurl/bridge/endpoint.hpp>

namespace knurl::detail {

/// "knurl://HOST:PORT": all addresses of that bridge, its name looked up. None: a local servo. Throws Error.
std::vector<bridge::Endpoint> bridge_endpoints(const std::string& address);

/// "knurl:NAME" or "NAME" -> NAME; a socket's path stays as it is. Throws Error for an impossible servo name.
std::string servo_name(const std::string& address);

}  // namespace knurl::detail
