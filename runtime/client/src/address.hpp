#pragma once

#include <optional>
#include <string>
#include <vector>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/protocol/registry.hpp>

namespace knurl::detail {

/// "knurl://SERVO/DEVICE": its parts. None: it is not of this form. Throws Error.
std::optional<protocol::RegistryAddress> registry_part(const std::string& address);
/// Asks the registry of this host. Throws Error.
std::string where_registry_says(const protocol::RegistryAddress& servo);

/// "knurl://HOST:PORT": all addresses of that bridge, its name looked up. None: a local servo. Throws Error.
std::vector<bridge::Endpoint> bridge_endpoints(const std::string& address);

/// "knurl:NAME" or "NAME" -> NAME; a socket's path stays as it is. Throws Error for an impossible servo name.
std::string servo_name(const std::string& address);

}  // namespace knurl::detail
