#pragma once

/// @file
/// How a program asks the registry of servos, which is a knurl-dds on this host: over a Unix socket, in lines of text, so
/// that no program but knurl-dds is linked with DDS.
///
/// A request is one message: "resolve NAME" or "list". The answer to `resolve` is one message: the address of that servo
/// for Client::connect ("knurl:lab", "knurl://10.0.0.3:4096"), or "? " and a line that says why there is none. The answer
/// to `list` is a message of JSON for each servo, and a ".". The first message of all
/// is the registry's: "knurl-registry 1 DOMAIN NAME".

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace knurl::protocol {

/// What registries answer that take part in no domain of their own.
inline constexpr std::string_view registry_suffix = ".registry";
/// Longest message of a registry (bytes).
inline constexpr std::size_t registry_message = 64 * 1024;

/// "knurl://lab/right" in its parts.
struct RegistryAddress {
    /// Name of the servo, as it is announced: "lab".
    std::string servo;
    /// Name of the device; empty: none is named.
    std::string device;
};

/// None: it is no address of this form (it has no '/' behind "knurl://"). Throws std::runtime_error, one line: it is one, and a
/// name in it cannot be.
std::optional<RegistryAddress> registry_address(const std::string& said);

/// Where a registry of this name listens: in the folder of the servos' sockets.
std::string registry_socket(const std::string& name);

/// Where the servo of that name is, as the registries of this host say: of the domain `domain`, or of any. Throws
/// std::runtime_error, one line: no registry runs here, or none knows that name.
std::string resolve_servo(const std::string& name, std::optional<std::uint32_t> domain = {});
/// The domain that is meant where nobody says: $ROS_DOMAIN_ID; none: any.
std::optional<std::uint32_t> domain_said();

/// The servos that the registry of this domain on this host knows, a text of JSON each. None: no such registry runs here.
std::optional<std::vector<std::string>> list_servos(std::uint32_t domain);

}  // namespace knurl::protocol
