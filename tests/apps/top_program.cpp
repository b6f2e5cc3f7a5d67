// `knurl top` beside a servo.

#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <knurl/client/client.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Top, ShowsDevicePartsAndClients) {
    const Home home;
    Background servo({knurld_program(), "--device", "hand=sim:cartesian3"});
    ASSERT_TRUE(servo.says("ready")) << servo.said();
    Claim hand = Client::connect("knurl:default").claim();
    hand.add(Plane{.stiffness = 500});
    hand.arm();
    hand.commit();
    const Outcome outcome = knurl({"top", "--looks", "3", "--rate", "4", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::istringstream lines(outcome.out);
    std::size_t looks = 0;
    for (std::string line; std::getline(lines, line); ++looks) {
        const json device = json::parse(line).at("devices").at(0);
        EXPECT_EQ(device.at("name"), "hand");
        EXPECT_GT(device.at("rate"), 0);
        for (const char* part : {"read", "kinematics", "take", "scenes", "supervise", "write", "publish"})
            EXPECT_GE(device.at("parts_us").at(part), 0) << part;
        EXPECT_GT(device.at("step_us"), 0);
        EXPECT_GE(device.at("lateness_max_us"), device.at("lateness_median_us"));
        ASSERT_EQ(device.at("clients").size(), 1u);
        EXPECT_EQ(device.at("clients")[0].at("role"), "claim");
    }
    EXPECT_EQ(looks, 3u);
    const Outcome text = knurl({"top", "--looks", "1", "--rate", "4"});
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("hand (sim:cartesian3)"));
    EXPECT_THAT(text.out, HasSubstr("cycle  read "));
    EXPECT_THAT(text.out, testing::Not(HasSubstr("\033"))) << "no terminal, no escapes";
}

TEST(Top, AServoThatEndsEndsItWithALine) {
    const Home home;
    Background servo({knurld_program(), "--device", "sim:cartesian3"});
    ASSERT_TRUE(servo.says("ready")) << servo.said();
    Background top({knurl_program(), "top", "--rate", "20"});
    ASSERT_TRUE(top.says("cycle  read")) << top.said();
    servo.end(SIGKILL);
    EXPECT_TRUE(top.says("has ended")) << top.said();
}

TEST(Top, BadArgumentsAndMissingServosAreOneLine) {
    const Home home;
    EXPECT_THAT(knurl({"top", "nobody"}).err, HasSubstr("nobody"));
    EXPECT_EQ(knurl({"top", "nobody"}).code, 1);
    EXPECT_THAT(knurl({"top", "--rate", "100"}).err, HasSubstr("--rate is 100 Hz; give 0.1 to 20"));
    EXPECT_EQ(knurl({"top", "--rate", "100"}).code, 2);
}

}  // namespace
}  // namespace knurl::test
