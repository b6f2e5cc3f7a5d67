#pragma once
// Where a bridge listens: host and port, as a user writes them.

#include <cstdint>
#include <string>
#include <vector>

#include <sys/socket.h>

namespace knurl::bridge {

inline constexpr const char* default_port = "4096";

struct Endpoint {
    sockaddr_storage address{};
    socklen_t length = 0;
    std::string text{};  // as it was given: "lab:4096"

    const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
    sockaddr* get() { return reinterpret_cast<sockaddr*>(&address); }
    int family() const { return address.ss_family; }
    std::uint16_t port() const;  // 0: whichever is free
    bool loopback() const;
};

inline constexpr std::size_t most_addresses = 8;  // of one name that are tried

/// "host:port", "[IPv6]:port", or a host alone (port 4096): all its addresses, best first, each once; at
/// least one, at most most_addresses. May ask a name server. Throws std::runtime_error: one line that says
/// what is wrong with it and how to write it.
std::vector<Endpoint> resolve_all(const std::string& host_and_port);
/// The first of them.
Endpoint resolve(const std::string& host_and_port);

/// "192.168.1.7:40112", "[::1]:40112".
std::string numeric(const sockaddr_storage& address);
/// The same host, whatever the port.
bool same_host(const sockaddr_storage& a, const sockaddr_storage& b);

}  // namespace knurl::bridge
