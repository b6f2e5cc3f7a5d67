// Who may come in, and what each may do.

#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

TEST(Keys, let_in_and_hide_what_is_said) {
    ServoProcess servo;
    KeyRing ring;
    const std::string key = ring.add("anna", Role::control);
    BridgeProcess bridge({"--keys", ring.file()});
    Client client = connect_to(bridge, key);
    Claim hand = client.claim();
    auto force = hand.add(at_once({0.25, 0, 0}));
    hand.arm();
    read_until(hand,
               [](const HandReport& report) { return is_active(report) && report.scene_force.x == 0.25; });
    force.set(at_once({0.5, 0, 0}));
    ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
    EXPECT_TRUE(hand.network().encrypted);
    ::setenv("KNURL_KEY", key.c_str(), 1);
    EXPECT_TRUE(connect_to(bridge).connected()) << "the key may be named by KNURL_KEY too";
    ::unsetenv("KNURL_KEY");
}

TEST(Keys, that_are_wrong_or_missing_are_answered_with_a_line_that_says_so) {
    ServoProcess servo;
    KeyRing ring;
    ring.add("anna", Role::control);
    BridgeProcess bridge({"--keys", ring.file()}), open;
    Client::connect(open.address(), {.wait = 10s});  // the servo is up

    const Error none = refused_by(bridge);
    EXPECT_EQ(none.kind, Error::Kind::permission) << none.what();
    says(none.what(), "KNURL_KEY");
    const Error wrong = refused_by(bridge, ring.stranger("anna", Role::control));
    EXPECT_EQ(wrong.kind, Error::Kind::permission) << wrong.what();
    says(wrong.what(), "key");
    const Error unknown = refused_by(bridge, ring.stranger("bert", Role::control));
    EXPECT_EQ(unknown.kind, Error::Kind::permission) << unknown.what();
    const Error missing = refused_by(bridge, "/no/such/file");
    EXPECT_EQ(missing.kind, Error::Kind::permission);
    says(missing.what(), "/no/such/file");
    const Error several = [&] {
        ring.add("carl", Role::observe);
        return refused_by(bridge, ring.file());
    }();
    says(several.what(), "an application uses one");
    const Error needless = refused_by(open, ring.stranger("dora", Role::control));
    EXPECT_EQ(needless.kind, Error::Kind::permission) << needless.what();
}

TEST(Roles, observe_reads_and_claims_nothing) {
    ServoProcess servo;
    KeyRing ring;
    const std::string key = ring.add("anna", Role::observe);
    BridgeProcess bridge({"--keys", ring.file()});
    Client client = connect_to(bridge, key);
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
    ServoProcess servo;
    KeyRing ring;
    const std::string render = ring.add("anna", Role::render), control = ring.add("bert", Role::control);
    BridgeProcess bridge({"--keys", ring.file()});
    Client client = connect_to(bridge, render), master = connect_to(bridge, control);
    const Error alone = refusal([&] { client.claim(); });
    EXPECT_EQ(alone.kind, Error::Kind::permission);
    says(alone.what(), "ClaimOptions::shared");

    Claim mine = client.claim("", {.shared = true});
    mine.add(at_once({0.25, 0, 0}));
    says(refusal([&] { mine.arm(); }).what(), "role control");
    says(refusal([&] { mine.reset_fault(); }).what(), "role control");
    std::optional<Representing<ConstantForce>> left_out;
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
    mine.disarm();
}

}  // namespace
}  // namespace knurl::bridge::test
