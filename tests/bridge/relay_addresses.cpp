// A name with several addresses, like `localhost` on many hosts, of which a bridge listens at one.

#include <fstream>
#include <set>
#include <utility>

#include <sys/resource.h>
#include <sys/socket.h>

#include <knurl/bridge/remote.hpp>
#include <knurl/shm/fd.hpp>

#include "relay.hpp"
#include "relay_stranger.hpp"

namespace knurl::bridge::test {
namespace {

/// As if a name with these addresses had been looked up.
std::vector<Endpoint> addresses(std::initializer_list<std::string> all) {
    std::vector<Endpoint> result;
    for (const std::string& each : all) result.push_back(resolve(each));
    return result;
}

std::string at(const char* host, std::uint16_t port) {
    return std::string(host) + ":" + std::to_string(port);
}

TEST(Addresses, of_a_name_are_tried_in_turn) {
    const ServoUp servo;
    const BridgeProcess bridge;
    const auto all =
        addresses({at("127.0.0.7", bridge.port()), at("[::1]", bridge.port()), bridge.host_and_port()});
    EXPECT_EQ(connect_remote(all, {.client_name = "test"})->servo_pid(), servo.pid());
}

TEST(Addresses, of_which_none_has_a_bridge_are_counted_and_what_is_wrong_is_said_once) {
    const Error error = refusal([] { connect_remote(addresses({"127.0.0.1:1", "127.0.0.7:1"}), {}); });
    EXPECT_EQ(error.kind, Error::Kind::no_servo);
    says(error.what(), "(tried 2 addresses: 127.0.0.1:1, 127.0.0.7:1)");
    says(error.what(), "no bridge listens at 127.0.0.1:1");
}

TEST(Addresses, behind_one_of_which_a_bridge_has_no_servo_say_that_too) {
    ServoProcess servo;
    servo.end(SIGKILL);
    const BridgeProcess bridge;
    const Error error = refusal([&] {
        connect_remote(addresses({"127.0.0.1:1", bridge.host_and_port()}), {.client_name = "test"});
    });
    EXPECT_EQ(error.kind, Error::Kind::no_servo);
    says(error.what(), "no bridge listens at 127.0.0.1:1");
    says(error.what(), "the bridge is there, but no servo");
}

TEST(Addresses, of_a_name_are_each_there_once) {
    std::set<std::string> different;
    const std::vector<Endpoint> all = resolve_all("localhost:5000");
    for (const Endpoint& each : all) {
        EXPECT_TRUE(each.loopback());
        EXPECT_EQ(each.text, "localhost:5000");
        different.insert(numeric(each.address));
    }
    EXPECT_EQ(different.size(), all.size());
    EXPECT_GE(all.size(), 1u);
}

TEST(Addresses, to_listen_at_are_tried_too_and_the_first_that_is_free_is_taken) {
    const BridgeProcess first;
    const Relay second(
        {.servo = "default", .listen = addresses({first.host_and_port(), at("127.0.0.7", first.port())})});
    EXPECT_EQ(second.listening_at(), at("127.0.0.7", first.port()));
    try {
        const Relay third(
            {.servo = "default", .listen = addresses({first.host_and_port(), second.listening_at()})});
        ADD_FAILURE() << "both are taken";
    } catch (const std::runtime_error& error) {
        says(error.what(), "another program has this port");
        says(error.what(), "(tried 2 addresses)");
    }
}

/// Occupies every second UDP port that the kernel may choose at this host. `all`: false if this user may not
/// have that many descriptors.
std::vector<shm::UniqueFd> half_of_the_ports_for_datagrams(const char* host, bool& all) {
    rlimit descriptors{};
    ::getrlimit(RLIMIT_NOFILE, &descriptors);
    descriptors.rlim_cur = descriptors.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &descriptors);
    int first = 0, last = 0;
    std::ifstream("/proc/sys/net/ipv4/ip_local_port_range") >> first >> last;
    std::vector<shm::UniqueFd> taken;
    all = first > 0;
    for (int port = first; all && port <= last; ++port) {
        if (port / 2 % 2 == 0) continue;  // half of the even and of the odd ports: bind() prefers one kind
        shm::UniqueFd one(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        const Endpoint there = resolve(at(host, static_cast<std::uint16_t>(port)));
        all = one && (::bind(one.get(), there.get(), there.length) == 0 || errno == EADDRINUSE);
        taken.push_back(std::move(one));
    }
    return taken;
}

TEST(Addresses, without_a_port_get_one_that_is_free_for_callers_and_for_datagrams) {
    bool all = false;
    const auto taken = half_of_the_ports_for_datagrams("127.0.0.99", all);
    if (!all) GTEST_SKIP() << "this user may have too few descriptors (RLIMIT_NOFILE)";
    for (int bridge = 0; bridge < 12; ++bridge)
        EXPECT_NO_THROW(Relay({.servo = "default", .listen = addresses({"127.0.0.99:0"})}));
}

TEST(Addresses, of_a_host_that_has_several_all_answer_whoever_asked_there) {
    const ServoUp servo;
    KeyRing ring;
    const std::string key = ring.add("carl", Role::control);
    const auto expect_answers = [&](const BridgeProcess& bridge, const char* host) {
        // The clock's datagrams, then a claim's: a socket connected to `host` accepts none from others.
        Client client = Client::connect("knurl://" + at(host, bridge.port()),
                                        {.name = "test", .wait = 10s, .key_file = key});
        Claim hand = client.claim("", {.shared = true});
        auto force = hand.add(at_once({}));
        ASSERT_TRUE(hand.next_report(10s)) << host;
        force.set(at_once({1e-3, 0, 0}));
        EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s)) << host;
    };
    const BridgeProcess everywhere({"--keys", ring.file()}, "0.0.0.0:0");
    for (const char* host : {"127.0.0.1", "127.0.0.2", "127.7.7.7"}) expect_answers(everywhere, host);
    const BridgeProcess of_both({"--keys", ring.file()}, "[::]:0");
    if (of_both.address().empty()) GTEST_SKIP() << "no IPv6 here; IPv4 has passed";
    for (const char* host : {"[::1]", "127.0.0.1", "127.0.0.2"}) expect_answers(of_both, host);
}

}  // namespace
}  // namespace knurl::bridge::test
