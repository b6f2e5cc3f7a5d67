#pragma once
// The bridge's two sockets, for TCP and for UDP, at one address and port.

#include <span>
#include <string>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::bridge {

struct Listening {
    shm::UniqueFd callers, datagrams;
    std::string at{};  // "127.0.0.1:4096"
};

/// Listens at the first endpoint that is available; without `keys` only at loopback addresses. Port 0: any
/// free port. Throws std::runtime_error, one line.
Listening listen_at(std::span<const Endpoint> endpoints, bool keys);

}  // namespace knurl::bridge
