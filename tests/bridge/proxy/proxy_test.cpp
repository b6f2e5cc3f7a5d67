// Tests the bad network itself: its guarantees, and that a seed reproduces a run.

#include "proxy.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <knurl/shm/fd.hpp>

#include "../loopback.hpp"

namespace knurl::bridge::proxy {
namespace {

using shm::UniqueFd;
using test::bound;
using test::dial;
using test::loopback;
using test::port_of;

TEST(NetworkProfile, IsTheSameForTheSameSeedWhateverIsAskedInBetween) {
    const NetworkProfile bad{
        .loss = 0.3, .duplicate = 0.2, .reorder = 0.2, .delay = 0.05, .jitter = 0.1, .swing = 0.1};
    for (std::uint64_t n = 0; n < 1000; ++n) {
        const double now = 0.001 * static_cast<double>(n);
        const Fate fate = fate_of(bad, 7, Way::forth, 3, n, now);
        fate_of(bad, 7, Way::back, 3, n, now);
        EXPECT_EQ(fate, fate_of(bad, 7, Way::forth, 3, n, now));
    }
}

TEST(NetworkProfile, DiffersBySeedWayAndFlow) {
    const NetworkProfile half{.loss = 0.5};
    const auto pattern = [&](std::uint64_t seed, Way way, std::uint32_t flow) {
        std::string s;
        for (std::uint64_t n = 0; n < 64; ++n)
            s += static_cast<char>('0' + fate_of(half, seed, way, flow, n, 0).copies);
        return s;
    };
    EXPECT_NE(pattern(1, Way::forth, 0), pattern(2, Way::forth, 0));
    EXPECT_NE(pattern(1, Way::forth, 0), pattern(1, Way::back, 0));
    EXPECT_NE(pattern(1, Way::forth, 0), pattern(1, Way::forth, 1));
}

TEST(NetworkProfile, KeepsItsRatesAndRanges) {
    const NetworkProfile bad{.loss = 0.3, .duplicate = 0.1, .delay = 0.05, .jitter = 0.02, .swing = 0.1};
    double lost = 0, doubled = 0, least = 1, most = 0;
    constexpr int n = 100'000;
    for (int i = 0; i < n; ++i) {
        const Fate fate = fate_of(bad, 1, Way::forth, 0, static_cast<std::uint64_t>(i), 0.001 * i);
        lost += fate.copies == 0;
        doubled += fate.copies == 2;
        for (int copy = 0; copy < fate.copies; ++copy) {
            least = std::min(least, fate.delays[copy]);
            most = std::max(most, fate.delays[copy]);
        }
    }
    EXPECT_NEAR(lost / n, 0.3, 0.01);
    EXPECT_NEAR(doubled / n, 0.7 * 0.1, 0.01);
    EXPECT_NEAR(least, 0.05, 0.005);
    EXPECT_NEAR(most, 0.17, 0.01);
}

TEST(NetworkProfile, SwingsWithoutJumps) {
    const NetworkProfile swing{.swing = 0.2, .swing_period = 0.1};
    double last = fate_of(swing, 1, Way::forth, 0, 0, 0).delays[0];
    for (std::uint64_t i = 1; i < 5000; ++i) {
        const double delay = fate_of(swing, 1, Way::forth, 0, i, 0.001 * static_cast<double>(i)).delays[0];
        EXPECT_LE(std::abs(delay - last), 0.2 / 0.1 * 0.001 + 1e-9);
        last = delay;
    }
}

TEST(NetworkProfile, LosesNothingOfAStream) {
    const NetworkProfile bad{.loss = 0.5, .delay = 0.1};
    for (std::uint64_t n = 0; n < 100; ++n) {
        const double delay = stream_delay(bad, 1, Way::forth, 0, n, 0);
        EXPECT_TRUE(std::abs(delay - 0.1) < 1e-9 || std::abs(delay - 0.31) < 1e-9) << delay;
    }
}

/// A server with both sockets, the proxy, and a client of it.
struct Wire {
    explicit Wire(const NetworkProfile& profile, std::uint64_t seed = 1)
        : tcp(bound(SOCK_STREAM)), udp(bound(SOCK_DGRAM, port_of(tcp))), proxy([&] {
              ::listen(tcp.get(), 4);
              Proxy::Options options;
              options.to_port = port_of(tcp);
              options.seed = seed;
              options.profile = profile;
              return options;
          }()) {
        const sockaddr_in to = loopback(proxy.port());
        ::connect(client.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
    static bool readable(const UniqueFd& fd, int ms) {
        pollfd p{.fd = fd.get(), .events = POLLIN, .revents = 0};
        return ::poll(&p, 1, ms) == 1;
    }
    void send(int n) { EXPECT_EQ(::send(client.get(), &n, sizeof n, 0), static_cast<ssize_t>(sizeof n)); }
    /// What arrives until nothing more comes for a while, or `count` have arrived.
    std::vector<int> received(std::size_t count) {
        std::vector<int> all;
        while (all.size() < count && readable(udp, 1000)) {
            int n = 0;
            socklen_t bytes = sizeof from;
            ::recvfrom(udp.get(), &n, sizeof n, 0, reinterpret_cast<sockaddr*>(&from), &bytes);
            all.push_back(n);
        }
        return all;
    }

    UniqueFd tcp, udp;
    Proxy proxy;
    UniqueFd client = bound(SOCK_DGRAM);
    sockaddr_in from{};
};

TEST(Proxy, CarriesDatagramsBothWays) {
    Wire wire(NetworkProfile{});
    wire.send(42);
    EXPECT_EQ(wire.received(1), (std::vector<int>{42}));
    const int answer = 43;
    ::sendto(wire.udp.get(), &answer, sizeof answer, 0, reinterpret_cast<sockaddr*>(&wire.from),
             sizeof wire.from);
    ASSERT_TRUE(Wire::readable(wire.client, 1000));
    int got = 0;
    ::recv(wire.client.get(), &got, sizeof got, 0);
    EXPECT_EQ(got, 43);
}

TEST(Proxy, LosesAndDoublesTheSameOnesInEveryRun) {
    const NetworkProfile bad{.loss = 0.3, .duplicate = 0.2};
    std::size_t expected = 0;
    for (std::uint64_t n = 0; n < 200; ++n)
        expected += static_cast<std::size_t>(fate_of(bad, 5, Way::forth, 0, n, 0).copies);
    std::vector<std::vector<int>> runs;
    std::vector<std::uint64_t> digests;
    for (int run = 0; run < 2; ++run) {
        Wire wire(bad, 5);
        for (int n = 0; n < 200; ++n) wire.send(n);
        runs.push_back(wire.received(expected));
        digests.push_back(wire.proxy.counts().fates);
    }
    EXPECT_EQ(runs[0].size(), expected);
    EXPECT_EQ(runs[0], runs[1]);
    EXPECT_EQ(digests[0], digests[1]);
}

TEST(Proxy, ReordersDatagrams) {
    Wire wire(NetworkProfile{.reorder = 0.3, .held = 0.05});
    for (int n = 0; n < 100; ++n) wire.send(n);
    const std::vector<int> all = wire.received(100);
    EXPECT_EQ(all.size(), 100u);
    EXPECT_FALSE(std::is_sorted(all.begin(), all.end()));
}

TEST(Proxy, ACutLosesDatagramsAndTellsNobody) {
    Wire wire(NetworkProfile{});
    wire.send(1);
    EXPECT_EQ(wire.received(1).size(), 1u);
    wire.proxy.cut();
    wire.send(2);
    EXPECT_FALSE(Wire::readable(wire.udp, 100));
    wire.proxy.heal();
    wire.send(3);
    EXPECT_EQ(wire.received(1), (std::vector<int>{3}));
    EXPECT_EQ(wire.proxy.counts().lost[0], 1u);
}

TEST(Proxy, AStreamArrivesWholeInOrderHoweverBadTheNetwork) {
    Wire wire(NetworkProfile{.loss = 0.3, .reorder = 0.3, .delay = 0.001, .jitter = 0.005});
    const UniqueFd client = dial(wire.proxy.port(), SOCK_STREAM);
    UniqueFd server(::accept(wire.tcp.get(), nullptr, nullptr));
    std::string sent, got;
    for (int i = 0; sent.size() < 500'000; ++i) sent += std::to_string(i);
    std::thread writer([&] {
        ::send(client.get(), sent.data(), sent.size(), MSG_NOSIGNAL);
        ::shutdown(client.get(), SHUT_WR);
    });
    std::string piece(65536, '\0');
    for (ssize_t n; (n = ::recv(server.get(), piece.data(), piece.size(), 0)) > 0;)
        got.append(piece, 0, static_cast<std::size_t>(n));
    writer.join();
    EXPECT_EQ(got == sent, true) << got.size() << " of " << sent.size();
}

TEST(Proxy, AHangUpResetsStreams) {
    Wire wire(NetworkProfile{});
    const UniqueFd client = dial(wire.proxy.port(), SOCK_STREAM);
    UniqueFd server(::accept(wire.tcp.get(), nullptr, nullptr));
    wire.proxy.hang_up();
    char byte;
    EXPECT_EQ(::recv(client.get(), &byte, 1, 0), -1);
    EXPECT_EQ(errno, ECONNRESET);
}

TEST(Proxy, AnAddressInUseIsOneLine) {
    Wire wire(NetworkProfile{});
    Proxy::Options options;
    options.port = wire.proxy.port();
    options.to_port = 1;
    EXPECT_THROW(Proxy{options}, std::runtime_error);
    options.port = 0;
    options.to = "nowhere";
    EXPECT_THROW(Proxy{options}, std::runtime_error);
}

}  // namespace
}  // namespace knurl::bridge::proxy
