// How often callers of one host are heard.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

#include "caller_rate.hpp"

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
    /// How many of so many calls from that host are heard, from `now` on, at that interval.
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

}  // namespace
}  // namespace knurl::bridge::test
