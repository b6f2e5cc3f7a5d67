// The main use case from another host: knurl-surface strokes a relief through a bridge with a key. If two
// network namespaces can be created, they are connected by a real wire. The test checks the program's own
// verdict.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/json/json.hpp>

#include "../client/bridge_process.hpp"
#include "program.hpp"
#include "two_hosts.hpp"

namespace {

using knurl::bridge::test::TwoHosts;
using knurl::test::Background;
using knurl::test::Home;
using knurl::test::run;

/// One broad hill: 40 x 20 mm, 10 mm high.
std::string hill() {
    std::ostringstream pgm;
    pgm << "P2 80 40 10000\n";
    for (int r = 0; r < 40; ++r)
        for (int c = 0; c < 80; ++c)
            pgm << std::lround(10000 * std::pow(std::sin(M_PI * c / 79) * std::sin(M_PI * r / 39), 2))
                << '\n';
    return pgm.str();
}

TEST(SurfaceOverABridge, StrokesAReliefOfAnotherHostAndIsJudgedStable) {
    const Home home;
    const TwoHosts hosts;
    if (!hosts.two()) std::fprintf(stderr, "one host only (%s): over loopback\n", hosts.why().c_str());
    const std::string model = home.file("hill.pgm", hill()), stroke = home.path("stroke.csv"),
                      keys = home.path("bridge.keys"), outcome_file = home.path("out.json");
    ASSERT_EQ(run({KNURL_SURFACE_PROGRAM, model, "--write-stroke", stroke}).code, 0);
    ASSERT_EQ(run({KNURL_BRIDGE, "keygen", "--keys", keys, "--name", "hand", "--role", "control"}).code, 0);
    Background knurld({KNURLD_PROGRAM, "--device", "sim:premium15", "--hand", stroke});
    ASSERT_TRUE(knurld.says("ready")) << knurld.said();
    std::optional<client_test::BridgeProcess> bridge;
    {
        const TwoHosts::On on(hosts, TwoHosts::Host::server);
        bridge.emplace(std::vector<std::string>{"--keys", keys},
                       hosts.address(TwoHosts::Host::server) + ":0");
    }
    ASSERT_FALSE(bridge->address().empty()) << bridge->first_line();

    ::setenv("KNURL_KEY", keys.c_str(), 1);  // with one key in it, also its owner's file
    const auto outcome = [&] {
        const TwoHosts::On on(hosts, TwoHosts::Host::client);
        return run({KNURL_SURFACE_PROGRAM, model, "--connect", bridge->address(), "--wait", "30", "--ways",
                    "force,knurl,mesh", "--json", outcome_file});
    }();
    ::unsetenv("KNURL_KEY");
    ASSERT_EQ(outcome.code, 0) << outcome.err << knurld.said();
    const auto json = knurl::Json::parse(knurl::test::text_of_file(outcome_file));
    const auto &force = json.at("strokes").at(0), &knurl = json.at("strokes").at(1);
    const auto& mesh = json.at("strokes").at(2);
    EXPECT_FALSE(force.at("stable")) << force;
    for (const auto* stroke_made : {&force, &knurl}) EXPECT_GT(stroke_made->at("updates"), 5) << *stroke_made;
    for (const auto* felt : {&knurl, &mesh}) {
        EXPECT_GT(felt->at("cycles"), 1000) << "to its end: " << *felt;
        EXPECT_TRUE(felt->at("fault_at_s").is_null()) << *felt;
        EXPECT_GT(felt->at("mean_force"), 0.5) << *felt;
        EXPECT_GT(felt->at("contact_share"), 0.5) << *felt;
        // If the machine stands still, reports are lost and updates come late. That is not the program's
        // fault, but its verdict counts it.
        const double late = felt->at("age_max_s").get<double>() - felt->at("age_p50_s").get<double>();
        if (felt->at("stalls") == 0 && felt->at("missed") == 0 && late < 0.01) {
            EXPECT_TRUE(felt->at("stable")) << *felt;
        }
    }
    EXPECT_EQ(knurld.end(SIGTERM), 0);
}

}  // namespace
