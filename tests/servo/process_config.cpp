// The valid configurations of knurld, and the one-line error for others.

#include <fstream>

#include <gtest/gtest.h>

#include <knurl/servo/config.hpp>
#include <knurl/servo/daemon.hpp>

#include "../refusal.hpp"
#include "process_knurld.hpp"

namespace knurl::servo {
namespace {

std::string complaint(const std::string& text) {
    return test::refusal_of<ConfigError>([&] { check(parse_config(text, "lab.toml")); });
}

std::string refusal(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "knurld");
    return test::refusal_of<ConfigError>(
        [&] { parse_command_line(static_cast<int>(arguments.size()), arguments.data()); });
}

DaemonConfig told(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "knurld");
    return parse_command_line(static_cast<int>(arguments.size()), arguments.data()).config;
}

TEST(Configuration, TheNameIsAlsoTakenAsClientsSayIt) {
    const std::string device = "[[device]]\naddress = \"sim:premium15\"\n";
    EXPECT_EQ(parse_config("name = \"knurl:lab\"\n" + device, "lab.toml").name, "lab");
    EXPECT_THROW(parse_config("name = \"knurl:\"\n" + device, "lab.toml"), ConfigError);
    EXPECT_THROW(parse_config("name = \"knurl:knurl:lab\"\n" + device, "lab.toml"), ConfigError);
}

TEST(Configuration, EveryKeyOfTheFile) {
    const DaemonConfig config = parse_config(R"(
name = "lab"
rate = 2000
cpu = 1
priority = 70
idle = "poll"
spin = 60e-6
guardian_stall = 0.05
memory = 300
socket_group = "haptics"

[[device]]
name = "left"
address = "sim:premium15"
hand = "stroke.csv"
seed = 7
rate = 4000

[[device]]
name = "right"
address = "sim:cartesian3"
[device.limits]
peak_force = 2
continuous_force = 1
peak_torque = 0.1
thermal_time = 5
slew = 4000
slew_fault_time = 2e-3
speed_damping_from = 0.5
speed_fault = 1.0
power = 2
ramp_up = 1
ramp_down = 0.08
arm_speed = 0.1
workspace_margin = 1.1
)",
                                             "lab.toml");
    EXPECT_EQ(config.name, "lab");
    EXPECT_EQ(config.rate, 2000);
    EXPECT_EQ(config.cpu, 1);
    EXPECT_EQ(config.priority, 70);
    EXPECT_EQ(config.idle, Idle::poll);
    EXPECT_EQ(config.spin, 60e-6);
    EXPECT_EQ(config.guardian_stall, 0.05);
    EXPECT_EQ(config.memory, 300);
    EXPECT_EQ(config.socket_group, "haptics");
    ASSERT_EQ(config.devices.size(), 2u);
    EXPECT_EQ(config.devices[0].name, "left");
    EXPECT_EQ(config.devices[0].address, "sim:premium15");
    EXPECT_EQ(config.devices[0].hand_file, "stroke.csv");
    EXPECT_EQ(config.devices[0].seed, 7u);
    EXPECT_EQ(config.devices[0].rate, 4000);
    const SupervisorLimits& limits = config.devices[1].limits;
    EXPECT_EQ(limits.peak_force, 2);
    EXPECT_EQ(limits.continuous_force, 1);
    EXPECT_EQ(limits.peak_torque, 0.1);
    EXPECT_EQ(limits.thermal_time, 5);
    EXPECT_EQ(limits.slew, 4000);
    EXPECT_EQ(limits.slew_fault_time, 2e-3);
    EXPECT_EQ(limits.speed_damping_from, 0.5);
    EXPECT_EQ(limits.speed_fault, 1.0);
    EXPECT_EQ(limits.power, 2);
    EXPECT_EQ(limits.ramp_up, 1);
    EXPECT_EQ(limits.ramp_down, 0.08);
    EXPECT_EQ(limits.arm_speed, 0.1);
    EXPECT_EQ(limits.workspace_margin, 1.1);
    check(config);
}

