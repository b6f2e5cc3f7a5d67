#include "address.hpp"

#include <knurl/bridge/host_and_port.hpp>
#include <knurl/client/address.hpp>
#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/servo_address.hpp>

namespace knurl::detail {

namespace {

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

std::optional<protocol::RegistryAddress> registry_part(const std::string& address) {
    try {
        return protocol::registry_address(address);
    } catch (const std::runtime_error& reason) {
        throw Error(Error::Kind::no_servo, detail::format("address {}", reason.what()));
    }
}

std::string where_registry_says(const protocol::RegistryAddress& servo) {
    try {
        return protocol::resolve_servo(servo.servo, protocol::domain_said());
    } catch (const std::runtime_error& reason) {
        throw Error(Error::Kind::no_servo, reason.what());
    }
}

std::string servo_name(const std::string& address) {
    try {
        const protocol::ServoAddress servo = protocol::servo_address(address);
        return address.find('/') != std::string::npos ? servo.socket : servo.name;
    } catch (const std::runtime_error& reason) {
        throw Error(Error::Kind::no_servo, detail::format("address {}", reason.what()));
    }
}

}  // namespace knurl::detail

namespace knurl {

void check_address(const std::string& address) {
    try {
        if (protocol::registry_address(address)) return;
        if (address.starts_with(detail::remote_prefix))
            bridge::check_host_and_port(address.substr(detail::remote_prefix.size()));
        else
            protocol::servo_address(address);
    } catch (const std::runtime_error& reason) {
        throw Error(Error::Kind::no_servo, reason.what());
    }
}

}  // namespace knurl
