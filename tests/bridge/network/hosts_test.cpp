// The servo on one host, the application on another: two network namespaces, keys, an encrypted way.

#include <algorithm>
#include <optional>
#include <vector>

#include "setting.hpp"
#include "two_hosts.hpp"

namespace knurl::bridge::test {
namespace {

using Host = TwoHosts::Host;

/// A servo and its bridge on the one; nothing is started where there is one host only.
struct Apart {
    explicit Apart(int mtu) : hosts(mtu) {
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

template <int mtu>
struct With : testing::Test, Apart {
    With() : Apart(mtu) {}
    void SetUp() override {
        if (!hosts.two())
            GTEST_SKIP() << "one host only (" << hosts.why() << "): the other tests go over loopback";
    }
};
using TwoHostsApart = With<1400>;
using TwoHostsWithANarrowWire = With<1000>;    // which takes less than a datagram of ours
using TwoHostsWithAWireTooNarrow = With<780>;  // not even the least

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
    for (const std::uint32_t count : {1u, 20u, 30u}) {
        Claim hand = client.claim("", {.shared = true, .representations = count});
        std::vector<Representing<ConstantForce>> forces;
        for (std::uint32_t i = 0; i < count; ++i) forces.push_back(hand.add(at_once({})));
        hand.arm();
        const double share = 0.1 / count;
        for (auto& force : forces) force.set(at_once({share, 0, 0}));
        ASSERT_TRUE(hand.wait_applied(hand.commit(), 20s)) << count;
        read_until(hand, [&](const HandReport&) {
            return std::ranges::all_of(forces, [&](const Representing<ConstantForce>& force) {
                const auto felt = force.felt();
                return felt && felt->force.x == share;
            });
        });
    }
}

TEST_F(TwoHostsWithAWireTooNarrow, AnApplicationIsToldSoAtOnce) {
    Client::connect("knurl:default", {.wait = 20s});  // the servo has come up
    const TwoHosts::On on(hosts, Host::client);
    says(refused_by(*bridge, key).what(), "raise the MTU of the narrowest link (a tunnel?) to 788 or more");
}

}  // namespace
}  // namespace knurl::bridge::test