TEST(Configuration, TheExampleFileIsTheDefaults) {
    const DaemonConfig example = load_config(KNURLD_EXAMPLE);
    check(example);
    const DaemonConfig defaults;
    EXPECT_EQ(example.name, defaults.name);
    EXPECT_EQ(example.rate, default_rate);
    EXPECT_EQ(example.priority, defaults.priority);
    EXPECT_EQ(example.idle, defaults.idle);
    EXPECT_EQ(example.spin, defaults.spin);
    EXPECT_EQ(example.guardian_stall, defaults.guardian_stall);
    ASSERT_EQ(example.devices.size(), 2u);
    EXPECT_EQ(example.devices[0].seed, DeviceConfig{}.seed);
    const SupervisorLimits limits = example.devices[1].limits, widest;
    EXPECT_EQ(limits.thermal_time, widest.thermal_time);
    EXPECT_EQ(limits.slew, widest.slew);
    EXPECT_EQ(limits.slew_fault_time, widest.slew_fault_time);
    EXPECT_EQ(limits.speed_damping_from, widest.speed_damping_from);
    EXPECT_EQ(limits.speed_fault, widest.speed_fault);
    EXPECT_EQ(limits.power, widest.power);
    EXPECT_EQ(limits.ramp_up, widest.ramp_up);
    EXPECT_EQ(limits.ramp_down, widest.ramp_down);
    EXPECT_EQ(limits.arm_speed, widest.arm_speed);
    EXPECT_EQ(limits.workspace_margin, widest.workspace_margin);
    const test::Home home;
    const test::Knurld knurld(home, {"--config", KNURLD_EXAMPLE});
    EXPECT_EQ(test::RawClient(home).greet().welcome.value().devices, 2u);
}

struct Mistake {
    const char* text;
    std::vector<const char*> says;  // where, what was wrong, what is allowed
};

TEST(Configuration, EachMistakeIsOneLineWithPlaceReasonAndRemedy) {
    const Mistake mistakes[] = {
        {"rat = 1000\n", {"lab.toml:1:1:", "unknown key \"rat\"", "rate"}},
        {"\nrate = \"fast\"\n", {"lab.toml:2:8:", "rate must be a number in Hz", "not a string"}},
        {"rate = 499\n", {"lab.toml:1:8:", "rate = 499 Hz", "500 to 20000 Hz"}},
        {"rate = nan\n", {"lab.toml:1:8:", "rate = nan", "500 to 20000 Hz"}},
        {"rate = true\n", {"lab.toml:1:8:", "rate must be a number in Hz", "not true or false"}},
        {"cpu = 1.5\n", {"lab.toml:1:7:", "cpu must be a whole number", "not a number"}},
        {"cpu = -1\n", {"lab.toml:1:7:", "cpu = -1", "0 to 1023"}},
        {"priority = 95\n", {"lab.toml:1:12:", "priority = 95", "0 to 94"}},
        {"spin = \"60us\"\n", {"lab.toml:1:8:", "spin must be a number in s", "not a string"}},
        {"spin = 60\n", {"lab.toml:1:8:", "spin = 60 s", "0 to 0.0002 s"}},
        {"idle = \"hot\"\n", {"lab.toml:1:8:", "idle = \"hot\"", "\"sleep\", \"poll\""}},
        {"memory = 1\n", {"lab.toml:1:10:", "memory = 1 MiB", "16 to 1.04858e+06 MiB"}},
        {"guardian_stall = 1e-3\n", {"lab.toml:1:18:", "guardian_stall = 0.001 s", "0.02 to 1 s"}},
        {"name = \"a/b\"\n", {"lab.toml:1:8:", "name = \"a/b\"", "a-z"}},
        {"name = \"..\"\n", {"lab.toml:1:8:", "does not begin with a dot"}},
        {"name = 3\n", {"lab.toml:1:8:", "name must be a string", "not a whole number"}},
        {"rate = 1000\nrate = 2000\n", {"lab.toml:2:", "rate"}},
        {"rate = \n", {"lab.toml:1:"}},
        {"[device]\naddress = \"sim:premium15\"\n",
         {"lab.toml:1:1:", "device must be an array", "[[device]]"}},
        {"[[device]]\nname = \"right\"\n", {"lab.toml:1:1:", "no address", "sim:premium15"}},
        {"[[device]]\naddress = \"sim:premium15\"\nmass = 1\n",
         {"lab.toml:3:1:", "unknown key \"device.mass\""}},
        {"[[device]]\naddress = \"s\"\nseed = -1\n", {"lab.toml:3:8:", "device.seed = -1", "0 to"}},
        {"[[device]]\naddress = \"s\"\n[device.limits]\nslew = 100\n",
         {"lab.toml:4:8:", "device.limits.slew = 100 N/s", "2000 to"}},
        {"[[device]]\naddress = \"s\"\n[device.limits]\nspeed_fault = 3\n",
         {"lab.toml:4:15:", "device.limits.speed_fault = 3 m/s", "0.05 to 1.5 m/s"}},
        {"[[device]]\naddress = \"s\"\n[device.limits]\nstall = 1\n",
         {"lab.toml:4:1:", "unknown key \"device.limits.stall\"", "slew"}},
        {"[[device]]\naddress = \"s\"\nlimits = 1\n", {"lab.toml:3:10:", "device.limits must be a table"}},
        {"", {"no device", "--device sim:premium15"}},
        {"[[device]]\nname=\"a\"\naddress=\"x\"\n[[device]]\nname=\"a\"\naddress=\"y\"\n",
         {"two devices are called \"a\""}},
        {"spin = 200e-6\nrate = 5000\n[[device]]\naddress=\"x\"\n", {"spin = 0.0002 s", "up to 0.0001 s"}},
        {"priority = 20\n[[device]]\naddress=\"x\"\n", {"priority = 20", "31 to 94"}},
    };
    for (const Mistake& mistake : mistakes) {
        const std::string line = complaint(mistake.text);
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        for (const char* part : mistake.says) {
            EXPECT_NE(line.find(part), std::string::npos)
                << mistake.text << "-> " << line << "\nlacks " << part;
        }
    }
}

