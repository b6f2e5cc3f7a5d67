// `knurl top` beside a servo.

#include <csignal>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/json/json.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using namespace std::chrono_literals;
using json = knurl::Json;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

json last_look(const std::vector<std::string>& more) {
    std::vector<std::string> words = {"top", "--rate", "5", "--json", "--count"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = knurl(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::istringstream lines(outcome.out);
    std::string line, last;
    while (std::getline(lines, line)) last = line;
    return json::parse(last);
}

TEST(Top, ShowsEachDevicesCycleAndItsParts) {
    const Home home;
    Servo servo({"--device", "left=sim:cartesian3", "--device", "right=sim:premium15", "--rate", "2000"});
    const Outcome outcome = knurl({"top", "--count", "3", "--rate", "4", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::istringstream lines(outcome.out);
    int looks = 0;
    for (std::string line; std::getline(lines, line); ++looks) {
        const json devices = json::parse(line).at("devices");
        ASSERT_EQ(devices.size(), 2u);
        EXPECT_EQ(devices[0].at("name"), "left");
        EXPECT_EQ(devices[1].at("name"), "right");
        for (const json& device : devices) {
            EXPECT_GT(device.at("measured_rate"), 0);
            double sum = 0;  // us
            for (const char* part :
                 {"read", "kinematics", "take", "scenes", "supervise", "write", "publish"}) {
                EXPECT_GE(device.at("parts_s").at(part), 0) << part;
                sum += device.at("parts_s").at(part).get<double>();
            }
            EXPECT_GT(sum, 0);
            EXPECT_NEAR(device.at("step_s"), sum, 1e-9 * sum);
            EXPECT_GE(device.at("parts_s").at("sleep"), 0);
            EXPECT_GE(device.at("late_max_s"), device.at("late_p50_s"));
            EXPECT_TRUE(device.at("clients").empty());
        }
    }
    EXPECT_EQ(looks, 3);
}

TEST(Top, WithoutATerminalTheLooksFollowEachOtherAsPlainLines) {
    const Home home;
    const Servo servo({"--device", "hand=sim:cartesian3"});
    const Outcome outcome = knurl({"top", "--count", "2", "--rate", "4"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("knurl:default  pid " + std::to_string(servo.pid())));
    EXPECT_THAT(outcome.out, HasSubstr("\nhand (sim:cartesian3)  idle"));
    EXPECT_THAT(outcome.out, HasSubstr("cycle us  read "));
    EXPECT_THAT(outcome.out, HasSubstr("nobody holds it\nknurl:default  pid "));
    EXPECT_THAT(outcome.out, Not(HasSubstr("\033")));
}

TEST(Top, ClientsComeAndGo) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    Client client = Client::connect("knurl:default");
    {
        Claim hand = client.claim();
        hand.add(Plane{.stiffness = 500});
        hand.commit();
        const json clients = last_look({"2"}).at("devices").at(0).at("clients");
        ASSERT_EQ(clients.size(), 1u);
        EXPECT_EQ(clients[0].at("role"), "claim");
        EXPECT_EQ(clients[0].at("pid"), ::getpid());
        EXPECT_EQ(clients[0].at("reports_missed"), 0);
    }
    EXPECT_TRUE(eventually([] { return last_look({"1"}).at("devices").at(0).at("clients").empty(); }));
}

TEST(Top, SaysHowManyReportsAClientWasTooSlowToRead) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3", "--rate", "16000"});
    Client client = Client::connect("knurl:default");
    Observer slow = client.observe(), watch = client.observe();
    const auto before = slow.next_report(10s);
    ASSERT_TRUE(before);
    // The ring keeps 4095 reports.
    for (auto now = watch.latest(); !now || now->cycle < before->cycle + 9000; now = watch.latest())
        watch.next_report(1s);
    ASSERT_TRUE(slow.next_report(1s));
    ASSERT_GT(slow.missed(), 4000u);
    const json clients = last_look({"2"}).at("devices").at(0).at("clients");
    ASSERT_EQ(clients.size(), 2u);
    EXPECT_EQ(clients[0].at("reports_missed"), slow.missed());
    EXPECT_EQ(clients[0].at("reports_missed_now"), 0) << "not in this time";
    EXPECT_EQ(clients[1].at("reports_missed"), 0);
}

TEST(Top, WaitsForAServoThatHasEndedAndLooksAtTheNext) {
    const Home home;
    Servo first({"--device", "sim:cartesian3"});
    const std::string pid = std::to_string(first.pid());
    Background top({knurl_program(), "top", "--rate", "20"});
    ASSERT_TRUE(top.says("cycle us  read")) << top.said();
    first.end(SIGKILL);
    ASSERT_TRUE(top.says("pid " + pid + " has ended")) << top.said();
    const Servo next({"--device", "sim:premium15"});
    EXPECT_TRUE(top.says("has taken the place of " + pid)) << top.said();
    EXPECT_TRUE(top.says("premium15 (sim:premium15)")) << top.said();
    EXPECT_EQ(top.end(SIGINT), 0) << "it was asked to end";
}

TEST(Top, BadArgumentsAndMissingServosAreOneLine) {
    const Home home;
    const Outcome nobody = knurl({"top", "nobody"});
    EXPECT_EQ(nobody.code, 1);
    EXPECT_EQ(nobody.out, "");
    EXPECT_THAT(nobody.err, HasSubstr("nobody.sock"));
    EXPECT_THAT(nobody.err, HasSubstr("is the servo of that name running?"));
    EXPECT_EQ(std::count(nobody.err.begin(), nobody.err.end(), '\n'), 1) << nobody.err;
    for (const char* rate : {"100", "0", "nan"}) {
        const Outcome outcome = knurl({"top", "--rate", rate});
        EXPECT_EQ(outcome.code, 2);
        EXPECT_THAT(outcome.err, testing::AnyOf(HasSubstr("give 0.1 to 20"), HasSubstr("nan is no number")));
    }
}

const std::vector<std::string>& quickly() {
    static const std::vector<std::string> words = {knurl_program(), "top", "--rate", "20"};
    return words;
}

TEST(Top, OnANarrowTerminalItTakesAPageAndGivesItBack) {
    KNURL_NEEDS(missing_terminal());
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    ::setenv("NO_COLOR", "1", 1);
    OnTerminal top(quickly(), 40, 10);
    ::unsetenv("NO_COLOR");
    ASSERT_TRUE(top.shows("lateness")) << top.shown;  // later columns may not fit
    constexpr char interrupt = 3;                     // Ctrl-C
    top.type(interrupt);
    EXPECT_EQ(top.end(), 0);
    const std::string page = "\033[?1049h", no_cursor = "\033[?25l";
    EXPECT_THAT(top.shown, StartsWith(page + no_cursor));
    EXPECT_THAT(top.shown, EndsWith("\033[?25h\033[?1049l"));
    // No line, without escape sequences, is wider than the terminal.
    const std::string last = top.shown.substr(top.shown.rfind("\033[J") + 3);
    std::istringstream lines(last.substr(0, last.find('\033')));
    int rows = 0;
    for (std::string line; std::getline(lines, line); ++rows) EXPECT_LE(line.size(), 41u) << line;  // and \r
    EXPECT_LE(rows, 10);
    EXPECT_GT(rows, 4);
}

TEST(Top, SaysWhichKeyEndsItAndEndsByIt) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    OnTerminal top(quickly(), 100, 30);
    ASSERT_TRUE(top.shows("q: end")) << top.shown;
    top.type('x');
    top.type('q');
    EXPECT_EQ(top.end(), 0);
}

TEST(Top, WhatIsWrongIsRedUnlessNobodyWantsColours) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    const std::string red = "\033[1;31m";
    for (const bool colours : {true, false}) {
        ::kill(servo.pid(), SIGCONT);
        if (!colours) ::setenv("NO_COLOR", "1", 1);
        OnTerminal top(quickly(), 100, 30);
        ::unsetenv("NO_COLOR");
        ASSERT_TRUE(top.shows("lateness")) << top.shown;
        ::kill(servo.pid(), SIGSTOP);
        ASSERT_TRUE(top.shows("has ended or stands still")) << top.shown;
        top.type('q');
        EXPECT_EQ(top.end(), 0);
        EXPECT_EQ(top.shown.find(red) != std::string::npos, colours) << top.shown;
    }
    ::kill(servo.pid(), SIGCONT);
}

TEST(Top, SuspendedItGivesTheTerminalBackAndTakesItAgain) {
    KNURL_NEEDS(missing_terminal());
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    OnTerminal top(quickly(), 100, 30);
    ASSERT_TRUE(top.shows("lateness")) << top.shown;
    top.shown.clear();
    ::kill(top.pid(), SIGTSTP);
    int status = 0;
    ASSERT_EQ(::waitpid(top.pid(), &status, WUNTRACED), top.pid());
    ASSERT_TRUE(WIFSTOPPED(status)) << "it was suspended";
    EXPECT_TRUE(top.shows("\033[?1049l")) << "the shell's own page is back";
    ::kill(top.pid(), SIGCONT);
    EXPECT_TRUE(top.shows("\033[?1049h")) << "and its own again";
    EXPECT_TRUE(top.shows("lateness")) << top.shown;
    ::kill(top.pid(), SIGTERM);
    EXPECT_EQ(top.end(), 0);
}

TEST(Top, AServoThatStandsStillIsNoReasonToHang) {
    const Home home;
    const Servo servo({"--device", "sim:cartesian3"});
    Background top({knurl_program(), "top", "--rate", "20"});
    ASSERT_TRUE(top.says("lateness")) << top.said();
    ::kill(servo.pid(), SIGSTOP);
    EXPECT_TRUE(top.says("pid " + std::to_string(servo.pid()) + " has ended or stands still")) << top.said();
    ::kill(servo.pid(), SIGCONT);
    EXPECT_EQ(top.end(SIGTERM), 0);
}

}  // namespace
}  // namespace knurl::test
