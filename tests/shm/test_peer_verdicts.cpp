// knurl_bench_peers: its verdicts on which transport is faster, and on Knurl's goals.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "peers/verdicts.hpp"

namespace knurl::shm::peers {
namespace {

using Random = std::mt19937_64;

/// Where all take a mood from the block that they share.
struct Level {
    const char* name;
    double has_it, pays;  // us, medians
};

std::vector<Seen> run_of(const std::vector<Level>& levels, Random& random) {
    std::vector<Seen> all;
    for (const Level& level : levels) all.push_back({.name = level.name});
    for (int block = 0; block < 40; ++block) {
        const double mood = std::normal_distribution<double>(0, 0.03)(random);
        for (std::size_t i = 0; i < all.size(); ++i) {
            std::lognormal_distribution<double> scatter(mood, 0.1);
            std::vector<double> has_it, pays;
            for (int n = 0; n < 50; ++n) {
                has_it.push_back(levels[i].has_it * scatter(random));
                pays.push_back(levels[i].pays * scatter(random));
            }
            all[i].has_it.add(has_it);
            all[i].pays.add(pays);
            all[i].cpu.add({30});
            all[i].sent += 50;
        }
    }
    return all;
}

std::string verdict_on(const Verdicts& verdicts, const std::string& transport, double percentile) {
    for (const auto& one : verdicts.json.at("verdicts"))
        if (one.at("transport") == transport && one.at("percentile") == percentile) return one.at("verdict");
    return "none";
}

TEST(PeerVerdicts, SayWhoIsFasterAndWhoMayBe) {
    Random random(5);  // by chance a few runs in a hundred call equals different
    const Verdicts found = judge(run_of({{"floor", 40, 10},
                                         {"Knurl", 44, 10},
                                         {"Knurl, waker", 50, 0.5},
                                         {"equal", 44, 10},
                                         {"slow", 60, 10},
                                         {"fast", 30, 10}},
                                        random));
    EXPECT_EQ(verdict_on(found, "equal", 50), "undecided") << found.text;
    EXPECT_EQ(verdict_on(found, "slow", 50), "slower than Knurl") << found.text;
    EXPECT_EQ(verdict_on(found, "slow", 99), "slower than Knurl") << found.text;
    EXPECT_EQ(verdict_on(found, "fast", 50), "faster than Knurl") << found.text;
    EXPECT_EQ(verdict_on(found, "Knurl", 50), "none");
}

TEST(PeerVerdicts, HoldKnurlToItsPromises) {
    Random random(6);  // by chance one in a hundred calls what lies on a bound kept, or not
    const auto goals = [&](double knurl, double servo) {
        std::vector<std::string> said;
        const Verdicts found =
            judge(run_of({{"floor", 40, 10}, {"Knurl", knurl, servo}, {"Knurl, waker", 50, servo}}, random));
        for (const auto& goal : found.json.at("goals")) said.push_back(goal.at("verdict"));
        return said;
    };
    // A blocked client; median and 99th percentile of what the servo pays, by either way.
    EXPECT_EQ(goals(42, 0.5), std::vector<std::string>(5, "kept"));
    EXPECT_EQ(goals(60, 2.0), (std::vector<std::string>{"not kept", "not kept", "kept", "not kept", "kept"}));
    EXPECT_EQ(goals(48, 1.0).front(), "undecided") << "on the bound";
}

TEST(PeerVerdicts, SayWhyTheySayNothing) {
    const auto few = [](const char* name) {
        Seen made{.name = name};
        for (int i = 0; i < 5; ++i) made.has_it.add(std::vector<double>(20, 10.0));
        return made;
    };
    const Verdicts found = judge({few("floor"), few("Knurl"), few("Knurl, waker")});
    EXPECT_TRUE(found.json.at("verdicts").empty());
    EXPECT_NE(found.text.find("30 are needed"), std::string::npos) << found.text;
}

}  // namespace
}  // namespace knurl::shm::peers
