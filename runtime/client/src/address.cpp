#include "address.hpp"

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/name.hpp>

namespace knurl::detail {

namespace {

constexpr std::string_view local_prefix = "knurl:";
constexpr std::string_view remote_prefix = "knurl://";

}  // namespace

std::vector<bridge::Endpoint> bridge_endpoints(const std::string& address) {
    if (!address.starts_with(remote_prefix)) return {};
    try {
        return bridge::resolve_all(address.substr(remote_prefix.size()));
    } catch (const std::runtime_error& reason) {
        throw Error(Error::Kind::no_servo, reason.what());
    }
}

std::string servo_name(const std::string& address) {
    const std::string name =
        address.starts_with(local_prefix) ? address.substr(local_prefix.size()) : address;
    if (!protocol::is_name(name))
        throw Error(Error::Kind::no_servo,
                    detail::format(
                        "address '{}': no servo has such a name; give 'knurl:NAME', NAME of 1 to {} letters, "
                        "digits, '-', '_' and '.', as `knurl ls` shows it",
                        address, protocol::name_bytes - 1));
    return name;
}

}  // namespace knurl::detail
