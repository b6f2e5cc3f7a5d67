// Which peers are admitted, and what each role may do.

#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

/// A servo, and in front of it a bridge that requires keys, with one key of each role.
struct Locked {
    ServoProcess servo;
    KeyRing ring;
    const std::string observe = ring.add("olga", Role::observe), render = ring.add("rita", Role::render),
                      control = ring.add("carl", Role::control);
    BridgeProcess bridge{{"--keys", ring.file()}};
};

TEST(Keys, let_in_and_hide_what_is_said) {
    Locked locked;
    Client client = connect_to(locked.bridge, locked.control);
    Claim hand = client.claim();
    auto force = hand.add(at_once({0.25, 0, 0}));
    hand.arm();
    read_until(hand,
               [](const HandReport& report) { return is_active(report) && report.scene_force.x == 0.25; });
    force.set(at_once({0.5, 0, 0}));
    ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
    EXPECT_TRUE(hand.network().encrypted);
    ::setenv("KNURL_KEY", locked.control.c_str(), 1);
    EXPECT_TRUE(connect_to(locked.bridge).connected()) << "the key may be named by KNURL_KEY too";
    ::unsetenv("KNURL_KEY");
}

TEST(Keys, that_are_wrong_or_missing_are_answered_with_a_line_that_says_so) {
    Locked locked;
    KeyRing& ring = locked.ring;
    const BridgeProcess &bridge = locked.bridge, open;
    Client::connect(open.address(), {.wait = 10s});  // the servo is up

    const Error none = refused_by(bridge);
    EXPECT_EQ(none.kind, Error::Kind::permission) << none.what();
    says(none.what(), "KNURL_KEY");
    const Error wrong = refused_by(bridge, ring.stranger("carl", Role::control));
    EXPECT_EQ(wrong.kind, Error::Kind::permission) << wrong.what();
    says(wrong.what(), "key");
    const Error unknown = refused_by(bridge, ring.stranger("bert", Role::control));
    EXPECT_EQ(unknown.kind, Error::Kind::permission) << unknown.what();
    const Error missing = refused_by(bridge, "/no/such/file");
    EXPECT_EQ(missing.kind, Error::Kind::permission);
    says(missing.what(), "/no/such/file");
    says(missing.what(), "ask whoever runs the bridge for your line");
    EXPECT_EQ(std::string(missing.what()).find("keygen"), std::string::npos)
        << "a key that was made here no bridge knows";
    const Error several = refused_by(bridge, ring.file());
    says(several.what(), "an application uses one");
    const Error needless = refused_by(open, ring.stranger("dora", Role::control));
    EXPECT_EQ(needless.kind, Error::Kind::permission) << needless.what();
}

TEST(Keys, one_leaves_the_others_as_many_sessions_as_it_takes) {
    Locked locked;
    std::vector<Client> olgas;
    const Error error = refusal([&] {
        for (;;)
            olgas.push_back(
                Client::connect(locked.bridge.address(), {.wait = 0ms, .key_file = locked.observe}));
    });
    EXPECT_EQ(error.kind, Error::Kind::refused) << error.what();
    says(error.what(), "key 'olga' holds 64 sessions of the bridge and leaves 64 of 128");
    EXPECT_EQ(olgas.size(), 64u);
    Client carl = connect_to(locked.bridge, locked.control);
    EXPECT_TRUE(carl.claim().next_report(10s));
}

TEST(Keys, one_leaves_the_others_as_many_observers_of_a_device_as_it_has) {
    Locked locked;
    std::vector<Client> olgas;
    std::vector<Observer> observers;
    const Error error = refusal([&] {
        for (;;) {
            if (observers.size() % 16 == 0) olgas.push_back(connect_to(locked.bridge, locked.observe));
            observers.push_back(olgas.back().observe());
        }
    });
    says(error.what(), "key 'olga' observes this device 28 times and leaves 27 of the bridge's 55");
    Client rita = connect_to(locked.bridge, locked.render);
    EXPECT_TRUE(rita.observe().next_report(10s));
    Client carl = connect_to(locked.bridge, locked.control);
    EXPECT_TRUE(carl.claim().next_report(10s));
}

TEST(Roles, observe_reads_and_claims_nothing) {
    Locked locked;
    Client client = connect_to(locked.bridge, locked.observe);
    Observer observer = client.observe();
    EXPECT_TRUE(observer.next_report(10s));
    for (const bool shared : {false, true}) {
        const Error error = refusal([&] { client.claim("", {.shared = shared}); });
        EXPECT_EQ(error.kind, Error::Kind::permission);
        says(error.what(), "role render or control");
    }
    EXPECT_TRUE(observer.next_report(10s)) << "a refusal ends nothing";
}

TEST(Roles, render_joins_a_device_that_is_on_and_never_switches_it_on) {
    Locked locked;
    Client client = connect_to(locked.bridge, locked.render),
           master = connect_to(locked.bridge, locked.control);
    const Error alone = refusal([&] { client.claim(); });
    EXPECT_EQ(alone.kind, Error::Kind::permission);
    says(alone.what(), "ClaimOptions::shared");

    Claim mine = client.claim("", {.shared = true});
    mine.add(at_once({0.25, 0, 0}));
    says(refusal([&] { mine.arm(); }).what(), "role control");
    says(refusal([&] { mine.reset_fault(); }).what(), "role control");
    says(refusal([&] { master.reset_fault(); }).what(), "on the servo's own host");
    std::optional<Handle<ConstantForce>> left_out;
    EXPECT_THROW(mine.together([&] {
        left_out = mine.add(at_once({0, 0, 9}));
        mine.arm();
    }),
                 Error);
    EXPECT_THROW(left_out->set(at_once({})), Error) << "nothing of the group was done";

    Claim theirs = master.claim("", {.shared = true});
    theirs.add(at_once({0, 0.5, 0}));
    theirs.arm();
    read_until(theirs, is_active);
    mine.arm();
    read_until(mine, [&](const HandReport& report) {
        theirs.commit();
        return report.scene_force.x == 0.25 && report.scene_force.y == 0.5;
    });
    // ... nor does it keep it on.
    theirs.release();
    read_until(mine, [&](const HandReport& report) {
        mine.commit();
        return report.state == DeviceState::idle;
    });
    says(refusal([&] { mine.arm(); }).what(), "role control");
}

}  // namespace
}  // namespace knurl::bridge::test
