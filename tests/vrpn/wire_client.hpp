#pragma once
// A VRPN client on loopback for benchmarks: it blocks until a datagram comes, and costs next to nothing else.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/vrpn/messages.hpp>
#include <knurl/vrpn/wire.hpp>

namespace vrpn_test {

using namespace knurl::vrpn;

inline sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return at;
}

/// A socket of loopback, and its port.
struct LoopbackSocket {
    explicit LoopbackSocket(int type) : fd(::socket(AF_INET, type | SOCK_CLOEXEC, 0)) {
        sockaddr_in at = loopback(0);
        socklen_t size = sizeof at;
        if (fd < 0 || ::bind(fd, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 ||
            ::getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size) != 0)
            throw std::runtime_error("no socket on loopback");
        port = ntohs(at.sin_port);
        const timeval patience{.tv_sec = 5, .tv_usec = 0};
        ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    }
    ~LoopbackSocket() { ::close(fd); }
    LoopbackSocket(const LoopbackSocket&) = delete;
    LoopbackSocket& operator=(const LoopbackSocket&) = delete;
    void send(std::span<const std::byte> bytes, std::uint16_t to) const {
        const sockaddr_in at = loopback(to);
        ::sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&at), sizeof at);
    }

    int fd;
    std::uint16_t port = 0;
};

class WireClient {
  public:
    WireClient(std::uint16_t server, const std::string& sender) : in_(SOCK_DGRAM), out_(SOCK_DGRAM) {
        LoopbackSocket listener(SOCK_STREAM);
        ::listen(listener.fd, 1);
        const std::string ask = "127.0.0.1 " + std::to_string(listener.port);
        out_.send(std::as_bytes(std::span(ask.c_str(), ask.size() + 1)), server);
        tcp_ = ::accept(listener.fd, nullptr, nullptr);
        if (tcp_ < 0) throw std::runtime_error("no VRPN server connects back");
        const timeval patience{.tv_sec = 5, .tv_usec = 0};
        ::setsockopt(tcp_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        std::vector<std::byte> bytes;
        const auto mine = cookie();
        bytes.assign(mine.begin(), mine.end());
        PayloadWriter payload;
        payload.put_text("127.0.0.1", 10);
        append(bytes, {.sender = in_.port, .type = system_type::udp}, payload.bytes());
        describe(bytes, system_type::sender, 0, sender);
        for (std::size_t i = 0; i < type_count; ++i)
            describe(bytes, system_type::type, static_cast<std::int32_t>(i), name_of(static_cast<Type>(i)));
        send_tcp(bytes);
        PayloadWriter nothing;
        bytes.clear();
        append(bytes, {.sender = 0, .type = static_cast<std::int32_t>(Type::ping)}, nothing.bytes());
        send_tcp(bytes);
        read_descriptions();
    }
    ~WireClient() { ::close(tcp_); }
    WireClient(const WireClient&) = delete;
    WireClient& operator=(const WireClient&) = delete;

    /// Sends a force message by a datagram.
    void send(Type type, std::span<const std::byte> payload) {
        timespec now{};
        ::clock_gettime(CLOCK_REALTIME, &now);
        bytes_.clear();
        append(bytes_,
               {.seconds = static_cast<std::int32_t>(now.tv_sec),
                .microseconds = static_cast<std::int32_t>(now.tv_nsec / 1000),
                .sender = 0,
                .type = static_cast<std::int32_t>(type),
                .sequence = sequence_++},
               payload);
        out_.send(bytes_, server_udp_);
    }
    /// Waits for a datagram with a message of that type: the header of the last one in it. None: none within 5 s.
    std::optional<Header> wait(Type type) {
        for (;;) {
            const ssize_t got = ::recv(in_.fd, datagram_.data(), datagram_.size(), 0);
            if (got < 0) return std::nullopt;
            std::span<const std::byte> rest = std::span(datagram_).first(static_cast<std::size_t>(got));
            Message message;
            std::optional<Header> last;
            while (split(rest, message) == Split::whole)
                if (const auto found = types_.find(message.header.type);
                    found != types_.end() && found->second == type)
                    last = message.header;
            if (last) return last;
        }
    }
    /// Forgets datagrams that are there.
    void forget() {
        while (::recv(in_.fd, datagram_.data(), datagram_.size(), MSG_DONTWAIT) >= 0) {
        }
        while (::recv(tcp_, datagram_.data(), datagram_.size(), MSG_DONTWAIT) > 0) {
        }
    }

  private:
    static void describe(std::vector<std::byte>& bytes, std::int32_t system, std::int32_t id,
                         std::string_view name) {
        PayloadWriter payload;
        put_name(payload, name);
        append(bytes, {.sender = id, .type = system}, payload.bytes());
    }
    void send_tcp(const std::vector<std::byte>& bytes) const {
        if (::send(tcp_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size()))
            throw std::runtime_error("the VRPN server has gone");
    }
    /// Up to the pong: by then all types are described.
    void read_descriptions() {
        std::vector<std::byte> stream;
        std::size_t greeted = cookie_bytes;
        for (;;) {
            std::array<std::byte, 4096> some;
            const ssize_t got = ::recv(tcp_, some.data(), some.size(), 0);
            if (got <= 0) throw std::runtime_error("the VRPN server does not answer");
            stream.insert(stream.end(), some.begin(), some.begin() + got);
            if (stream.size() < greeted) continue;
            stream.erase(stream.begin(),
                         stream.begin() + static_cast<std::ptrdiff_t>(std::exchange(greeted, 0)));
            std::span<const std::byte> rest(stream);
            Message message;
            while (split(rest, message) == Split::whole)
                if (take(message)) return;
            stream.assign(rest.begin(), rest.end());
        }
    }
    bool take(const Message& message) {
        if (message.header.type == system_type::udp)
            server_udp_ = static_cast<std::uint16_t>(message.header.sender);
        if (message.header.type == system_type::type)
            if (const auto type = type_of(described_name(message.payload).value_or("")))
                types_[message.header.sender] = *type;
        const auto found = types_.find(message.header.type);
        return found != types_.end() && found->second == Type::pong;
    }

    LoopbackSocket in_, out_;
    int tcp_ = -1;
    std::uint16_t server_udp_ = 0;
    std::uint32_t sequence_ = 0;
    std::map<std::int32_t, Type> types_;
    std::array<std::byte, 2048> datagram_{};
    std::vector<std::byte> bytes_;
};

}  // namespace vrpn_test
