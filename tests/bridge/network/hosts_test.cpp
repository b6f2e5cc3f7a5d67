// The servo on one host, the application on another: two network namespaces, keys, an encrypted path.

#include <algorithm>
#include <atomic>
#include <cstring>
#include <optional>
#include <vector>

#include "setting.hpp"
#include "two_hosts.hpp"
#include "wire.hpp"

namespace knurl::bridge::test {
namespace {

using Host = TwoHosts::Host;

/// A servo and its bridge on one host; nothing is started if there is only one host.
struct Apart {
    Apart(int server_mtu, int client_mtu) : hosts(server_mtu, client_mtu) {
        if (!hosts.two()) return;
        key = ring.add("workstation", Role::control);
        servo.emplace();
        const TwoHosts::On on(hosts, Host::server);
        bridge.emplace(std::vector<std::string>{"--keys", ring.file()}, hosts.address(Host::server) + ":0");
    }

    TwoHosts hosts;
    KeyRing ring;
    std::string key;  // its owner's file
    std::optional<ServoProcess> servo;
    std::optional<BridgeProcess> bridge;
};

template <int server_mtu, int client_mtu = server_mtu>
struct With : testing::Test, Apart {
    With() : Apart(server_mtu, client_mtu) {}
    void SetUp() override {
        if (!hosts.two()) GTEST_SKIP() << hosts.why();
    }
};
using TwoHostsApart = With<1400>;
using TwoHostsWithANarrowWire = With<1000>;    // carries less than a full datagram
using TwoHostsWithAWireTooNarrow = With<780>;  // carries less than the smallest maximum
using TwoHostsNarrowToTheClient = With<1500, 1000>;
using TwoHostsNarrowToTheServer = With<1000, 1500>;

/// Batches and feedback in one datagram, in several, and in sizes that need a wider path.
void expect_batches_and_what_is_felt(Client& client, bool none_lost = true) {
    for (const std::uint32_t count : {1u, 6u, 20u, 30u}) {
        Claim hand = client.claim("", {.shared = true, .representations = count});
        std::vector<Handle<ConstantForce>> forces;
        for (std::uint32_t i = 0; i < count; ++i) forces.push_back(hand.add(at_once({})));
        hand.arm();
        for (int round = 1; round <= 5; ++round) {
            const double share = 0.02 * round / count;
            for (auto& force : forces) force.set(at_once({share, 0, 0}));
            ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s)) << count << " representations";
            read_until(hand, [&](const HandReport&) {
                return std::ranges::all_of(forces, [&](const Handle<ConstantForce>& force) {
                    const auto felt = force.feedback();
                    return felt && felt->force.x == share;
                });
            });
        }
        if (none_lost) {
            EXPECT_EQ(hand.network().lost, 0u) << "reports, over a wire that loses none, of " << count;
        }
    }
}

TEST_F(TwoHostsApart, AnApplicationArmsAndFeels) {
    const TwoHosts::On on(hosts, Host::client);
    Client client = connect_to(*bridge, key);
    Claim hand = client.claim();
    auto force = hand.add(ConstantForce{.force = {0.1, 0, 0}});
    hand.arm();
    bool felt = false;
    for (int i = 0; i < 20'000 && !felt; ++i) {
        const auto report = hand.next_report(1s);
        ASSERT_TRUE(report);
        if (i % 20 == 0) hand.commit();
        felt = report->state == DeviceState::active && report->sent_force.x == 0.1;
    }
    EXPECT_TRUE(felt);
    EXPECT_TRUE(hand.network().encrypted);
    force.set({.force = {0.2, 0, 0}});
    EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s));
}

TEST_F(TwoHostsApart, AStrangerIsToldToHaveAKey) {
    const TwoHosts::On on(hosts, Host::client);
    says(refused_by(*bridge).what(), "KNURL_KEY");
    EXPECT_EQ(refused_by(*bridge, ring.stranger("workstation", Role::control)).kind, Error::Kind::permission);
}

TEST_F(TwoHostsWithANarrowWire, ABatchOfAnySizeArrivesWholeAndSoDoesWhatIsFelt) {
    const TwoHosts::On on(hosts, Host::client);
    Client client = connect_to(*bridge, key);
    expect_batches_and_what_is_felt(client);
}

