// Two hosts that reach each other and nothing else; where they cannot be made, one.

#include "two_hosts.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

namespace knurl::bridge::test {
namespace {

using Host = TwoHosts::Host;

sockaddr_in at(const std::string& address, std::uint16_t port) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_port = htons(port);
    ::inet_pton(AF_INET, address.c_str(), &a.sin_addr);
    return a;
}

TEST(TwoHosts, ReachEachOtherOverTheWire) {
    const TwoHosts hosts;
    if (!hosts.two()) GTEST_SKIP() << hosts.why();
    shm::UniqueFd server, client;
    sockaddr_in to = at(hosts.address(Host::server), 0);
    {
        const TwoHosts::On on(hosts, Host::server);
        server = shm::UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        ASSERT_EQ(::bind(server.get(), reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
        socklen_t bytes = sizeof to;
        ::getsockname(server.get(), reinterpret_cast<sockaddr*>(&to), &bytes);
    }
    {
        const TwoHosts::On on(hosts, Host::client);
        client = shm::UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    }
    char byte = 'x';
    ASSERT_EQ(::sendto(client.get(), &byte, 1, 0, reinterpret_cast<sockaddr*>(&to), sizeof to), 1);
    pollfd p{.fd = server.get(), .events = POLLIN, .revents = 0};
    ASSERT_EQ(::poll(&p, 1, 2000), 1);
    sockaddr_in from{};
    socklen_t bytes = sizeof from;
    ::recvfrom(server.get(), &byte, 1, 0, reinterpret_cast<sockaddr*>(&from), &bytes);
    EXPECT_EQ(from.sin_addr.s_addr, at(hosts.address(Host::client), 0).sin_addr.s_addr);

    // And not from outside of them.
    const shm::UniqueFd outside(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ::sendto(outside.get(), &byte, 1, 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
    EXPECT_EQ(::poll(&p, 1, 50), 0);
}

}  // namespace
}  // namespace knurl::bridge::test
