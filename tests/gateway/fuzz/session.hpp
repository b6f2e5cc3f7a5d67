#pragma once
// One server for all inputs of a target, and each input as a connection to it over a pair of sockets: no network, no
// thread, no clock.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <sys/socket.h>
#include <unistd.h>

#include <knurl/gateway/server.hpp>

#include "../../fuzz/require.hpp"

namespace knurl::gateway::fuzzed {

using fuzz::require;

inline int& handlers() {
    static int count = 0;
    return count;
}

/// Answers all that it is told with as much, and closes or throws on some of it.
class Mirror final : public SocketHandler {
  public:
    explicit Mirror(Socket& socket) : socket_(socket) { ++handlers(); }
    ~Mirror() override { --handlers(); }
    void text(std::string_view message) override {
        require(message.size() <= 4096, "no message is longer than the route takes");
        if (message == "close") return socket_.close(1000, "asked to");
        if (message == "throw") throw std::runtime_error("asked to");
        socket_.send_text(std::string(message));
    }
    void binary(std::span<const std::byte> message) override {
        require(message.size() <= 4096, "no message is longer than the route takes");
        socket_.send_binary({message.begin(), message.end()});
    }
    void tick(std::chrono::steady_clock::time_point) override {}

  private:
    Socket& socket_;
};

inline Site site() {
    const Access everybody{.without_key = Role::observe};
    const auto never = [](const Request&) -> Response {
        require(false, "nobody has a session");
        return {};
    };
    Site made{.login = true};
    made.http = {
        {.method = "GET", .path = "/", .answer = never},
        {.method = "GET",
         .path = "/open*",
         .access = everybody,
         .answer =
             [](const Request& request) {
                 require(request.path.starts_with("/open"), "the path is the route's");
                 for (const char c : request.path)
                     require(static_cast<unsigned char>(c) >= ' ', "no control characters");
                 return Response{.body = request.path, .etag = "a"};
             }},
        {.method = "POST",
         .path = "/post",
         .access = everybody,
         .most_body = 1000,
         .answer =
             [](const Request& request) {
                 require(request.body.size() <= 1000, "no body is longer than the route takes");
                 return Response{.body = request.body};
             }},
        {.method = "POST",
         .path = "/control",
         .access = {.needs = Role::control, .without_key = Role::observe},
         .answer = never},
    };
    made.sockets = {
        {.path = "/live",
         .make = [](Socket&, const std::string&) -> std::unique_ptr<SocketHandler> {
             require(false, "nobody has a session");
             return nullptr;
         }},
        {.path = "/socket",
         .access = everybody,
         .most_message = 4096,
         .make = [](Socket& socket, const std::string&) { return std::make_unique<Mirror>(socket); }}};
    return made;
}

/// Sends `first`, then the bytes in pieces of up to `piece`; returns what the server has answered.
inline std::string converse(std::string_view first, std::span<const std::uint8_t> bytes, std::size_t piece) {
    static Server server;
    static const Site served = site();
    std::array<int, 2> ends{};
    require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0, "a pair of sockets");
    server.serve(ends[0], 80, served);
    std::string answer;
    std::array<char, 8192> buffer;
    const auto settle = [&] {
        for (int i = 0; i < 64; ++i) {
            const std::size_t steps = server.poll();
            const ssize_t got = ::recv(ends[1], buffer.data(), buffer.size(), MSG_DONTWAIT);
            if (got > 0) answer.append(buffer.data(), static_cast<std::size_t>(got));
            if (steps == 0 && got <= 0) return;
        }
    };
    const auto send = [&](const void* data, std::size_t size) {
        [[maybe_unused]] const ssize_t sent = ::send(ends[1], data, size, MSG_DONTWAIT | MSG_NOSIGNAL);
        settle();
    };
    if (!first.empty()) send(first.data(), first.size());
    while (!bytes.empty()) {
        const std::size_t now = std::min(piece, bytes.size());
        send(bytes.data(), now);
        bytes = bytes.subspan(now);
    }
    ::close(ends[1]);
    settle();
    require(server.sockets() == 0 && handlers() == 0, "a peer that has gone leaves nothing behind");
    return answer;
}

/// The first byte of an input says in which pieces the others come.
inline std::size_t piece_of(std::uint8_t byte) {
    return byte == 0 ? 100000 : byte;
}

}  // namespace knurl::gateway::fuzzed