TEST_F(TwoHostsNarrowToTheClient, NothingThatIsSentVanishes) {
    const TwoHosts::On on(hosts, Host::client);
    Client client = connect_to(*bridge, key);
    expect_batches_and_what_is_felt(client);
}

TEST_F(TwoHostsNarrowToTheServer, NothingThatIsSentVanishes) {
    const TwoHosts::On on(hosts, Host::client);
    Client client = connect_to(*bridge, key);
    expect_batches_and_what_is_felt(client);
}

/// The path was wide at connection time: from now on one end of the wire silently drops long datagrams.
void expect_all_to_come_again_when(TwoHosts& hosts, Host narrow, const BridgeProcess& bridge,
                                   const std::string& key) {
    const TwoHosts::On on(hosts, Host::client);
    Client client = connect_to(bridge, key);
    expect_batches_and_what_is_felt(client);
    ASSERT_TRUE(hosts.narrow(narrow, 1000)) << hosts.why();
    constexpr bool none_lost = false;  // some are lost until the ends notice
    expect_batches_and_what_is_felt(client, none_lost);
}
TEST_F(TwoHostsApart, NothingVanishesForGoodWhenThePathToTheClientBecomesNarrow) {
    expect_all_to_come_again_when(hosts, Host::client, *bridge, key);
}
TEST_F(TwoHostsApart, NothingVanishesForGoodWhenThePathToTheServerBecomesNarrow) {
    expect_all_to_come_again_when(hosts, Host::server, *bridge, key);
}

/// Without a key a bridge listens only at its own host. A tunnel that brings datagrams from another host ends
/// on this host as well.
void expect_nothing_vanishes_without_a_key(const TwoHosts& hosts) {
    std::optional<BridgeProcess> keyless;
    std::optional<Proxy> tunnel;
    {
        const TwoHosts::On on(hosts, Host::server);
        keyless.emplace();
        Proxy::Options options;
        options.listen = hosts.address(Host::server);
        options.to_port = keyless->port();
        tunnel.emplace(options);
    }
    const TwoHosts::On on(hosts, Host::client);
    Client client = Client::connect(
        "knurl://" + hosts.address(Host::server) + ":" + std::to_string(tunnel->port()), {.wait = 10s});
    expect_batches_and_what_is_felt(client);
}
TEST_F(TwoHostsNarrowToTheClient, NothingThatIsSentVanishesWithoutAKeyEither) {
    expect_nothing_vanishes_without_a_key(hosts);
}
TEST_F(TwoHostsNarrowToTheServer, NothingThatIsSentVanishesWithoutAKeyEither) {
    expect_nothing_vanishes_without_a_key(hosts);
}

/// Shows that long datagrams are used at all; no other test would notice that only short ones are sent.
TEST(AWideWire, CarriesLongDatagramsBothWays) {
    std::atomic<std::size_t> longest[2]{};  // bytes, of batches and of reports
    Setting setting({}, 1, Keyed::yes, [&](proxy::Way way, Proxy::At, std::span<const char> datagram) {
        DatagramHeader header;
        if (datagram.size() < sizeof header) return;
        std::memcpy(&header, datagram.data(), sizeof header);
        if (header.kind != DatagramKind::batch && header.kind != DatagramKind::report) return;
        auto& most = longest[static_cast<std::size_t>(way)];
        most = std::max<std::size_t>(most, datagram.size());
    });
    Client client = setting.remote();
    Claim hand = client.claim("", {.representations = 30});
    std::vector<Handle<ConstantForce>> forces;
    for (int i = 0; i < 30; ++i) forces.push_back(hand.add(at_once({})));
    setting.pass_until([&] { return longest[0] > 1100 && longest[1] > 1100; },
                       [&] {
                           for (auto& force : forces) force.set(at_once({1e-3, 0, 0}));
                           hand.commit();
                       });
}

TEST_F(TwoHostsWithAWireTooNarrow, AnApplicationIsToldSoAtOnce) {
    Client::connect("knurl:default", {.wait = 20s});  // the servo has come up
    const TwoHosts::On on(hosts, Host::client);
    says(refused_by(*bridge, key).what(), "raise the MTU of the narrowest link (a tunnel?) to 788 or more");
}

}  // namespace
}  // namespace knurl::bridge::test
