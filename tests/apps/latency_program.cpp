// `knurl latency`: the form of its output. No test depends on the speed of the machine.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <latency_udp.hpp>
#include <proxy.hpp>
#include <unistd.h>

#include <knurl/json/json.hpp>

#include "../client/bridge_process.hpp"
#include "program.hpp"

namespace knurl::test {
namespace {

using json = knurl::Json;

json measured(std::vector<std::string> words) {
    const Folder folder;
    words.insert(words.begin(), {"latency", "--json", folder.path("L.json")});
    const Outcome outcome = knurl(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json::parse(text_of_file(folder.path("L.json")));
}

const json& named(const json& all, const std::string& name) {
    for (const json& result : all["results"]) {
        if (result["name"] == name) return result;
    }
    ADD_FAILURE() << "no " << name;
    return all;
}

/// Counts lines without the one that says that real-time priority is not permitted.
std::ptrdiff_t lines_besides_rights(const std::string& said) {
    std::istringstream lines(said);
    std::ptrdiff_t count = 0, of_rights = 0;
    for (std::string line; std::getline(lines, line);)
        ++(line.find("no right to real-time priority") != std::string::npos ? of_rights : count);
    EXPECT_EQ(of_rights, missing_real_time(1).empty() ? 0 : 1) << said;
    return count;
}

class Latency : public testing::Test {
  protected:
    static void SetUpTestSuite() { all = measured({"--updates", "150", "--seed", "7"}); }
    static json all;
};
json Latency::all;

TEST_F(Latency, NamesTheMachine) {
    std::set<std::string> keys;
    for (const auto& [key, value] : all["machine"].items()) keys.insert(key);
    EXPECT_EQ(keys, (std::set<std::string>{"processor", "cpus", "kernel", "load", "idle", "build", "date"}));
}

TEST_F(Latency, MeasuresBothWaysAndTheFloors) {
    for (const char* name :
         {"update.commit_to_write", "update.age_at_use", "update.report_age_at_use", "command.round_trip",
          "command.less_cycle_wait", "report.spinning", "report.blocking", "report.descriptor",
          "servo.lateness", "floor.eventfd_wake", "floor.bare_loop_lateness"}) {
        EXPECT_GT(named(all, name)["n"], 0) << name;
        EXPECT_EQ(named(all, name)["unit"], "us") << name;
    }
    EXPECT_GE(named(all, "update.commit_to_write")["n"], 150);
    EXPECT_GE(named(all, "command.round_trip")["n"], 150 / 4);
}

TEST_F(Latency, OnOneBoxThereIsNoNetworkAndEachUpdateIsAccountedFor) {
    EXPECT_TRUE(all.at("network").is_null());
    EXPECT_TRUE(all.at("updates").at("merged").is_number_unsigned());
    EXPECT_TRUE(all.at("updates").at("lost").is_number_unsigned());
}

TEST_F(Latency, NoCycleThatBeginsAfterACommitOverlooksIt) {
    const json& overlooked = named(all, "update.cycles_overlooked");
    EXPECT_GE(overlooked["n"], 150);
    EXPECT_EQ(overlooked["max"], 0);
}

TEST_F(Latency, APercentileWithFewerThanTenSamplesAboveItIsNull) {
    for (const json& result : all["results"]) {
        const double n = result["n"];
        EXPECT_EQ(result["p999"].is_null(), n - std::ceil(0.999 * n) < 10) << result;
        EXPECT_EQ(result["p99"].is_null(), n - std::ceil(0.99 * n) < 10) << result;
        EXPECT_EQ(result["p50"].is_null(), n - std::ceil(0.5 * n) < 10) << result;
    }
}

TEST_F(Latency, StatesEachWayAsAMultipleOfItsFloor) {
    for (const auto& [name, floor] : {std::pair("report.blocking", "floor.eventfd_wake"),
                                      {"report.descriptor", "floor.eventfd_wake"},
                                      {"command.less_cycle_wait", "floor.eventfd_wake"},
                                      {"servo.lateness", "floor.bare_loop_lateness"}}) {
        const json& result = named(all, name);
        EXPECT_EQ(result["reference"], floor);
        if (!result["ratio"].is_number()) continue;  // on a slow machine a floor may have too few samples
        const double expected = result["p50"].get<double>() / named(all, floor)["p50"].get<double>();
        EXPECT_NEAR(result["ratio"], expected, 1e-9 * std::abs(expected));
    }
}

TEST_F(Latency, EachSampleIsInABlockAndInTheHistogram) {
    const auto count = [](const json& histogram) {
        std::uint64_t n = 0;
        for (const json& bucket : histogram) n += bucket.at(1).get<std::uint64_t>();
        return n;
    };
    for (const json& result : all["results"]) {
        std::uint64_t in_blocks = 0;
        for (const json& block : result["blocks"]) in_blocks += count(block);
        EXPECT_EQ(in_blocks, result["n"]) << result["name"];
        EXPECT_EQ(count(result["histogram"]), result["n"]) << result["name"];
        // Blocks of one round each: block i of a path and of its floor cover the same moments.
        EXPECT_EQ(result["blocks"].size(), all["results"][0]["blocks"].size()) << result["name"];
    }
}

TEST_F(Latency, SaysWhatItIsAndWhatElseTheMachineDid) {
    EXPECT_EQ(all.at("format").at("program"), "knurl latency");
    EXPECT_EQ(all.at("setting").at("load"), "none");
    EXPECT_EQ(all.at("setting").at("servo"), "private");
    EXPECT_TRUE(all.at("ended").is_null());
}

TEST(LatencyOf, ATimeUnderAStatedLoadComparedWithAnEarlierRun) {
    const Folder folder;
    const std::string path = folder.path("old.json");
    const json old = measured({"--for", "0.3", "--load", "memory"});
    std::ofstream(path) << old;
    EXPECT_EQ(old.at("setting").at("load"), "memory");
    EXPECT_GT(old.at("setting").at("load_threads"), 0);
    const json all = measured({"--for", "0.3", "--compare", path, "--percentile", "75"});
    std::set<std::string> names;
    for (const json& compared : all.at("comparison").at("paths")) {
        names.insert(compared.at("name"));
        EXPECT_EQ(compared.at("verdict"), "undecided") << "of so few blocks";
    }
    EXPECT_TRUE(names.contains("update.commit_to_write"));
    EXPECT_THAT(all.at("comparison").at("warnings"), testing::Contains("`load` was \"memory\", is \"none\""));
    EXPECT_EQ(all.at("percentile").at("of"), 75);
    EXPECT_TRUE(all.at("percentile").at("values").contains("servo.lateness"));
}

TEST(LatencyOf, WithoutRightsItSaysWhatIsLostAndMeasuresTheRest) {
#if defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "knurld asks for no real-time priority in a build with ThreadSanitizer";
#endif
    KNURL_NEEDS(missing_loss_of_rights());
    const Folder folder;
    const Outcome outcome = knurl_without_rights(folder, {"latency", "--updates", "20", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr("no right to real-time priority"));
    EXPECT_THAT(outcome.err, testing::HasSubstr("the servo's real-time priority: "));
    const json all = json::parse(outcome.out);
    EXPECT_EQ(all.at("setting").at("real_time"), false);
    EXPECT_GE(named(all, "update.commit_to_write")["n"], 20);
}

TEST(LatencyOf, AServoThatEndsLeavesWhatWasMeasuredUntilThen) {
    const Home home;
    Servo servo({"--name", "mine", "--device", "sim:cartesian3"});
    Background latency({knurl_program(), "latency", "--connect", "knurl:mine", "--for", "600", "--json",
                        home.path("L.json")});
    // Each update is a batch: once the force is there some blocks have updates.
    std::uint64_t before = 0;
    ASSERT_TRUE(eventually([&] {
        const json servos = json::parse(knurl({"ls", "--json"}).out);
        const json& clients = servos.at("servos").at(0).at("devices").at(0).at("clients");
        if (clients.empty() || clients.at(0).at("gain") < 1) return false;
        const std::uint64_t updates = clients.at(0).at("updates");
        if (before == 0) before = updates;
        return updates > before + 200;
    }));
    servo.end(SIGKILL);
    EXPECT_TRUE(latency.says("updates were measured until then")) << latency.said();
    const std::string said = latency.said();  // with the table, which is printed beside a file
    const std::string why = said.substr(said.rfind("knurl latency: "));
    EXPECT_EQ(std::count(why.begin(), why.end(), '\n'), 1) << said;
    EXPECT_EQ(latency.end(0), 1);
    const json all = json::parse(text_of_file(home.path("L.json")));
    EXPECT_GT(named(all, "update.commit_to_write")["n"], 0);
    EXPECT_TRUE(all.at("ended").is_string());
}

TEST(LatencyOf, ARunningServoIsMeasuredByName) {
    const Home home;
    const Servo servo({"--name", "mine", "--device", "sim:cartesian3", "--rate", "2000"});
    const json all = measured({"--connect", "knurl:mine", "--updates", "20"});
    EXPECT_GE(named(all, "update.commit_to_write")["n"], 20);
}

/// Checks the commands, and the floor that is measured in turns with them.
void expect_commands_beside_tcp(const json& all, std::size_t least) {
    for (const char* name : {"command.round_trip", "command.less_cycle_wait", "floor.tcp_round_trip"})
        EXPECT_GE(named(all, name)["n"], least) << name;
    EXPECT_GT(named(all, "floor.wake_and_tcp")["n"], 0);
    for (const auto& [name, floor] : {std::pair("command.round_trip", "floor.tcp_round_trip"),
                                      {"command.less_cycle_wait", "floor.wake_and_tcp"}}) {
        const json& result = named(all, name);
        EXPECT_EQ(result["reference"], floor);
        if (!result["ratio"].is_number()) continue;  // on a slow machine there are few wake-ups
        const double expected = result["p50"].get<double>() / named(all, floor)["p50"].get<double>();
        EXPECT_NEAR(result["ratio"], expected, 1e-9 * std::abs(expected));
    }
    EXPECT_TRUE(named(all, "command.round_trip")["ratio"].is_number());
}

/// The printed bound is one cycle of 1 ms and 1.2 x the floors of the table beside it.
void expect_remote_bound(const json& all, std::size_t least) {
    for (const char* name : {"update.remote_to_use", "update.remote_to_write"})
        EXPECT_GE(named(all, name)["n"], least) << name;
    const json &udp = named(all, "floor.udp_one_way"), &wake = named(all, "floor.eventfd_wake");
    if (!udp["p50"].is_number() || !wake["p50"].is_number()) return;  // on a slow machine there are few
    ASSERT_EQ(all["bounds"].size(), 1u);
    const json& bound = all["bounds"][0];
    EXPECT_EQ(bound["name"], "update.remote_to_use");
    EXPECT_EQ(bound["n"], named(all, "update.remote_to_use")["n"]);
    const double limit = 1000 + 1.2 * (udp["p50"].get<double>() + wake["p50"].get<double>());
    EXPECT_NEAR(bound["limit"], limit, 1e-6);
    EXPECT_LE(bound["within"].get<std::size_t>() + bound["stalled"].get<std::size_t>(), bound["n"]) << bound;
}

TEST(LatencyOf, ARunningServoIsMeasuredThroughItsBridgeBesidePlainEchoes) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    const client_test::BridgeProcess bridge;
    const json all = measured({"--connect", bridge.address(), "--updates", "80"});
    EXPECT_GE(named(all, "update.commit_to_write")["n"], 80);
    for (const char* name : {"report.blocking_after_write", "floor.udp_one_way", "floor.wake_and_udp"})
        EXPECT_GT(named(all, name)["n"], 0) << name;
    EXPECT_EQ(named(all, "report.blocking_after_write")["reference"], "floor.wake_and_udp");
    expect_commands_beside_tcp(all, 20);
    expect_remote_bound(all, 80);
    const json& network = all["network"];
    EXPECT_EQ(network["encrypted"], false);
    EXPECT_EQ(network["command_bytes"], 72);
    // Both ends have the same clock here: the estimate is right if its error is within the stated
    // uncertainty.
    EXPECT_LE(std::abs(network["clock_offset_s"].get<double>()),
              network["clock_uncertainty_s"].get<double>());
    EXPECT_LE(std::abs(network["drift_ppm"].get<double>()), network["drift_uncertainty_ppm"].get<double>());
    EXPECT_GT(network["round_trip_s"].get<double>(), 0);
    for (const char* count : {"reports_lost", "reports_late", "datagrams_doubled", "batches_resent"})
        EXPECT_TRUE(network[count].is_number_unsigned()) << count;
}

TEST(LatencyOf, AFarServoIsMeasuredToTheEnd) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    const client_test::BridgeProcess bridge;
    bridge::proxy::Proxy::Options options;
    options.to_port = bridge.port();
    options.profile.delay = 0.03;  // a block has time for only one command and one ping-pong
    const bridge::proxy::Proxy far(options);
    const json all =
        measured({"--connect", "knurl://127.0.0.1:" + std::to_string(far.port()), "--updates", "12"});
    EXPECT_GE(named(all, "update.remote_to_use")["n"], 12);
    EXPECT_GE(named(all, "command.round_trip")["n"], 12 / 4);
}

TEST(LatencyOf, WithAKeyTheEchoesAreAsLongAsWhatIsSealed) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    const std::string keys = home.path("bridge.keys");  // with one key in it, also its owner's file
    const Outcome key = run({KNURL_BRIDGE, "keygen", "--keys", keys, "--name", "hand", "--role", "control"});
    ASSERT_EQ(key.code, 0) << key.err;
    const client_test::BridgeProcess bridge({"--keys", keys});
    ::setenv("KNURL_KEY", keys.c_str(), 1);
    const json all = measured({"--connect", bridge.address(), "--updates", "4"});
    ::unsetenv("KNURL_KEY");
    EXPECT_EQ(all["network"]["encrypted"], true);
    EXPECT_EQ(all["network"]["command_bytes"], 94) << "8 + 64, and 22 of a TLS 1.3 record";
    EXPECT_GT(named(all, "floor.tcp_round_trip")["n"], 0);
}

/// The one line of complaint; checks that commands were measured nevertheless.
std::string complaint(const std::string& bridge, const std::string& echo) {
    const Folder folder;
    const Outcome outcome = knurl(
        {"latency", "--json", folder.path("L.json"), "--connect", bridge, "--echo", echo, "--updates", "80"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(lines_besides_rights(outcome.err), 1) << outcome.err;
    const json all = json::parse(text_of_file(folder.path("L.json")));
    EXPECT_GE(named(all, "update.commit_to_write")["n"], 80);
    EXPECT_GE(named(all, "command.round_trip")["n"], 20);
    EXPECT_EQ(named(all, "floor.tcp_round_trip")["n"], 0);
    EXPECT_TRUE(named(all, "command.round_trip")["ratio"].is_null());
    return outcome.err;
}

TEST(LatencyOf, WhereNobodyEchoesOneLineSaysSoAndTheRestIsMeasured) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    const client_test::BridgeProcess bridge;
    EXPECT_THAT(complaint(bridge.address(), "127.0.0.1:1"),
                testing::HasSubstr("nobody echoes at 127.0.0.1:1 by UDP or TCP; start `knurl latency"));
    const cli::UdpEcho udp(cli::Placement{});
    const std::string at = bridge::numeric(udp.at().address);
    EXPECT_THAT(complaint(bridge.address(), at), testing::HasSubstr("nobody echoes at " + at + " by TCP;"));
}

TEST(LatencyOf, ARealTimeClientThatSpinsLeavesTheFloorsTheirShare) {
    KNURL_NEEDS(missing_real_time(10));
    // A former deadlock: the partner of floor.cache_line started on the CPU on which its creator spun with a
    // higher priority.
    const Folder folder;
    const Outcome outcome =
        knurl({"latency", "--priority", "10", "--updates", "20", "--json", folder.path("L.json")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST(LatencyRefuses, WhatItCannotMeasureInOneLine) {
    const Home home;
    struct Case {
        std::vector<std::string> words;
        const char* says;
    };
    for (const Case& c :
         {Case{{"--updates", "0"}, "--updates is 0"}, Case{{"--rate", "100"}, "500 to 20000 Hz"},
          Case{{"--connect", "knurl:nobody", "--wait", "0"}, "nobody"}, Case{{"--wait", "-1"}, "0 to 3600 s"},
          Case{{"--connect", "knurl://127.0.0.1:1", "--wait", "0"}, "127.0.0.1:1"},
          Case{{"--serve-echo", "127.0.0.1:none"}, "127.0.0.1:none"},
          Case{{"--percentile", "99.99"},
               "--percentile 99.99 of 10000 updates would have fewer than ten of them above it; give "
               "--updates 100000"},
          Case{{"--percentile", "100"}, "--percentile is 100; give one between 0 and 100"},
          Case{{"--for", "-1"}, "--for is -1 s"}, Case{{"--for", "1", "--updates", "5"}, "excludes"},
          Case{{"--json", "/no/L.json", "--for", "600"}, "/no/L.json: cannot be written: No such file"},
          Case{{"--load", "heavy"}, "--load"}, Case{{"--measured", "x.json"}, "name that by --compare"}}) {
        auto words = c.words;
        words.insert(words.begin(), "latency");
        const Outcome outcome = knurl(words);
        EXPECT_NE(outcome.code, 0);
        EXPECT_NE(outcome.err.find(c.says), std::string::npos) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
}

}  // namespace
}  // namespace knurl::test
