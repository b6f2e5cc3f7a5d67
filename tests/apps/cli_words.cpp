// "Did you mean ...?", and when there is no suggestion.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/words/nearest.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using words::nearest, words::slips;

TEST(Nearest, CountsSlips) {
    EXPECT_EQ(slips("", ""), 0u);
    EXPECT_EQ(slips("", "rate"), 4u);
    EXPECT_EQ(slips("rate", "rate"), 0u);
    EXPECT_EQ(slips("raet", "rate"), 1u);   // two neighbours swapped
    EXPECT_EQ(slips("rat", "rate"), 1u);    // one letter missing
    EXPECT_EQ(slips("ratte", "rate"), 1u);  // one letter too many
    EXPECT_EQ(slips("rare", "rate"), 1u);   // one letter replaced
    EXPECT_EQ(slips("kitten", "sitting"), 3u);
    EXPECT_EQ(slips("Low_Pass", "low-pass"), 0u);
}

TEST(Nearest, IsTheWordThatWasMeantOrNone) {
    const std::vector<std::string> keys{"name", "rate", "cpu", "priority", "idle", "guardian_stall"};
    EXPECT_EQ(nearest("raet", keys), "rate");
    EXPECT_EQ(nearest("NAME", keys), "name");
    EXPECT_EQ(nearest("prioritiy", keys), "priority");
    EXPECT_EQ(nearest("gardian-stal", keys), "guardian_stall");
    EXPECT_EQ(nearest("prio", keys), "priority");  // the beginning of the word
    EXPECT_EQ(nearest("colour", keys), "");
    EXPECT_EQ(nearest("x", keys), "");
    EXPECT_EQ(nearest("", keys), "");
    EXPECT_EQ(nearest("rate", std::vector<std::string>{}), "");
    EXPECT_EQ(nearest("ab", std::vector<std::string>{"cd"}), "");
}

TEST(CommandLines, AnAlmostRightWordIsAnsweredWithTheOneThatIsThere) {
    const auto refused = [](const std::vector<std::string>& words) {
        const Outcome outcome = knurl(words);
        EXPECT_EQ(outcome.code, 2);
        EXPECT_EQ(outcome.out, "");
        return outcome.err;
    };
    EXPECT_EQ(refused({"recrod", "r.mcap"}),
              "knurl: there is no verb 'recrod'; did you mean 'record'?; see knurl --help\n");
    EXPECT_EQ(refused({"device", "chekc"}),
              "knurl: there is no verb 'chekc'; did you mean 'check'?; see knurl device --help\n");
    // Even if required options are missing because of the mistake.
    EXPECT_EQ(refused({"eval", "--scen", "s.toml", "--motion", "m.csv", "--out", "-"}),
              "knurl eval: there is no option '--scen'; did you mean '--scene'?; see knurl eval --help\n");
    EXPECT_EQ(refused({"ls", "--frobnicate=3"}),
              "knurl ls: there is no option '--frobnicate'; see knurl ls --help\n");
    EXPECT_EQ(refused({"latency", "--load", "spni"}),
              "knurl latency: --load: 'spni'; did you mean 'spin'?; see knurl latency --help\n");
    EXPECT_EQ(refused({"latency", "--load", "heavy"}),
              "knurl latency: --load: 'heavy'; it is one of none, spin, memory; see knurl latency --help\n");
    const Outcome daemon = run({knurld_program(), "--devise", "sim:premium15"});
    EXPECT_EQ(daemon.code, 2);
    EXPECT_EQ(daemon.err,
              "knurld: there is no option '--devise'; did you mean '--device'?; see knurld --help\n");
}

}  // namespace
}  // namespace knurl::test
