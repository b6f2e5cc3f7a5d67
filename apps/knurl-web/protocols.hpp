#pragma once
// What knurl-web speaks: a function for each protocol, which makes the handlers of its sockets.

#include <memory>
#include <string>
#include <vector>

#include <knurl/gateway/server.hpp>

namespace knurl::web {

/// What the command line says, for those who serve.
struct Settings {
    std::string servo = "default";
    std::string recordings;                    // folder; empty: nothing is recorded
    std::vector<std::string> inverse_devices;  // that clients of the Inverse Service may move
};

/// What all sockets share: one look at the servo a tick, however many look.
class Protocols {
  public:
    explicit Protocols(Settings settings);
    ~Protocols();

    /// Before the sockets' ticks.
    void tick(std::chrono::steady_clock::time_point now);
    /// Once, behind the addresses, at the start: a remark about the servo; empty: it runs.
    std::string remark() const;

    /// The page: knurl.live.v1.
    gateway::MakeHandler make_live_handler();
    /// The page's requests besides its files: meshes that it sends, assets that it draws.
    std::vector<gateway::HttpRoute> page_routes();
    /// Foxglove: foxglove.sdk.v1, foxglove.websocket.v1.
    gateway::MakeHandler make_foxglove_handler();
    /// The Inverse Service: its socket, its socket of events, its requests.
    gateway::MakeHandler make_inverse_handler();
    gateway::MakeHandler make_inverse_events_handler();
    std::vector<gateway::HttpRoute> inverse_routes();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::web
