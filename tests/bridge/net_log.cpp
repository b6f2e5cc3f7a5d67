// The bridge's log: it has every connection, but only one line a minute for a peer that is refused
// repeatedly.

#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>

#include "log.hpp"

namespace knurl::bridge::test::net_log_tests {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t second = 1'000'000'000, minute = 60 * second;

sockaddr_storage host(std::uint32_t number, std::uint16_t port = 1) {
    sockaddr_storage storage{};
    auto& address = reinterpret_cast<sockaddr_in&>(storage);
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl((10u << 24) + number);
    address.sin_port = htons(port);
    return storage;
}

struct BridgeLog : testing::Test {
    std::vector<std::string> lines;
    bool reads = true;
    Log log{[this](const std::string& line) {
        if (reads) lines.push_back(line);
        return reads;
    }};

    void refuse(std::int64_t at_ns, const std::string& why = "no servo", std::uint32_t from = 1) {
        log.refused(host(from), "x", why, at_ns);
    }
};

TEST_F(BridgeLog, says_the_same_of_the_same_host_once_a_minute_with_how_often_it_was) {
    for (std::int64_t at = 0; at < minute; at += second / 50) refuse(at);
    EXPECT_THAT(lines, ElementsAre("x: not let in: no servo"));
    refuse(minute);
    EXPECT_THAT(lines.back(), HasSubstr("(2999 times more"));
    refuse(minute + 1);
    EXPECT_EQ(lines.size(), 2u);
    refuse(2 * minute + 1);
    EXPECT_THAT(lines.back(), HasSubstr("(1 times more"));
    refuse(2 * minute + 2, "no servo", 2);
    EXPECT_EQ(lines.back(), "x: not let in: no servo") << "another host";
}

TEST_F(BridgeLog, says_how_often_it_was_when_something_else_is_so) {
    for (int i = 0; i < 5; ++i) refuse(i);
    refuse(10, "wrong key");
    EXPECT_THAT(lines, ElementsAre("x: not let in: no servo",
                                   HasSubstr("not let in, 4 times more until now: no servo"),
                                   "x: not let in: wrong key"));
    lines.clear();
    for (int i = 0; i < 3; ++i) refuse(20, i % 2 == 0 ? "no servo" : "wrong key");  // by turns
    EXPECT_TRUE(lines.empty());
    log.admitted(host(1, 99), "x: in", 30);
    EXPECT_THAT(lines, ElementsAre(HasSubstr("2 times more until now: no servo"),
                                   HasSubstr("1 times more until now: wrong key"), "x: in"));
    log.admitted(host(1), "x: in", 31);
    EXPECT_EQ(lines.size(), 4u) << "and once";
}

TEST_F(BridgeLog, of_a_crowd_that_is_turned_away_takes_nothing_from_who_is_in) {
    for (std::uint32_t i = 0; i < 1000; ++i) refuse(1, "no servo", 1 + i);
    EXPECT_EQ(lines.size(), 20u);
    log.admitted(host(5000), "anna: in", 2);
    EXPECT_EQ(lines.back(), "anna: in");
    EXPECT_THAT(lines[20], HasSubstr("(980 lines were left out)"));
    log.event("anna: out", 3);
    EXPECT_EQ(lines.back(), "anna: out");
    for (int i = 0; i < 1000; ++i) log.event("in or out", 4);
    EXPECT_EQ(lines.size(), 41u) << "which has a bound of its own: 20 in a second, and what was left out";
    refuse(second, "no servo", 9000);
    EXPECT_EQ(lines.back(), "x: not let in: no servo") << "the next second";
}

TEST_F(BridgeLog, that_nobody_reads_is_not_waited_for_and_says_later_how_much_is_missing) {
    reads = false;
    for (int i = 0; i < 7; ++i) log.event("in or out", 1);
    reads = true;
    log.event("in", 2);
    EXPECT_THAT(lines, ElementsAre("(7 lines were left out)", "in"));
}

}  // namespace
}  // namespace knurl::bridge::test::net_log_tests
