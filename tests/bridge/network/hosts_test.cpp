// The servo on one host, the application on another: two network namespaces, keys, an encrypted way.

#include <optional>

#include "setting.hpp"
#include "two_hosts.hpp"

namespace knurl::bridge::test {
namespace {

using Host = TwoHosts::Host;

struct TwoHostsApart : testing::Test {
    void SetUp() override {
        if (!hosts.two())
            GTEST_SKIP() << "one host only (" << hosts.why() << "): the other tests go over loopback";
        key = ring.add("workstation", Role::control);
        servo.emplace();
        const TwoHosts::On on(hosts, Host::server);
        bridge.emplace(std::vector<std::string>{"--keys", ring.file()}, hosts.address(Host::server) + ":0");
    }

    TwoHosts hosts{1400};
    KeyRing ring;
    std::string key;  // its owner's file
    std::optional<ServoProcess> servo;
    std::optional<BridgeProcess> bridge;
};

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

}  // namespace
}  // namespace knurl::bridge::test
