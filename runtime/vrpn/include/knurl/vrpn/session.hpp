#pragma once

/// @file
/// One client of the server: what it is told, and what becomes of what it says. It knows no socket, no servo and no
/// clock, so that tests and a fuzzer play all three.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl/client/client.hpp>
#include <knurl/gateway/peer_hand.hpp>
#include <knurl/vrpn/mapping.hpp>
#include <knurl/vrpn/wire.hpp>

namespace knurl::vrpn {

/// Which way a message goes.
enum class Service {
    /// TCP.
    reliable,
    /// UDP, or TCP where the client has none.
    quick,
};

/// A device as clients see it: a sender of VRPN.
struct SenderInfo {
    /// Its name: "Phantom0".
    std::string name{};
    /// What the servo says of the device; none: it has not been seen yet.
    std::optional<DeviceDescription> device{};
    /// Its newest report.
    std::optional<HandReport> newest{};
};

/// What is around a session.
class Surroundings {
  public:
    virtual ~Surroundings() = default;
    /// Sends whole messages, as they are. `quick` ones fit into a datagram, and may be dropped.
    virtual void send(Service service, std::span<const std::byte> messages) = 0;
    /// The client takes datagrams at this port of the host from which it has connected.
    virtual void takes_datagrams(std::uint16_t port) = 0;
    /// All senders. Their number and names stay.
    virtual std::span<const SenderInfo> senders() const = 0;
    /// Why this client may command no force on that sender, in one line; empty: it may, and from now on no other client.
    virtual std::string hold(std::size_t sender) = 0;
    /// A hand for the client on that sender.
    virtual std::unique_ptr<gateway::PeerCommands> make_hand(std::size_t sender) = 0;
    /// What the wall clock shows (ns since 1970).
    virtual std::int64_t wall_clock() const = 0;
    /// A line for the log.
    virtual void log(const std::string& line) = 0;
};

/// How sessions behave.
struct SessionOptions {
    /// Axes, units, representations.
    Mapping mapping{};
    /// Most reports a second (Hz); a client may ask for less. 0: each report of the servo.
    double rate = 1000;
    /// How long the force of a client lasts that says nothing. 0: while it is connected.
    std::chrono::nanoseconds silent_after{0};
    /// How often a claim is renewed.
    std::chrono::nanoseconds renew = std::chrono::milliseconds(80);
    /// Buttons that are reported.
    std::int32_t buttons = 8;
    /// Time between two lines of one kind to a client.
    std::chrono::nanoseconds repeat = std::chrono::seconds(1);
};

/// A client. Its end lets go of what it has commanded.
class Session {
  public:
    /// A point in time of the steady clock.
    using Time = std::chrono::steady_clock::time_point;

    /// `options` and `around` must outlive it.
    Session(const SessionOptions& options, Surroundings& around);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// After the cookies: describes senders and types. `udp_port`: where it takes datagrams, at `address`; 0: nowhere.
    void begin(const std::string& address, std::uint16_t udp_port, Time now);
    /// A message. Returns why the client is to be dropped, in one line; empty: it is not.
    std::string receive(const Message& message, Service from, Time now);
    /// All messages that were there have been received: what they changed takes effect together.
    void received(Time now);
    /// New reports of a sender, in order.
    void report(std::size_t sender, std::span<const HandReport> reports, Time now);
    /// Comes at least every 50 ms.
    void tick(Time now);
    /// It commands force on that sender.
    bool commands(std::size_t sender) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::vrpn
