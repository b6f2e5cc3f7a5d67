#pragma once
// The lower bound for commands over the bridge on this network: a plain TCP ping-pong of the same size.

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/shm/fd.hpp>

#include "latency_floors.hpp"

namespace knurl::cli {

/// Listens, and echoes all data at once, in one thread (TCP_NODELAY). Each peer has a few KiB: one that does
/// not read is not read from, and delays nobody. When all places are taken, a new peer replaces the one that
/// has been silent longest.
class TcpEcho {
  public:
    static constexpr std::size_t places = 8;

    /// `placement`: of its thread, on the servo's CPU; none: as its maker's. Port 0: any free one, see at().
    /// Throws std::runtime_error.
    explicit TcpEcho(const bridge::Endpoint& at, const std::optional<Placement>& placement = std::nullopt);
    ~TcpEcho();
    TcpEcho(const TcpEcho&) = delete;
    TcpEcho& operator=(const TcpEcho&) = delete;
    const bridge::Endpoint& at() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// One connection to such an echo.
class TcpCaller {
  public:
    /// Waits for the connection until then; connected() has the result.
    TcpCaller(const bridge::Endpoint& echo, std::size_t bytes, Nanoseconds until);
    bool connected() const { return static_cast<bool>(fd_); }
    /// Sends that many bytes and waits until all are back: the round trip in ns. None: not in time, or the
    /// other end has closed.
    std::optional<double> round_trip(Nanoseconds until);

  private:
    bool take(Nanoseconds until);

    shm::UniqueFd fd_;
    std::vector<char> sent_, came_;
    std::uint64_t number_ = 0;
};

}  // namespace knurl::cli
