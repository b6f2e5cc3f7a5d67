// A bridge of which nobody wants anything does nothing; its keys change while it runs.

#include <csignal>
#include <cstdio>
#include <fstream>

#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

/// ns on a CPU, of the only thread: the kernel's own count.
std::uint64_t run_time_of(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/schedstat");
    std::uint64_t ns = 0;
    file >> ns;
    return ns;
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
    const std::uint64_t before = run_time_of(bridge.pid());
    ASSERT_GT(before, 0u);
    cycles(1000);
    // 10 ticks, 10 words of the clock; one wake-up for each of 1000 cycles would be more than 10 ms, and a
    // loop that waits for nothing all of the second.
    EXPECT_LT(run_time_of(bridge.pid()) - before, 5'000'000u);
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
    while (bridge.line().find("anna@") == std::string::npos) {
    }

    std::vector<Key> keys = read_keys(ring.file());
    std::filesystem::remove(ring.file());
    add_key(ring.file(), *find_key(keys, "bert"));
    ::kill(bridge.pid(), SIGHUP);
    const std::string said = bridge.line();
    EXPECT_NE(said.find("anna@"), std::string::npos) << said;
    says(said, "its key is not in the file any more");
    says(bridge.line(), "read again");
    while (going.connected()) going.next_report(10ms);
    EXPECT_EQ(refused_by(bridge, anna).kind, Error::Kind::permission);
    EXPECT_TRUE(staying.next_report(10s)) << "the others notice nothing";
    EXPECT_EQ(staying.reattachments(), 0u);

    std::ofstream(ring.file()) << "nonsense\n";
    ::kill(bridge.pid(), SIGHUP);
    while (bridge.line().find("the keys stay as they were") == std::string::npos) {
    }
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
