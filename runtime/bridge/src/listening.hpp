#pragma once
// The bridge's two sockets, for callers and for datagrams, at one address and port.

#include <span>
#include <string>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::bridge {

struct Listening {
    shm::UniqueFd callers, datagrams;
    std::string at{};  // "127.0.0.1:4096"
};

/// At the first of these that can be had; without `keys` that is one of this host's own. Port 0: whichever is
/// free. Throws std::runtime_error, one line.
Listening listen_at(std::span<const Endpoint> endpoints, bool keys);

}  // namespace knurl::bridge
