#pragma once
// Two ends of a TCP connection on loopback, and helpers for the tests of the connection.

#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "frame_stream.hpp"
#include "loopback.hpp"

namespace knurl::bridge::test {

struct Sockets {
    shm::UniqueFd client, server;
};

inline Sockets connected_sockets() {
    const shm::UniqueFd listener = bound(SOCK_STREAM);
    EXPECT_EQ(::listen(listener.get(), 1), 0);
    Sockets sockets;
    sockets.client = dial(port_of(listener), SOCK_STREAM);
    sockets.server = shm::UniqueFd(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
    return sockets;
}

inline std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text));
}

inline std::string text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A frame in its form on the wire.
inline std::string wire_frame(std::uint32_t bytes, std::string_view payload, std::uint16_t type = 7,
                              std::uint16_t stream = 0) {
    const FrameHeader header{.bytes = bytes, .type = type, .stream = stream};
    std::string wire(sizeof header, '\0');
    std::memcpy(wire.data(), &header, sizeof header);
    return wire.append(payload);
}

struct Received {
    std::uint16_t type, stream;
    std::string payload;
    bool operator==(const Received&) const = default;
};

inline std::vector<Received> take_all(FrameStream& stream) {
    std::vector<Received> all;
    while (const Frame* frame = stream.next())
        all.push_back({frame->type, frame->stream, text_of(frame->payload)});
    return all;
}

/// Serves the streams like a polling program, until `done`; false: nothing happened for a second.
inline bool serve(std::initializer_list<FrameStream*> streams, const std::function<bool()>& done) {
    for (int rounds = 0; rounds < 100'000; ++rounds) {
        for (FrameStream* stream : streams) stream->pump();
        if (done()) return true;
        std::vector<pollfd> fds;
        for (const FrameStream* stream : streams)
            if (stream->state() != FrameStream::State::closed)
                fds.push_back({.fd = stream->fd(),
                               .events = static_cast<short>(POLLIN | (stream->wants_write() ? POLLOUT : 0)),
                               .revents = 0});
        if (fds.empty() || ::poll(fds.data(), fds.size(), 1000) == 0) return false;
    }
    return false;
}

inline bool is_open(const FrameStream& stream) {
    return stream.state() == FrameStream::State::open;
}
inline bool is_closed(const FrameStream& stream) {
    return stream.state() == FrameStream::State::closed;
}

/// Both ends as streams; with TLS and a key if contexts are given.
struct Pair {
    explicit Pair(std::shared_ptr<const TlsContext> client_tls = nullptr,
                  std::shared_ptr<const TlsContext> server_tls = nullptr,
                  FrameStream::Limits limits = FrameStream::Limits{})
        : Pair(connected_sockets(), std::move(client_tls), std::move(server_tls), limits) {}
    Pair(Sockets sockets, std::shared_ptr<const TlsContext> client_tls,
         std::shared_ptr<const TlsContext> server_tls, FrameStream::Limits limits)
        : client(std::move(sockets.client), false, std::move(client_tls), limits),
          server(std::move(sockets.server), true, std::move(server_tls), limits) {}

    bool open() {
        return serve({&client, &server}, [&] { return is_open(client) && is_open(server); });
    }
    FrameStream client, server;
};

inline Pair encrypted_pair(FrameStream::Limits limits = FrameStream::Limits{}) {
    const Key key = make_key("lab", Role::control);
    return Pair(TlsContext::client(key), TlsContext::server({make_key("other", Role::observe), key}), limits);
}

}  // namespace knurl::bridge::test
