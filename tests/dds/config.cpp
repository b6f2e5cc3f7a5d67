// The configuration file: what it says, and where it is wrong.

#include <gtest/gtest.h>

#include <knurl/dds/config.hpp>

namespace {

using namespace knurl::dds;
using namespace std::chrono_literals;

Config read(const std::string& text) {
    Config config;
    read_config_text(text, "dds.toml", config);
    return config;
}

std::string wrong(const std::string& text) {
    try {
        read(text);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "nothing is wrong";
}

TEST(DdsConfig, says_all_that_there_is_to_say) {
    const Config config = read(R"(
servo = "lab"
name = "left-room"
domain = 7
interface = "eth0"
peers = ["10.0.0.2", "10.0.0.3"]
namespace = "room"
bridge = "lab.example:4096"
[rates]
measured_cp = 500
tf = 0
[remap]
"right/measured_cp" = "/fd/ee_pose"
[[command]]
device = "right"
from = ["planner"]
deadline = 0.05
lifespan = 0.1
enabled = false
representations = ["plane", "spring"]
)");
    EXPECT_EQ(config.robot.servo, "lab");
    EXPECT_EQ(config.name, "left-room");
    EXPECT_EQ(config.domain.id, 7u);
    EXPECT_EQ(config.domain.interface, "eth0");
    EXPECT_EQ(config.domain.peers.size(), 2u);
    EXPECT_EQ(config.bridge, "lab.example:4096");
    EXPECT_EQ(config.robot.rates.at("measured_cp"), 500);
    ASSERT_EQ(config.robot.commands.size(), 1u);
    EXPECT_EQ(config.robot.commands[0].deadline, 50ms);
    EXPECT_EQ(config.robot.commands[0].from, (std::vector<std::string>{"planner"}));
    EXPECT_FALSE(config.robot.commands[0].enabled);
    EXPECT_EQ(dds_topic(config.robot, "right/measured_cv"), "rt/room/right/measured_cv");
    EXPECT_EQ(dds_topic(config.robot, "right/measured_cp"), "rt/fd/ee_pose");
}

TEST(DdsConfig, the_example_of_the_readme_is_one) {
    std::ifstream file(KNURL_DDS_README);
    std::stringstream text;
    text << file.rdbuf();
    const std::string fence = "```text\n", page = text.str();
    const std::size_t begin = page.find(fence, page.find("## Configuration")) + fence.size();
    const Config config = read(page.substr(begin, page.find("```", begin) - begin));
    ASSERT_EQ(config.robot.commands.size(), 1u);
    EXPECT_EQ(config.robot.commands[0].representations, (std::vector<std::string>{"plane", "spring"}));
    EXPECT_EQ(config.bridge, "lab.example:4096");
}

TEST(DdsConfig, says_where_it_is_wrong_and_changes_nothing_then) {
    EXPECT_EQ(wrong("servo = 3"), "dds.toml:1:9: servo must be a string");
    EXPECT_EQ(wrong("domian = 3"), "dds.toml:1:1: unknown key \"domian\"; did you mean 'domain'?");
    EXPECT_EQ(wrong("domain = 233"), "dds.toml:1:10: domain must be a number from 0 to 232");
    EXPECT_EQ(wrong("name = \"a b\""),
              "dds.toml:1:8: name = \"a b\" is no name; use letters, digits, _ . and -");
    EXPECT_NE(wrong("[[command]]\nfrom = []").find("names no device"), std::string::npos);
    EXPECT_NE(wrong("[rates]\nmeasured_pc = 1").find("did you mean 'measured_cp'?"), std::string::npos);
    EXPECT_NE(wrong("[remap]\na = \"b c\"").find("is no name of a topic"), std::string::npos);
    EXPECT_NE(wrong("bridge = \"lab:x\"").find("dds.toml:1:10: bridge: "), std::string::npos);
    Config config;
    config.domain.id = 5;
    EXPECT_THROW(read_config_text("domain = 6\nservo = 3\n", "dds.toml", config), std::runtime_error);
    EXPECT_EQ(config.domain.id, 5u);
}

TEST(DdsConfig, a_servo_that_is_called_default_is_called_as_its_host) {
    EXPECT_EQ(default_name("default", "lab"), "lab");
    EXPECT_EQ(default_name("left", "lab"), "left");
    EXPECT_EQ(default_name("default", "no name"), "default");
}

TEST(DdsConfig, the_domain_of_the_environment_is_that_of_ros) {
    ::setenv("ROS_DOMAIN_ID", "42", 1);
    EXPECT_EQ(domain_of_environment(), 42u);
    for (const char* bad : {"x", "233", "-1", "4 "}) {
        ::setenv("ROS_DOMAIN_ID", bad, 1);
        EXPECT_THROW(domain_of_environment(), std::runtime_error) << bad;
    }
    ::unsetenv("ROS_DOMAIN_ID");
    EXPECT_EQ(domain_of_environment(), 0u);
}

TEST(DdsConfig, no_network_but_loopback_unless_one_is_named) {
    const std::string text = cyclone_configuration({});
    EXPECT_NE(text.find("<NetworkInterface address=\"127.0.0.1\"/>"), std::string::npos) << text;
    EXPECT_NE(text.find("<AllowMulticast>false</AllowMulticast>"), std::string::npos) << text;
    EXPECT_THROW(cyclone_configuration({.interface = "\"/><x", .peers = {}}), std::runtime_error);
}

}  // namespace
