#pragma once

/// @file
/// Where a bridge listens: host and port, as a user writes them.

#include <cstdint>
#include <string>
#include <vector>

#include <sys/socket.h>

namespace knurl::bridge {

/// Port of a bridge where none is given.
inline constexpr const char* default_port = "4096";

/// Where a bridge listens: an address and a port.
struct Endpoint {
    /// The socket's address.
    sockaddr_storage address{};
    /// Its length (bytes).
    socklen_t length = 0;
    /// As it was given: "lab:4096".
    std::string text{};

    /// For the socket calls.
    const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
    /// For the socket calls.
    sockaddr* get() { return reinterpret_cast<sockaddr*>(&address); }
    /// AF_INET or AF_INET6.
    int family() const { return address.ss_family; }
    /// The port; 0: whichever is free.
    std::uint16_t port() const;
    /// True: this host itself.
    bool loopback() const;
};

/// Most addresses of one name that are tried.
inline constexpr std::size_t most_addresses = 8;

/// Resolves "host:port", "[IPv6]:port", or a host alone (port 4096): all its addresses, best first, each
/// once; at least one, at most most_addresses. May ask a name server. Throws std::runtime_error: one line
/// that says what is wrong with it and how to write it.
std::vector<Endpoint> resolve_all(const std::string& host_and_port);
/// The first address of resolve_all.
Endpoint resolve(const std::string& host_and_port);

/// The address in digits: "192.168.1.7:40112", "[::1]:40112".
std::string numeric(const sockaddr_storage& address);
/// True: the same host, whatever the port.
bool same_host(const sockaddr_storage& a, const sockaddr_storage& b);

}  // namespace knurl::bridge
