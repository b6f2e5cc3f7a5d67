// A bridge without work does nothing; its keys can change while it runs.

#include <csignal>
#include <cstdio>
#include <fstream>

#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

/// How often the bridge's only thread fell asleep, and its time on a CPU (ns), by the kernel's own counts.
struct Life {
    std::uint64_t sleeps = 0, ran_ns = 0;
};
Life life_of(pid_t process) {
    const std::string folder = "/proc/" + std::to_string(process);
    Life life;
    std::ifstream(folder + "/schedstat") >> life.ran_ns;
    std::ifstream status(folder + "/status");
    for (std::string word; status >> word;)
        if (word == "voluntary_ctxt_switches:") status >> life.sleeps;
    return life;
}

TEST(Idle, after_the_last_stream_is_released_no_report_wakes_the_bridge) {
    ServoProcess servo;
    BridgeProcess bridge;
    Client client = connect_to(bridge), local = Client::connect("knurl:default", {.wait = 10s});
    Observer here = local.observe();
    const auto cycles = [&](int count) {
        for (int i = 0; i < count; ++i) ASSERT_TRUE(here.next_report(10s));
    };
    {
        Observer observer = client.observe();
        for (int i = 0; i < 50; ++i) ASSERT_TRUE(observer.next_report(10s));
    }
    cycles(100);  // the release has come through
    const Life before = life_of(bridge.pid());
    ASSERT_GT(before.sleeps, 0u);
    ASSERT_GT(before.ran_ns, 0u);
    cycles(1000);
    const Life after = life_of(bridge.pid());
    EXPECT_LT(after.sleeps - before.sleeps, 500u) << "10 ticks and 10 words of the clock a second, not 1000";
    EXPECT_LT(after.ran_ns - before.ran_ns, 200'000'000u) << "a loop that waits for nothing runs all of it";
}

TEST(Keys, that_are_taken_out_of_the_file_end_the_session_on_sighup) {
    ServoProcess servo;
    KeyRing ring;
    const std::string anna = ring.add("anna", Role::control), bert = ring.add("bert", Role::observe);
    BridgeProcess bridge({"--keys", ring.file()});
    Client stays = connect_to(bridge, bert), goes = connect_to(bridge, anna);
    Observer staying = stays.observe();
    Claim going = goes.claim();
    ASSERT_TRUE(going.next_report(10s));
    ASSERT_NE(bridge.line_with("anna@"), "");

    std::vector<Key> keys = read_keys(ring.file());
    std::filesystem::remove(ring.file());
    add_key(ring.file(), *find_key(keys, "bert"));
    ::kill(bridge.pid(), SIGHUP);
    const std::string said = bridge.line();
    EXPECT_NE(said.find("anna@"), std::string::npos) << said;
    says(said, "its key is not in the file any more");
    says(bridge.line(), "read again");
    ASSERT_TRUE(eventually([&] { return !going.connected(); }));
    // The reason comes with the bridge's goodbye or, if the client has called again, with the refusal.
    says(refusal([&] { going.arm(); }).what(), "key");
    EXPECT_EQ(refused_by(bridge, anna).kind, Error::Kind::permission);
    EXPECT_TRUE(staying.next_report(10s)) << "the others notice nothing";
    EXPECT_EQ(staying.reattachments(), 0u);

    std::ofstream(ring.file()) << "nonsense\n";
    ::kill(bridge.pid(), SIGHUP);
    ASSERT_NE(bridge.line_with("the keys stay as they were"), "");
    EXPECT_TRUE(Client::connect(bridge.address(), {.wait = 10s, .key_file = bert}).connected());
}

TEST(Keys, are_not_what_sighup_means_to_a_bridge_without_any) {
    BridgeProcess bridge;
    ::kill(bridge.pid(), SIGHUP);  // its terminal was closed
    EXPECT_EQ(bridge.status(), 0);
}

TEST(Keys, may_be_read_again_at_any_moment_of_a_stream) {
    ServoProcess servo;
    KeyRing ring;
    const std::string anna = ring.add("anna", Role::observe);
    BridgeProcess bridge({"--keys", ring.file()});
    Client client = connect_to(bridge, anna);
    Observer observer = client.observe();
    for (int i = 0; i < 400; ++i) {  // some of them come just before a report of the servo's
        ::kill(bridge.pid(), SIGHUP);
        while (bridge.line().find("read again") == std::string::npos) {
        }
    }
    observer.latest();
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(observer.next_report(5s)) << "the stream has stopped";
}

}  // namespace
}  // namespace knurl::bridge::test