TEST(Configuration, LimitsAreOnlyTightened) {
    drivers::LinkConfig link;
    link.peak_force = 8.5;
    SupervisorLimits limits;
    check_limits(limits, link, "device");
    limits.peak_force = 8.5;
    limits.continuous_force = 4;
    check_limits(limits, link, "device");
    limits.peak_force = 9;
    EXPECT_THROW(check_limits(limits, link, "device"), ConfigError);
    limits.peak_force = 3;  // below the continuous one
    EXPECT_THROW(check_limits(limits, link, "device"), ConfigError);
}

TEST(CommandLine, WinsOverTheFile) {
    const test::Home home;
    const std::string path = (home.path() / "lab.toml").string();
    std::ofstream(path)
        << "name = \"lab\"\nrate = 2000\npriority = 70\n[[device]]\naddress = \"sim:cartesian3\"\n";
    const DaemonConfig file_only = told({"--config", path.c_str()});
    EXPECT_EQ(file_only.name, "lab");
    EXPECT_EQ(file_only.rate, 2000);
    EXPECT_EQ(file_only.devices.at(0).address, "sim:cartesian3");

    const DaemonConfig both =
        told({"--rate", "4000", "--config", path.c_str(), "--device", "right=sim:premium15", "--device",
              "sim:generic6", "--hand", "h.csv", "--idle", "poll", "--spin", "1e-5"});
    EXPECT_EQ(both.name, "lab");
    EXPECT_EQ(both.rate, 4000);
    EXPECT_EQ(both.priority, 70);
    EXPECT_EQ(both.idle, Idle::poll);
    EXPECT_EQ(both.spin, 1e-5);
    ASSERT_EQ(both.devices.size(), 2u);
    EXPECT_EQ(both.devices[0].name, "right");
    EXPECT_EQ(both.devices[0].address, "sim:premium15");
    EXPECT_EQ(both.devices[1].name, "");
    EXPECT_EQ(both.devices[1].hand_file, "h.csv");
}

TEST(CommandLine, ADevicesOptionsMayHoldAnEqualsSign) {
    const DaemonConfig config =
        told({"--device", "sim:premium15,grip=0.5", "--device", "left=sim:premium15,grip=1"});
    EXPECT_EQ(config.devices[0].name, "");
    EXPECT_EQ(config.devices[0].address, "sim:premium15,grip=0.5");
    EXPECT_EQ(config.devices[1].name, "left");
    EXPECT_EQ(config.devices[1].address, "sim:premium15,grip=1");
}

