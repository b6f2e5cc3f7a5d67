#pragma once

/// @file
/// The protocol of Haply's Inverse Service, so that its clients run on any device of a servo. Compatible with that
/// service, and not made by its makers. apps/knurl-web/inverse.md has the messages, and what differs.
///
/// Each device of the servo is shown twice: as an "inverse3" and as the "wireless_verse_grip" that is in its hand, since
/// clients want both.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/gateway/peer_hand.hpp>
#include <knurl/gateway/socket.hpp>
#include <knurl/link/device.hpp>
#include <knurl/protocol/report.hpp>

namespace knurl::gateway {

/// A device as this protocol shows it.
struct InverseDevice {
    /// What it is.
    DeviceDescription info;
    /// Four hexadecimal digits, made of its name, so that they are the same after each start.
    std::string id;
    /// Of the grip.
    std::string grip_id;
    /// The servo answers.
    bool connected = false;
    /// The newest report; none: there was none yet.
    std::optional<Report> report;
};

/// Where the devices come from: a servo's observers, or a test.
class InverseSource {
  public:
    virtual ~InverseSource() = default;
    /// Reads what is newest. Connects, at most once a second, while there is no servo; waits for nothing.
    virtual void look(std::chrono::steady_clock::time_point now) = 0;
    /// As of that look.
    virtual std::span<const InverseDevice> devices() const = 0;
    /// Why there is no servo; empty: there is one.
    virtual const std::string& trouble() const = 0;
};

/// The devices of a servo, on this host or behind a bridge.
std::unique_ptr<InverseSource> observed_devices(const std::string& servo);

/// How the service behaves.
struct InverseOptions {
    /// As Client::connect takes it.
    std::string servo = "knurl:default";
    /// Names of the devices that peers may move; none given: the simulated ones. The protocol has no keys, so who may use
    /// this host may use them. The others are shown, and can be read.
    std::optional<std::vector<std::string>> claimable{};
    /// Version of this program.
    std::string version = "0";
    /// How long a command is held.
    std::chrono::nanoseconds lapse = std::chrono::milliseconds(100);
    /// A line for the log. Lines that would repeat themselves are held back.
    std::function<void(const std::string&)> log = [](const std::string&) {};
    /// What time it is.
    std::function<std::chrono::steady_clock::time_point()> clock = std::chrono::steady_clock::now;
    /// Where the devices come from; null: the servo.
    std::unique_ptr<InverseSource> source{};
    /// What makes a peer's hold on a device; null: a PeerHand.
    std::function<std::unique_ptr<PeerCommands>(PeerOptions)> make_hand{};
};

/// A request of HTTP, decoded.
struct InverseRequest {
    /// "GET" or "POST".
    std::string method = "GET";
    /// "/devices".
    std::string path{};
    /// What `?session=` says; empty: nothing.
    std::string session{};
    /// JSON.
    std::string body{};
    /// What the caller may do.
    Role role = Role::observe;
};

/// An answer to it, of type application/json.
struct InverseReply {
    /// The status code.
    unsigned status = 200;
    /// The body.
    std::string body;
};

/// The three interfaces of the service. They share one state, and run in one thread.
struct Inverse {
    /// For the WebSocket at / of port 10001.
    MakeHandler simulation;
    /// For the WebSocket of port 10020.
    MakeHandler events;
    /// For HTTP at port 10001.
    std::function<InverseReply(const InverseRequest&)> http;
};

/// Makes the service.
Inverse make_inverse(InverseOptions options);

}  // namespace knurl::gateway
