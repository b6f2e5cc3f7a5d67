#pragma once
// The echoes beside a bridge: where they are, and the size of their replies.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <knurl/bridge/wire_sizes.hpp>

#include "latency_tcp.hpp"
#include "latency_udp.hpp"

namespace knurl::cli {

/// The floors of a network. Empty without an echo, and on one host.
class NetworkFloors {
  public:
    /// `bridge`: "host:port"; empty: none. `echo`: on the bridge's host, "host:port"; empty: one of its own,
    /// if the bridge is on this host. Prints to standard error, in one line, what is missing and how to get
    /// it. Throws std::runtime_error for an invalid address.
    NetworkFloors(const std::string& bridge, const std::string& echo, bridge::WireSizes sizes,
                  const Placement& placement);

    void udp_block(Nanoseconds length);
    /// One TCP ping-pong on a kept connection. `counts`: false while the connection is cold.
    void tcp_ping_pong(bool counts);

    /// The caller has taken the samples.
    void forget() {
        udp_samples_.clear();
        tcp_samples_.clear();
    }
    const std::vector<double>& udp_one_way() const { return udp_samples_; }     // ns
    const std::vector<double>& tcp_round_trip() const { return tcp_samples_; }  // ns

  private:
    void look_for(const bridge::Endpoint& echo);

    bridge::WireSizes sizes_;
    std::optional<UdpEcho> own_udp_;
    std::optional<TcpEcho> own_tcp_;
    std::optional<bridge::Endpoint> udp_, tcp_;
    std::optional<TcpCaller> caller_;
    int failures_ = 0;
    std::vector<double> udp_samples_, tcp_samples_;
};

/// Echoes by UDP and by TCP at the same port, for measurements from another host, until a signal ends it.
/// Prints its address to standard output.
[[noreturn]] void serve_echo(const std::string& at);

}  // namespace knurl::cli
