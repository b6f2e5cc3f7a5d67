#pragma once

/// @file
/// A server of VRPN 07 for the devices of one servo: an ordinary client of that servo. One thread serves all peers, and no
/// peer can make it wait; a further one per device sends the reports.
///
///     vrpn::Server server({.senders = {{"Phantom0", "right"}}, .force_peers = {vrpn::host_range("127.0.0.1")}});
///     server.on_tick([&] { if (stop) server.stop(); });
///     server.run();
///
/// Who is not named in the options may not connect from another host, and commands no force from any.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <knurl/vrpn/session.hpp>

namespace knurl::vrpn {

/// Hosts by address: IPv4, as VRPN has it.
struct HostRange {
    /// The address, as a number.
    std::uint32_t network = 0;
    /// Which of its bits count.
    std::uint32_t mask = 0xffffffff;
    /// True: the address is one of these.
    bool has(std::uint32_t address) const noexcept { return (address & mask) == (network & mask); }
};
/// From "192.168.1.7", "10.1.0.0/16", or "localhost" (all of 127.0.0.0/8). Throws std::runtime_error.
HostRange host_range(const std::string& text);

/// A sender's name, and the device for which it stands.
struct SenderName {
    /// "Phantom0".
    std::string name;
    /// Name of the device; empty: the only one.
    std::string device;
};

/// How a server behaves.
struct ServerOptions {
    /// As Client::connect takes it.
    std::string servo = "knurl:default";
    /// Address at which it listens, in digits.
    std::string address = "127.0.0.1";
    /// Port of UDP and TCP; 0: whichever is free.
    std::uint16_t port = 3883;
    /// What clients find.
    std::vector<SenderName> senders = {{"Phantom0", ""}};
    /// Who may connect, besides this host.
    std::vector<HostRange> peers = {};
    /// Who may command force. Nobody else does.
    std::vector<HostRange> force_peers = {};
    /// What a session does.
    SessionOptions session{};
    /// Most clients at once.
    std::size_t most_connections = 64;
    /// Most clients at once of one host.
    std::size_t most_of_host = 32;
    /// Most bytes that wait for a client that does not read.
    std::size_t most_waiting = std::size_t{256} << 10;
    /// How long a client may leave unread what waits for it.
    std::chrono::nanoseconds stalled_after = std::chrono::seconds(5);
    /// How long a connection may take to begin.
    std::chrono::nanoseconds begin_within = std::chrono::seconds(3);
    /// Lines for the operator.
    std::function<void(const std::string&)> log{};
};

/// The server.
class Server {
  public:
    /// Listens. Throws std::runtime_error: one line, as of a port that is in use.
    explicit Server(ServerOptions options);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// The port at which it listens.
    std::uint16_t port() const;
    /// Called in the thread of run(): at least once a second, and after each signal.
    void on_tick(std::function<void()> work);
    /// Serves until stop().
    void run();
    /// Ends run(), from its own thread: in on_tick.
    void stop();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::vrpn
