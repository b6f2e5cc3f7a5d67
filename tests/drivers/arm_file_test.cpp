// Arms from files: the device has what the file says; the search for files; and every arm simulated.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <knurl/drivers/sim_device.hpp>

#include "../temp_folder.hpp"
#include "arm_example.hpp"

namespace knurl::drivers {
namespace {

using namespace arms;
using Eigen::Vector3d;

TEST(ArmFile, WhatItSaysIsWhatTheDeviceSays) {
    const ArmFile arm = parse_arm(good, "mine.toml");
    ASSERT_EQ(arm.joints(), 3U);
    const LinkConfig link = link_of(arm);
    EXPECT_EQ(link.name, "mine");
    EXPECT_NEAR(link.radians_per_count[0], 2 * std::numbers::pi / 40000, 1e-18);
    EXPECT_EQ(link.radians_per_count[1], 1.5e-4);
    EXPECT_EQ(link.radians_per_count[2], 0) << "not known";
    EXPECT_EQ(link.effort_limit[0], 1.5);
    EXPECT_NEAR(link.effort_limit[2], 8.5 * 0.170, 1e-6) << "peak force at the longest lever";
    EXPECT_EQ(link.damping, 0) << "not known";
    EXPECT_NEAR(arm.axes[0].limits.greatest, std::numbers::pi / 3, 1e-15);
    EXPECT_FALSE(arm.axes[2].limits.known());

    std::vector<std::string> assumed;
    const SimProfile profile = sim_profile_of(arm, &assumed);
    EXPECT_EQ(profile.coulomb, 0.04);
    EXPECT_EQ(profile.damping, SimProfile{}.damping);
    const auto lists = [&](const std::string& word) {
        return std::any_of(assumed.begin(), assumed.end(),
                           [&](const std::string& line) { return line.find(word) != std::string::npos; });
    };
    for (const char* word :
         {"mass", "damping", "bandwidth", "forearm: no limits", "resolution", "continuous force"}) {
        EXPECT_TRUE(lists(word)) << word;
    }
    EXPECT_FALSE(lists("friction"));

    const auto found = std::find_if(arm.figures.begin(), arm.figures.end(), [](const ArmFigure& figure) {
        return figure.name == "friction of [tip]";
    });
    ASSERT_NE(found, arm.figures.end());
    EXPECT_EQ(found->source, "a spring balance");
    EXPECT_EQ(found->value, "0.04 N");
}

TEST(ArmFile, TheExampleOfTheReadmeIsRead) {
    std::ifstream file(KNURL_DRIVERS_README);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    const std::string fence = "```toml\n";
    const auto begin = text.find(fence) + fence.size();
    const ArmFile arm = parse_arm(text.substr(begin, text.find("```", begin) - begin), "README.md");
    EXPECT_EQ(arm.name, "mine");
    EXPECT_EQ(arm.axes[0].effort_per_count, 4e-4);
}

TEST(ArmFile, DegreesAndRadiansAreTheSameArm) {
    const ArmFile degrees = parse_arm(good, "mine.toml");
    const ArmFile radians = parse_arm(with("alpha_deg = 90", "alpha = 1.5707963267948966"), "mine.toml");
    EXPECT_EQ(degrees.table.rows[0].alpha, radians.table.rows[0].alpha);
}

TEST(ArmFile, ABaseTurnsTheArmAndAToolMovesItsTip) {
    const auto followed_by = [](const char* more) {
        std::string text(good);
        text += more;
        return text;
    };
    const ArmFile plain = parse_arm(good, "mine.toml");
    const ArmFile turned = parse_arm(followed_by("[base]\nrpy_deg = [180, 0, 0]\n"), "mine.toml");
    const JointArray q = {0.1, 0.5, 0.2};
    const Vector3d upright = tip(plain, q), hanging = tip(turned, q);
    EXPECT_LT((hanging - Vector3d(upright.x(), -upright.y(), -upright.z())).norm(), 1e-15);
    const ArmFile longer = parse_arm(followed_by("[tool]\nposition = [0.03, 0, 0]\n"), "mine.toml");
    const ArmFile same = parse_arm(with("a = 0.170", "a = 0.2"), "mine.toml");
    EXPECT_LT((tip(longer, q) - tip(same, q)).norm(), 1e-15);
}

TEST(FindArm, LooksInsideFirstThenInFoldersAndTakesPaths) {
    const test::TempFolder folder;
    for (const char* name : {"mine.toml", "omni.toml"}) folder.file(name, good);
    setenv("KNURL_ARMS_DIR", folder.path().c_str(), 1);
    EXPECT_EQ(find_arm("mine").name, "mine");
    EXPECT_EQ(find_arm("omni").name, "omni") << "what is built in comes first";
    EXPECT_EQ(find_arm((folder / "omni.toml").string()).name, "mine");
    unsetenv("KNURL_ARMS_DIR");
    try {
        find_arm("onmi");
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("no arm \"onmi\"; there are generic6, generic7, omni"),
                  std::string::npos)
            << error.what();
    }
    try {
        find_arm("nowhere.toml");
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "nowhere.toml: cannot be read: No such file or directory");
    }
}

TEST(SimulatedArm, AnyFileIsADevice) {
    const test::TempFolder folder;
    const std::string path = folder.file("arm.toml", good);
    const auto device = open_device("sim:arm=" + path + ",grip=0.5,quantum=0");
    EXPECT_EQ(device->link().name, "mine");
    EXPECT_EQ(device->link().grip_damping, 1.5);
    EXPECT_EQ(device->link().radians_per_count[0], 0);
    EXPECT_EQ(open_device("sim:arm=" + path)->link().effort_limit[0], 1.5);
    EXPECT_NEAR(open_device("sim:arm=" + path + ",limit=4.25")->link().effort_limit[0], 0.75, 1e-15);
    std::filesystem::remove(path);
    EXPECT_THROW(open_device("sim:arm=" + path), std::runtime_error);
}

TEST(SimulatedArm, PassiveAxesAreSensedAndNeverDriven) {
    SimDevice device(sim_profile("omni,grip=0"));
    EXPECT_EQ(device.link().sensed_joints, 6);
    EXPECT_EQ(device.link().actuated_joints, 3);
    EXPECT_EQ(device.link().effort_limit.size(), 3U);
    EXPECT_TRUE(device.link().senses_orientation);
    EXPECT_FALSE(device.link().renders_torque);
    JointSample sample;
    device.read(0, sample);
    for (Nanoseconds now = 1'000'000; now < 200'000'000; now += 1'000'000) {
        device.write(now, {0.3, 0, 0, 5, 5, 5});
        device.read(now, sample);
    }
    for (std::size_t i = 3; i < 6; ++i) EXPECT_EQ(device.state().efforts[i], 0);
    EXPECT_NE(sample.position[0], 0);
}

}  // namespace
}  // namespace knurl::drivers
