#pragma once

/// @file
/// A WebSocket as a protocol sees it. The server (server.hpp) carries bytes and decides who may connect; a protocol is
/// a SocketHandler, which knows neither Asio nor a servo's memory and is tested with a Socket made of two vectors.
///
/// Everything of one server runs in one thread.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace knurl::gateway {

/// What a caller may do; as the role of a bridge's key. Each includes those before it.
enum class Role {
    /// Reads.
    observe,
    /// Changes what is felt on a device that somebody else has switched on.
    render,
    /// Arms, disarms, resets a fault, records.
    control
};

/// One open connection.
class Socket {
  public:
    virtual ~Socket() = default;
    /// Sends a message of UTF-8 text, behind those that wait. A peer that leaves more than ServerOptions::most_waiting
    /// bytes unread is closed.
    virtual void send_text(std::string text) = 0;
    /// Sends a message of bytes.
    virtual void send_binary(std::vector<std::byte> bytes) = 0;
    /// Nothing waits to be sent. What is sent by the clock is sent only then: a slow peer gets the newest, never a queue.
    virtual bool idle() const = 0;
    /// Closes with a code of RFC 6455, 7.4, once what waits has been sent. The handler may go on to be called until
    /// then.
    virtual void close(std::uint16_t code, std::string reason) = 0;
    /// What this peer may do.
    virtual Role role() const = 0;
    /// Who it is, for messages: "127.0.0.1:40312".
    virtual const std::string& peer() const = 0;
    /// The session that opened it, as Request::session has it: what the same page sends by POST belongs to it. Empty:
    /// the peer has none.
    virtual std::string session() const { return {}; }
};

/// A protocol on one socket. Its destructor runs when the socket has closed: what the peer held is released there.
class SocketHandler {
  public:
    virtual ~SocketHandler() = default;
    /// A message of text came. Throws nothing: what it cannot use, it answers.
    virtual void text(std::string_view message) = 0;
    /// A message of bytes came.
    virtual void binary(std::span<const std::byte> message) = 0;
    /// Called at the server's tick rate (60 Hz).
    virtual void tick(std::chrono::steady_clock::time_point now) = 0;
};

/// Makes the handler of a new connection. `subprotocol`: the one that was agreed; empty: none was asked for. It may
/// send at once.
using MakeHandler =
    std::function<std::unique_ptr<SocketHandler>(Socket& socket, const std::string& subprotocol)>;

}  // namespace knurl::gateway
