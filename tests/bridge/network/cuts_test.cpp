// The cable is unplugged, the bridge dies, or the servo dies: the force fades gently, and does not return by
// itself where it must not.

#include "setting.hpp"

namespace knurl::bridge::test {
namespace {

constexpr double held = 0.4;  // N

/// Silence fades out in 100 ms and in again in 50 ms, a claim that ends fades out in 50 ms.
void expect_gentle(const std::vector<Cycle>& trace) {
    expect_no_bumps(trace, 1.2 * held / 0.05);
    for (const Cycle& cycle : trace) ASSERT_LE(cycle.sent, held + 1e-9) << "cycle " << cycle.number;
}

struct Cuts : testing::Test {
    Cuts() : client(setting.remote()), hand(client.claim("", {.update_interval = 20ms})) {
        hand.add(ConstantForce{.force = {held, 0, 0}});
        hand.arm();
        setting.pass_until([&] { return setting.state == DeviceState::active && setting.felt() == held; },
                           [&] { hand.commit(); });
        setting.trace.clear();
    }
    /// The application continues as if nothing had happened.
    void commit() {
        try {
            hand.commit();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind, Error::Kind::disconnected) << error.what();
        }
    }

    Setting setting{{.delay = 0.002}};
    Client client;
    Claim hand;
};

TEST_F(Cuts, ACutFadesWithinTheSilenceAllowedAndComesBackAsGently) {
    setting.proxy.cut();
    setting.pass(1000, 20, [&] { commit(); });
    std::uint64_t zero = 0;
    for (std::size_t i = setting.trace.size(); i > 0 && setting.trace[i - 1].scene == 0; --i) zero = i;
    ASSERT_GT(zero, 0u) << "still " << setting.felt() << " N after a second";
    // 250 ms of silence, 200 ms allowed for a network, 100 ms of fading, and what was under way.
    EXPECT_LE(zero, 250u + 200u + 100u + 30u);
    EXPECT_GE(zero, 200u) << "not at the first datagram that is late";
    setting.proxy.heal();  // well before the connection counts as dead
    setting.pass_until([&] { return setting.felt() == held; }, [&] { commit(); });
    expect_gentle(setting.trace);
    EXPECT_EQ(hand.reattachments(), 0u) << "the same claim: it was away for a second only";
}

TEST_F(Cuts, ALongCutEndsTheClaimAndForceStaysOffUntilArmedAgain) {
    setting.proxy.cut();
    setting.pass_until([&] { return setting.state == DeviceState::idle; }, [&] { commit(); });
    expect_gentle(setting.trace);
    setting.proxy.heal();
    setting.pass_until([&] { return hand.reattachments() == 1 && hand.connected(); }, [&] { commit(); });
    setting.trace.clear();
    setting.pass(500, 20, [&] { commit(); });
    for (const Cycle& cycle : setting.trace) ASSERT_EQ(cycle.sent, 0) << "nobody has armed it";
    hand.arm();
    setting.pass_until([&] { return setting.state == DeviceState::active && setting.felt() == held; },
                       [&] { commit(); });
}

TEST_F(Cuts, AResetConnectionIsTakenUpAgain) {
    setting.proxy.hang_up();
    setting.pass_until([&] { return hand.reattachments() == 1 && hand.connected(); }, [&] { commit(); });
    expect_gentle(setting.trace);
    hand.arm();
    setting.pass_until([&] { return setting.state == DeviceState::active && setting.felt() == held; },
                       [&] { commit(); });
}

TEST_F(Cuts, AKilledBridgeLetsTheHandGo) {
    ::kill(setting.bridge.pid(), SIGKILL);
    setting.pass(500, 20, [&] { commit(); });
    EXPECT_EQ(setting.felt(), 0);
    expect_gentle(setting.trace);
    EXPECT_FALSE(hand.connected());
    try {
        hand.arm();
        ADD_FAILURE() << "armed without a bridge";
    } catch (const Error& error) {
        const std::string said = error.what();
        EXPECT_NE(said.find("bridge 127.0.0.1:"), std::string::npos) << said;
        EXPECT_NE(said.find("start it again there"), std::string::npos) << said;
    }
}

TEST_F(Cuts, WhatIsToHoldHoldsAndWhatFadesFades) {
    constexpr double kept = 0.2;  // N
    hand.add(ConstantForce{.force = {kept, 0, 0}}, {.on_silence = OnSilence::hold});
    setting.pass_until([&] { return setting.felt() == held + kept; }, [&] { commit(); });
    setting.trace.clear();
    setting.proxy.cut();
    setting.pass(1000, 20, [&] { commit(); });
    EXPECT_EQ(setting.felt(), kept);
    expect_no_bumps(setting.trace, 1.2 * held / 0.05);
}

TEST_F(Cuts, WhatIsToMoveMovesOnForItsTimeAndThenFades) {
    constexpr double stiffness = 200, speed = 0.005;  // N/m, m/s: 1 N/s into the hand
    hand.add(Plane{.normal = {1, 0, 0},
                   .offset = setting.position.x,
                   .velocity = {speed, 0, 0},
                   .stiffness = stiffness},
             {.on_silence = OnSilence::move, .silence_time = 0.3});
    commit();
    setting.pass_until([&] { return setting.felt() > held + 0.01; }, [&] { commit(); });
    setting.trace.clear();
    setting.proxy.cut();
    setting.pass(1500, 20, [&] { commit(); });
    // The constant force is silent from 450 ms on and gone at 550; the plane moves on until 750.
    ASSERT_GT(setting.trace.size(), 1000u);
    EXPECT_GT(setting.trace[650].scene, 0.1) << "it has moved on while nobody was heard";
    EXPECT_EQ(setting.felt(), 0) << "but not for ever";
    expect_no_bumps(setting.trace, 1.2 * (held + 1) / 0.05);
}

TEST_F(Cuts, AStoppedBridgeIsSilence) {
    setting.bridge.stop();
    setting.pass(1000, 20, [&] { commit(); });
    EXPECT_EQ(setting.felt(), 0);
    expect_gentle(setting.trace);
    setting.bridge.go_on();
}

}  // namespace
}  // namespace knurl::bridge::test
