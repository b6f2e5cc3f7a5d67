#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/bridge/host_and_port.hpp>
#include <knurl/link/text.hpp>

namespace knurl::bridge {

namespace {

struct Parts {
    std::string host, port;
};

[[noreturn]] void malformed(const std::string& text, const char* what) {
    throw std::runtime_error(detail::format(
        "address '{}': {}; give HOST:PORT, like lab:4096, 192.168.1.7:4096 or [::1]:4096", text, what));
}

Parts split(const std::string& text) {
    Parts parts{.host = text, .port = default_port};
    std::size_t colon = std::string::npos;
    if (!text.empty() && text.front() == '[') {
        const std::size_t end = text.find(']');
        if (end == std::string::npos) malformed(text, "']' is missing");
        parts.host = text.substr(1, end - 1);
        if (end + 1 < text.size()) {
            if (text[end + 1] != ':') malformed(text, "after ']' comes ':' and the port");
            colon = end + 1;
        }
    } else {
        colon = text.find(':');
        if (colon != text.rfind(':')) malformed(text, "an IPv6 address is written in brackets");
        parts.host = text.substr(0, colon);
    }
    if (colon != std::string::npos) parts.port = text.substr(colon + 1);
    if (parts.host.empty()) malformed(text, "the host is missing");
    const bool digits =
        !parts.port.empty() && parts.port.size() <= 5 &&
        std::all_of(parts.port.begin(), parts.port.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!digits || std::stoi(parts.port) > 65535) malformed(text, "the port is a number up to 65535");
    return parts;
}

const sockaddr_in6& as6(const sockaddr_storage& address) {
    return reinterpret_cast<const sockaddr_in6&>(address);
}
const sockaddr_in& as4(const sockaddr_storage& address) {
    return reinterpret_cast<const sockaddr_in&>(address);
}

}  // namespace

std::uint16_t Endpoint::port() const {
    return ntohs(family() == AF_INET ? as4(address).sin_port : as6(address).sin6_port);
}

bool Endpoint::loopback() const {
    if (family() == AF_INET) return (ntohl(as4(address).sin_addr.s_addr) >> 24) == 127;
    return family() == AF_INET6 && IN6_IS_ADDR_LOOPBACK(&as6(address).sin6_addr);
}

std::vector<Endpoint> resolve_all(const std::string& host_and_port) {
    const Parts parts = split(host_and_port);
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_family = AF_UNSPEC;
    addrinfo* found = nullptr;
    const int error = ::getaddrinfo(parts.host.c_str(), parts.port.c_str(), &hints, &found);
    if (error != 0)
        throw std::runtime_error(detail::format(
            "address '{}': host '{}' is not known here ({}); check its name, or give "
            "its number",
            host_and_port, parts.host, error == EAI_SYSTEM ? std::strerror(errno) : ::gai_strerror(error)));
    const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, ::freeaddrinfo);
    std::vector<Endpoint> all;
    for (const addrinfo* each = found; each != nullptr && all.size() < most_addresses; each = each->ai_next) {
        Endpoint endpoint{.length = each->ai_addrlen, .text = host_and_port};
        std::memcpy(&endpoint.address, each->ai_addr, each->ai_addrlen);
        // If ::1 and 127.0.0.1 have the same name in /etc/hosts, the library returns the second one twice.
        const bool known = std::any_of(all.begin(), all.end(), [&](const Endpoint& other) {
            return same_host(other.address, endpoint.address);
        });
        if (!known) all.push_back(endpoint);
    }
    return all;
}

void check_host_and_port(const std::string& host_and_port) {
    split(host_and_port);
}

Endpoint resolve(const std::string& host_and_port) {
    return resolve_all(host_and_port).front();
}

std::string numeric(const sockaddr_storage& address) {
    char text[INET6_ADDRSTRLEN] = "?";
    if (address.ss_family == AF_INET) {
        ::inet_ntop(AF_INET, &as4(address).sin_addr, text, sizeof text);
        return detail::format("{}:{}", text, ntohs(as4(address).sin_port));
    }
    ::inet_ntop(AF_INET6, &as6(address).sin6_addr, text, sizeof text);
    return detail::format("[{}]:{}", text, ntohs(as6(address).sin6_port));
}

bool same_host(const sockaddr_storage& a, const sockaddr_storage& b) {
    if (a.ss_family != b.ss_family) return false;
    if (a.ss_family == AF_INET) return as4(a).sin_addr.s_addr == as4(b).sin_addr.s_addr;
    return std::memcmp(&as6(a).sin6_addr, &as6(b).sin6_addr, sizeof(in6_addr)) == 0;
}

}  // namespace knurl::bridge