TEST(CommandLine, MistakesAreOneLine) {
    const std::pair<std::vector<const char*>, const char*> mistakes[] = {
        {{}, "no device"},
        {{"--device", "sim:premium15", "--rate", "1"}, "--rate = 1 Hz; allowed: 500 to 20000 Hz"},
        {{"--device", "sim:premium15", "--rate", "fast"}, "--rate"},
        {{"--device", "a b=sim:premium15"}, "--device: name = \"a b\""},
        {{"--device", "right="}, "no address"},
        {{"--device", "sim:premium15", "--idle", "hot"}, "--idle = \"hot\""},
        {{"--device", "sim:premium15", "--frequency", "1"}, "--frequency"},
        {{"--config", "no-such-file.toml"}, "no-such-file.toml: cannot be read"},
        {{"--device", "sim:premium15", "--name", "../x"}, "--name = \"../x\""},
    };
    for (const auto& [arguments, says] : mistakes) {
        const std::string line = refusal(arguments);
        EXPECT_NE(line.find(says), std::string::npos) << line << "\nlacks " << says;
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
}

TEST(CommandLine, HelpMentionsEveryOptionKeyAndBound) {
    const test::Home home;
    test::Program help(home, KNURLD, {"--help"});
    EXPECT_EQ(help.wait(), 0);
    for (const char* word : {"--name",        "--device",       "--rate",       "--cpu",
                             "--priority",    "--idle",         "--spin",       "--hand",
                             "--config",      "--version",      "--help",       "Examples:",
                             "sim:premium15", "guardian_stall", "socket_group", "[device.limits] peak_force",
                             "slew",          "Bounds:",        "128 clients",  "1024 representations",
                             "512 KiB",       "480 bytes"}) {
        EXPECT_NE(help.output().find(word), std::string::npos) << word;
    }
    test::Program version(home, KNURLD, {"--version"});
    EXPECT_EQ(version.wait(), 0);
    EXPECT_NE(version.output().find("knurld "), std::string::npos);
}

TEST(CommandLine, ChecksAConfigurationWithoutRunningIt) {
    const test::Home home;
    const auto checked = [&](const std::vector<std::string>& arguments, int code) {
        test::Program program(home, KNURLD, arguments);
        EXPECT_EQ(program.wait(), code) << program.output();
        EXPECT_TRUE(test::files_in(home.runtime()).empty());
        return program.output();
    };
    const std::string file = (home.path() / "lab.toml").string();
    const auto write = [&](const std::string& text) { std::ofstream(file) << text; };
    write(
        "name = \"lab\"\n[[device]]\naddress = \"sim:premium15\"\nrate = 2000\n"
        "[[device]]\nname = \"left\"\naddress = \"falcon:,port=9-9\"\n");
    const std::string plan = checked({"--check-config", file}, 0);
    for (const char* part : {"knurl:lab", "premium15 (sim:premium15): 2000 Hz", "left (falcon:,port=9-9)"})
        EXPECT_NE(plan.find(part), std::string::npos) << plan;
    EXPECT_EQ(checked({"--config", file, "--check-config"}, 0), plan);
    write("nmae = \"lab\"\n");
    EXPECT_NE(checked({"--check-config", file}, 2).find("did you mean 'name'?"), std::string::npos);
    write("[[device]]\naddress = \"sim:premium15\"\n[[device]]\naddress = \"sim:premium15\"\n");
    EXPECT_NE(checked({"--check-config", file}, 2).find("two devices are called"), std::string::npos);
    write("[[device]]\naddress = \"sim:arm=/no/such/arm.toml\"\n");
    EXPECT_NE(checked({"--check-config", file}, 2).find("/no/such/arm.toml"), std::string::npos);
    write("[[device]]\naddress = \"falcon:,lowpass=3\"\n");
    EXPECT_NE(checked({"--check-config", file}, 2).find("did you mean 'low_pass'?"), std::string::npos);
    EXPECT_NE(checked({"--check-config", "/no/such.toml"}, 2).find("/no/such.toml"), std::string::npos);
    EXPECT_NE(checked({"--check-config"}, 2).find("no device"), std::string::npos);
}

TEST(CommandLine, WhatCannotStartSaysWhyAndLeavesNothingBehind) {
    const test::Home home;
    const std::pair<std::vector<std::string>, const char*> mistakes[] = {
        {{"--device", "sim:nonesuch"}, "nonesuch"},
        {{"--device", "omega:0x"}, "sim:"},
        {{"--device", "sim:premium15", "--device", "sim:premium15"}, "two devices are called \"premium15\""},
        {{"--device", "sim:premium15", "--cpu", "1000"}, "this process may use"},
        {{"--device", "sim:premium15", "--hand", "no-such.csv"}, "no-such.csv"},
    };
    for (const auto& [arguments, says] : mistakes) {
        test::Program program(home, KNURLD, arguments);
        EXPECT_NE(program.wait(), 0);
        EXPECT_NE(program.output().find(says), std::string::npos) << program.output() << "\nlacks " << says;
        EXPECT_EQ(std::count(program.output().begin(), program.output().end(), '\n'), 1) << program.output();
        EXPECT_TRUE(test::files_in(home.runtime()).empty());
        EXPECT_TRUE(test::files_in(home.state()).empty());
    }
}

}  // namespace
}  // namespace knurl::servo
