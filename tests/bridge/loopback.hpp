#pragma once
// Sockets at this host's loopback address, at any free port.

#include <cstdint>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <knurl/shm/fd.hpp>

namespace knurl::bridge::test {

inline sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

/// `type`: SOCK_STREAM (it does not listen yet) or SOCK_DGRAM; with SOCK_NONBLOCK if wanted.
inline shm::UniqueFd bound(int type, std::uint16_t port = 0) {
    shm::UniqueFd fd(::socket(AF_INET, type | SOCK_CLOEXEC, 0));
    const sockaddr_in address = loopback(port);
    EXPECT_EQ(::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return fd;
}

/// A socket at another loopback address, such as 127.0.0.2, which represents another host.
inline shm::UniqueFd bound_at(const char* host, int type = SOCK_DGRAM) {
    shm::UniqueFd fd(::socket(AF_INET, type | SOCK_CLOEXEC, 0));
    sockaddr_in address = loopback(0);
    EXPECT_EQ(::inet_pton(AF_INET, host, &address.sin_addr), 1);
    EXPECT_EQ(::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return fd;
}

inline std::uint16_t port_of(const shm::UniqueFd& fd) {
    sockaddr_in address{};
    socklen_t bytes = sizeof address;
    ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &bytes);
    return ntohs(address.sin_port);
}

/// A connection to that port from another loopback address.
inline shm::UniqueFd dial_from(const char* host, std::uint16_t port) {
    shm::UniqueFd fd = bound_at(host, SOCK_STREAM);
    const sockaddr_in to = loopback(port);
    ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to);
    return fd;
}

/// A connection to that port. With SOCK_NONBLOCK in `type` it may still be in progress.
inline shm::UniqueFd dial(std::uint16_t port, int type) {
    shm::UniqueFd fd(::socket(AF_INET, type | SOCK_CLOEXEC, 0));
    const sockaddr_in to = loopback(port);
    ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to);
    return fd;
}

}  // namespace knurl::bridge::test
