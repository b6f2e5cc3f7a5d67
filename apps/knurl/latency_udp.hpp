#pragma once
// The lower bound for a bridge on this network: a plain UDP echo with blocking readers at both ends.

#include <cstddef>
#include <memory>
#include <vector>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/shm/fd.hpp>

#include "latency_floors.hpp"

namespace knurl::cli {

/// Returns each datagram to its sender, in a thread on the servo's CPU, at a free port of 127.0.0.1.
class UdpEcho {
  public:
    explicit UdpEcho(const Placement& placement);
    ~UdpEcho();
    UdpEcho(const UdpEcho&) = delete;
    UdpEcho& operator=(const UdpEcho&) = delete;
    const bridge::Endpoint& at() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Does the same in this thread.
[[noreturn]] void serve_udp_echo(shm::UniqueFd socket);
/// Throws std::runtime_error.
shm::UniqueFd udp_echo_socket(const bridge::Endpoint& at);

/// Is there an echo? Tries for two seconds.
bool udp_echoes(const bridge::Endpoint& echo);

/// Half of a round trip of `bytes`, one each millisecond, appended in ns. Lost datagrams are left out.
void udp_echo_block(const bridge::Endpoint& echo, std::size_t bytes, Nanoseconds length,
                    std::vector<double>& samples);

}  // namespace knurl::cli
