#pragma once

/// @file
/// Foxglove's WebSocket protocol (subprotocols `foxglove.sdk.v1` and `foxglove.websocket.v1`, which are the same on
/// the wire): what a servo does, for Foxglove and Lichtblick. A socket gets what it has subscribed to, and nothing is
/// computed for what nobody has. Nothing can be sent to the servo this way.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include <knurl/gateway/live_view.hpp>
#include <knurl/gateway/socket.hpp>

namespace knurl::gateway {

/// What Foxglove's sockets look at, once a tick.
struct FoxgloveLook {
    /// The servo answers.
    bool connected = false;
    /// Changes when another servo has taken the place of the one before.
    std::uint64_t epoch = 0;
    /// Name of the servo.
    std::string name;
    /// Why it does not answer; one line.
    std::string trouble;
    /// Its devices; valid until the next look.
    std::span<const SeenDevice> devices;
};

/// Most subscriptions of a socket.
inline constexpr std::size_t most_subscriptions = 256;
/// Longest text of a peer that is read (bytes).
inline constexpr std::size_t longest_request = 64 * 1024;

/// Channels and messages of all sockets of one servo. Belongs to the server's thread, and outlives its sockets.
class FoxgloveSource {
  public:
    /// `look`: called once a tick, by the first socket whose tick comes; not while there is none. `realtime_offset`:
    /// what is added to CLOCK_MONOTONIC to give CLOCK_REALTIME (ns).
    explicit FoxgloveSource(std::function<FoxgloveLook()> look,
                            std::function<std::int64_t()> realtime_offset = system_offset);
    ~FoxgloveSource();
    FoxgloveSource(const FoxgloveSource&) = delete;
    FoxgloveSource& operator=(const FoxgloveSource&) = delete;

    /// The protocol on a new socket.
    std::unique_ptr<SocketHandler> handler(Socket& socket);

    /// CLOCK_REALTIME - CLOCK_MONOTONIC (ns).
    static std::int64_t system_offset();

    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

/// What a LiveView sees; its tick comes before those of the sockets.
inline FoxgloveLook foxglove_look(const LiveView& view) {
    return {.connected = view.connected(),
            .epoch = view.epoch(),
            .name = view.name(),
            .trouble = view.trouble(),
            .devices = view.devices()};
}

}  // namespace knurl::gateway
