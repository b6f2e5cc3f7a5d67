// How often callers of one host are admitted, and which one is dropped when too many wait.

#include <algorithm>
#include <memory>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

#include "caller_rate.hpp"
#include "frame_stream.hpp"
#include "waiting_room.hpp"

namespace knurl::bridge::test {
namespace {

constexpr std::int64_t second = 1'000'000'000;

sockaddr_storage host(std::uint32_t number) {
    sockaddr_storage storage{};
    auto& address = reinterpret_cast<sockaddr_in&>(storage);
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl((10u << 24) + number);
    return storage;
}

struct Callers : testing::Test {
    CallerRate rate;
    /// How many of `calls` calls from that host are admitted, from `now` on, at that interval.
    std::int64_t heard(std::uint32_t number, int calls, std::int64_t interval_ns) {
        std::int64_t count = 0;
        for (int i = 0; i < calls; ++i, now += interval_ns) count += rate.allows(host(number), now) ? 1 : 0;
        return count;
    }
    std::int64_t now = 1000 * second;
};

TEST_F(Callers, OfOneHostAreHeardSoOftenAndNoMore) {
    EXPECT_EQ(heard(1, 10'000, 0), CallerRate::burst) << "all at once";
    EXPECT_EQ(heard(1, 10'001, second / 1000), 10 * CallerRate::per_second) << "for ten seconds";
    now += 10 * second;
    EXPECT_EQ(heard(1, 10'000, 0), CallerRate::burst) << "after a rest";
}

TEST_F(Callers, ThatKeepToTheRateAreAlwaysHeard) {
    EXPECT_EQ(heard(1, 10'000, second / CallerRate::per_second), 10'000);
}

TEST_F(Callers, OfAnotherHostAreHeardAllTheSame) {
    heard(1, 10'000, 0);
    EXPECT_EQ(heard(2, 10, 0), 10);
}

TEST_F(Callers, OfACrowdOfHostsDoNotWashAwayWhoCallsTooOften) {
    heard(1, 10'000, 0);
    for (std::uint32_t n = 2; n < 1000; ++n) EXPECT_EQ(heard(n, 1, 0), 1) << n;
    EXPECT_EQ(heard(1, 10, 0), 0);
}

sockaddr_storage host6(const char* text) {
    sockaddr_storage storage{};
    auto& address = reinterpret_cast<sockaddr_in6&>(storage);
    address.sin6_family = AF_INET6;
    EXPECT_EQ(::inet_pton(AF_INET6, text, &address.sin6_addr), 1);
    return storage;
}

struct Waiting : testing::Test {
    std::size_t enter(const sockaddr_storage& from) {
        return room->enter(shm::UniqueFd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)), from, ++now);
    }
    std::size_t enter(std::uint32_t number) { return enter(host(number)); }
    void show_key(std::size_t seat) {
        static const auto context = TlsContext::server({make_key("lab", Role::control)});
        room->at(seat)->tls.emplace(context, room->at(seat)->socket.get());
    }
    /// Drops all callers, and returns their seats in the order in which they leave.
    std::vector<std::size_t> leave_all() {
        std::vector<std::size_t> order;
        while (!room->empty()) {
            order.push_back(room->gives_way());
            room->leave(order.back());
        }
        return order;
    }
    const std::unique_ptr<WaitingRoom> room = std::make_unique<WaitingRoom>();
    std::int64_t now = 0;
};

TEST_F(Waiting, TheHostWithTheMostGivesWayFirst) {
    const auto owner = enter(1), first = enter(2), second = enter(2), other = enter(3), third = enter(2);
    EXPECT_EQ(leave_all(), (std::vector{first, second, owner, other, third}));
}

TEST_F(Waiting, AmongThoseOfOneHostWhoShowedAKeyGivesWayLast) {
    const auto owner = enter(1), first = enter(2), second = enter(2);
    show_key(owner), show_key(first);
    EXPECT_EQ(leave_all(), (std::vector{second, owner, first}));
}

TEST_F(Waiting, AHostHasAllAddressesOfItsNetworkOfIpv6) {
    const auto owner = enter(host6("2001:db8:1::1")), first = enter(host6("2001:db8:2::1")),
               second = enter(host6("2001:db8:2:0:ffff::2"));
    EXPECT_EQ(leave_all(), (std::vector{first, owner, second}));
    const auto four = enter(host6("::ffff:10.0.0.1")), of_other = enter(host6("::ffff:10.0.0.2")),
               again = enter(host6("::ffff:10.0.0.2"));
    EXPECT_EQ(leave_all(), (std::vector{of_other, four, again})) << "addresses of IPv4 are each a host's";
}

TEST_F(Waiting, ThereAreSoManySeats) {
    for (std::uint32_t i = 0; i < WaitingRoom::seats; ++i) {
        EXPECT_FALSE(room->full());
        enter(i);
    }
    EXPECT_TRUE(room->full());
    EXPECT_EQ(room->gives_way(), 0u) << "the oldest";
}

TEST(FirstBytes, AreReadWhenTheHelloIsWholeOrCanBeNone) {
    const auto worth = [](std::vector<int> values, std::size_t size, bool tls) {
        std::vector<std::byte> bytes(std::max(size, values.size()));
        std::ranges::transform(values, bytes.begin(), [](int v) { return static_cast<std::byte>(v); });
        return is_worth_reading(std::span(bytes).first(size), tls);
    };
    for (const bool tls : {true, false}) EXPECT_FALSE(worth({}, 0, tls));
    const std::vector<int> hello{22, 3, 1, 1, 4};  // of 260 bytes
    for (const std::size_t size : {1, 4, 5, 264}) EXPECT_FALSE(worth(hello, size, true)) << size;
    EXPECT_TRUE(worth(hello, 265, true));
    EXPECT_TRUE(worth(hello, 300, true));
    EXPECT_TRUE(worth({22, 3, 1, 8, 0}, 5, true)) << "longer than any client's";
    EXPECT_TRUE(worth({'G'}, 1, true)) << "no TLS";
    for (const std::size_t size : {1, 2}) EXPECT_FALSE(worth(hello, size, false));
    EXPECT_TRUE(worth(hello, 3, false)) << "a client with a key";
    const std::vector<int> frame{100, 0, 0, 0, 1, 0, 0, 0};
    for (const std::size_t size : {3, 7, 8, 107}) EXPECT_FALSE(worth(frame, size, false)) << size;
    EXPECT_TRUE(worth(frame, 108, false));
    EXPECT_TRUE(worth({1, 0, 1, 0, 1, 0, 0, 0}, 8, false)) << "longer than a greeting";
}

}  // namespace
}  // namespace knurl::bridge::test
