#pragma once
// The echoes beside a bridge: where they are, and how large what they send back is.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <knurl/bridge/wire_sizes.hpp>

#include "latency_tcp.hpp"
#include "latency_udp.hpp"

namespace knurl::cli {

/// The floors of a network; nothing of them where nobody echoes, and on one box nothing at all.
class NetworkFloors {
  public:
    /// `bridge`: "host:port"; empty: there is none. `echo`: of its host, "host:port"; empty: our own, if the
    /// bridge is on this host. Says in one line on standard error what is missing and how it is had. Throws
    /// std::runtime_error for an address that is none.
    NetworkFloors(const std::string& bridge, const std::string& echo, bridge::WireSizes sizes,
                  const Placement& placement);

    void udp_block(Nanoseconds length);
    /// One TCP ping-pong, on a connection that is kept. `counts`: else its connection is still cold.
    void tcp_ping_pong(bool counts);

    /// The samples are somebody else's now.
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

/// Echoes by UDP and by TCP at the same port, for a measurement from another host, until it is ended by a
/// signal. Says where in a line on standard output.
[[noreturn]] void serve_echo(const std::string& at);

}  // namespace knurl::cli
