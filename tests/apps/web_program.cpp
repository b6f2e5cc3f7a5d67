// knurl-web and `knurl web` as a person runs them. What the server does is in tests/gateway.

#include <csignal>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace {

using knurl::test::Background;
using knurl::test::Folder;
using knurl::test::Home;
using knurl::test::run;
using testing::HasSubstr;
using testing::StartsWith;

std::string port_of(const std::string& said) {
    std::smatch found;
    return std::regex_search(said, found, std::regex("http://127\\.0\\.0\\.1:(\\d+)/\\?token=[0-9a-f]{32}\n"))
               ? found[1].str()
               : "none";
}

TEST(WebProgram, PrintsAnAddressAndAnotherOnASignal) {
    Background web({KNURL_WEB_PROGRAM, "--listen", "127.0.0.1:0", "--no-inverse"});
    ASSERT_TRUE(web.says("another token: kill -USR1 " + std::to_string(web.pid()))) << web.said();
    EXPECT_NE(port_of(web.said()), "none") << web.said();
    EXPECT_THAT(web.said(), HasSubstr("/foxglove (observe)"));
    ::kill(web.pid(), SIGUSR1);
    EXPECT_TRUE(web.says("\nknurl-web: http://127.0.0.1:" + port_of(web.said()) + "/?token=")) << web.said();
    EXPECT_EQ(web.end(SIGTERM), 0);
}

TEST(WebProgram, EndsWellOnCtrlC) {
    Background web({KNURL_WEB_PROGRAM, "--listen", "127.0.0.1:0", "--no-inverse"});
    ASSERT_TRUE(web.says("another token")) << web.said();
    EXPECT_EQ(web.end(SIGINT), 0);
}

TEST(WebProgram, PortThatIsTaken) {
    Background web({KNURL_WEB_PROGRAM, "--listen", "127.0.0.1:0", "--no-inverse"});
    ASSERT_TRUE(web.says("another token")) << web.said();
    const std::string address = "127.0.0.1:" + port_of(web.said());
    const auto other = run({KNURL_WEB_PROGRAM, "--listen", address, "--no-inverse"});
    EXPECT_EQ(other.code, 1);
    EXPECT_EQ(other.err, "knurl-web: cannot listen at " + address + ": knurl-web (pid " +
                             std::to_string(web.pid()) +
                             ") has this port; end it, or give another --listen\n");
    // Its own default may be taken: the page comes nevertheless. What was asked for must be there.
    const auto inverse = run({KNURL_WEB_PROGRAM, "--listen", "127.0.0.1:0", "--inverse", address});
    EXPECT_EQ(inverse.code, 1);
    EXPECT_THAT(inverse.err, HasSubstr("another --inverse, or --no-inverse"));
}

TEST(WebProgram, OtherHostsNeedKeys) {
    const auto refused = run({KNURL_WEB_PROGRAM, "--listen", "0.0.0.0:0"});
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, HasSubstr("--tls-certificate and --tls-key, and --keys FILE"));
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
}

TEST(WebProgram, WordsThatMakeNoSense) {
    EXPECT_EQ(run({KNURL_WEB_PROGRAM, "--listen", "127.0.0.1:x"}).code, 2);
    EXPECT_EQ(run({KNURL_WEB_PROGRAM, "--foxglove-role", "king"}).code, 2);
    EXPECT_EQ(run({KNURL_WEB_PROGRAM, "--servo", "a b"}).code, 2);
}

TEST(WebVerb, StartsASimulatedServoAndEndsBoth) {
    const Home home;
    Background verb(
        {knurl::test::knurl_program(), "web", "--listen", "127.0.0.1:0", "--web-option=--no-inverse"});
    ASSERT_TRUE(verb.says("another token")) << verb.said();
    EXPECT_THAT(
        verb.said(),
        StartsWith("knurl web: no servo 'default' runs: this one is simulated (right=sim:premium15)\n"));
    EXPECT_NE(port_of(verb.said()), "none") << verb.said();
    const std::size_t at = verb.said().find("kill -USR1 ");
    const pid_t web = std::stoi(verb.said().substr(at + 11));
    EXPECT_EQ(::kill(web, 0), 0);
    EXPECT_EQ(verb.end(SIGINT), 0);
    EXPECT_NE(::kill(web, 0), 0) << "it is still there";
}

TEST(WebVerb, ShowsTheServoThatRuns) {
    const Home home;
    const knurl::test::Servo servo({"--device", "sim:premium15"});
    Background verb(
        {knurl::test::knurl_program(), "web", "--listen", "127.0.0.1:0", "--web-option=--no-inverse"});
    ASSERT_TRUE(verb.says("another token")) << verb.said();
    EXPECT_THAT(verb.said(), StartsWith("knurl-web: servo 'default' is at http://"));
}

TEST(WebVerb, SaysWhyItCannot) {
    const Home home;
    const auto ended = run({knurl::test::knurl_program(), "web", "--listen", "0.0.0.0:0"});
    EXPECT_EQ(ended.code, 1);
    EXPECT_THAT(ended.err, HasSubstr("knurl-web: cannot listen at 0.0.0.0:0"));
}

}  // namespace
