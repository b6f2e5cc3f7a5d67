// `knurl device check`: its figures against closed forms, its picture, and its message about a bad file.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <png.h>

#include <knurl/json/json.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using json = knurl::Json;

json checked(const std::string& arm) {
    const Outcome outcome = knurl({"device", "check", arm, "--json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json::parse(outcome.out);
}

/// Two links of 0.2 m in a plane on a turret, the elbow at a right angle in the middle.
constexpr const char* two_links = R"(name = "two"
source = "invented"
position_only = true
[[row]]
alpha_deg = 90
[[row]]
a = 0.2
[[row]]
a = 0.2
[[axis]]
limits = "unknown"
radians_per_count = 1e-3
effort_limit = 2
[[axis]]
limits_deg = [0, 90]
radians_per_count = 1e-4
effort_limit = 1
[[axis]]
limits_deg = [-170, -10]
radians_per_count = 1e-4
effort_limit = 0.5
[workspace]
centre_deg = [0, 45, -90]
radius = 0.05
[tip]
)";

TEST(DeviceCheck, ForceAndResolutionAreThoseOfTheLevers) {
    const Folder folder;
    const json report = checked(folder.file("two.toml", two_links));
    // At the centre the tip is 0.2828 m out, level with the shoulder. The forearm's motor has a lever of 0.2
    // m along the upper arm; the shoulder's has one of 0.2828 m straight up.
    const double reach = 0.2 * std::numbers::sqrt2;
    const json& force = report["force"];
    EXPECT_NEAR(force["weakest_at_centre"]["value"], 0.5 / 0.2, 1e-9);
    EXPECT_EQ(force["weakest_axis"], "axis 3");
    EXPECT_NEAR(std::abs(force["weakest_at_centre"]["along"][0].get<double>()), std::numbers::sqrt2 / 2,
                1e-9);
    EXPECT_NEAR(force["along_axes"][0], 0.5 / (0.2 * std::numbers::sqrt2 / 2), 1e-9)
        << "x moves no other motor";
    EXPECT_NEAR(force["along_axes"][1], 2 / reach, 1e-9);
    EXPECT_NEAR(force["along_axes"][2], std::min(1 / reach, 0.5 / (0.2 * std::numbers::sqrt2 / 2)), 1e-9);
    EXPECT_LE(force["weakest"]["value"], force["weakest_at_centre"]["value"]);
    EXPECT_NEAR(report["resolution"]["centre"], 1e-3 * reach, 1e-12) << "the turret's counts are coarse";
    EXPECT_NEAR(report["resolution"]["worst"]["value"], 1e-3 * (reach + 0.05), 1e-3 * 0.003);
}

/// The levers of the two links at the centre: the turret's straight sideways, the shoulder's straight up, the
/// elbow's along the upper arm, as the elbow is as far above the tip as it is behind it.
TEST(DeviceCheck, TheLargestForceIsGivenInEveryDirection) {
    const Folder folder;
    const json report = checked(folder.file("two.toml", two_links));
    const double reach = 0.2 * std::numbers::sqrt2, half = reach / 2;
    const json& all = report["force"]["directions"];
    ASSERT_EQ(all.size(), 162u);
    double out = 0, sideways = 0, up = 0;
    for (const json& one : all) {
        const auto u = one["along"].get<std::vector<double>>();
        EXPECT_NEAR(std::hypot(u[0], u[1], u[2]), 1, 1e-12);
        const double turret = 2 / std::abs(reach * u[1]), shoulder = 1 / std::abs(reach * u[2]),
                     elbow = 0.5 / std::abs(half * (u[0] + u[2]));
        EXPECT_NEAR(one["value"], std::min({turret, shoulder, elbow}), 1e-9) << one;
        out = std::max(out, std::abs(u[0])), sideways = std::max(sideways, std::abs(u[1]));
        up = std::max(up, std::abs(u[2]));
        EXPECT_GE(one["value"].get<double>() + 1e-9, report["force"]["weakest_at_centre"]["value"]);
    }
    EXPECT_GT(std::min({out, sideways, up}), 0.98) << "all around";
}

/// Three rotating axes that intersect at the tip, and three sliding ones: each torque belongs to one motor.
TEST(DeviceCheck, TorqueAndAngularResolutionAreThoseOfTheMotorsThatTurnIt) {
    const Folder folder;
    const std::string path = folder.file("gantry.toml", R"(name = "gantry"
source = "invented"
[[row]]
prismatic = true
alpha_deg = 90
[[row]]
prismatic = true
theta_deg = 90
alpha_deg = 90
[[row]]
prismatic = true
[[row]]
alpha_deg = 90
[[row]]
theta_deg = 90
alpha_deg = 90
[[row]]
[[axis]]
limits = [-0.3, 0.3]
metres_per_count = 1e-5
effort_limit = 5
[[axis]]
limits = [-0.3, 0.3]
metres_per_count = 1e-5
effort_limit = 6
[[axis]]
limits = [-0.3, 0.3]
metres_per_count = 1e-5
effort_limit = 7
[[axis]]
limits_deg = [-90, 90]
radians_per_count = 1e-3
effort_limit = 0.1
[[axis]]
limits_deg = [-60, 60]
radians_per_count = 3e-3
effort_limit = 0.2
[[axis]]
limits_deg = [-90, 90]
radians_per_count = 2e-3
effort_limit = 0.3
[workspace]
centre = [0, 0, 0, 0, 0, 0]
radius = 0.1
[tip]
peak_force = 5
peak_torque = 0.1
)");
    const json report = checked(path);
    auto torque = report["torque"]["about_axes"].get<std::vector<double>>();
    std::sort(torque.begin(), torque.end());
    ASSERT_EQ(torque.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(torque[i], 0.1 * static_cast<double>(i + 1), 1e-9);
    EXPECT_EQ(report["torque"]["peak"], 0.1);
    EXPECT_NEAR(report["resolution"]["angular"], 3e-3, 1e-12) << "the coarsest of the three";

    for (const char* arm : {"generic6", "generic7"}) {
        const std::string text = knurl({"device", "check", arm}).out;
        EXPECT_NE(text.find("largest torque (N m"), std::string::npos) << text;
        EXPECT_NE(text.find("mrad at the centre"), std::string::npos) << text;
    }
    EXPECT_TRUE(checked("omni")["torque"].is_null()) << "its wrist has no motors";
    EXPECT_EQ(knurl({"device", "check", "omni"}).out.find("torque (N m"), std::string::npos);
}

TEST(DeviceCheck, ReachEndsAtTheLimits) {
    const Folder folder;
    const json report = checked(folder.file("two.toml", two_links));
    // Straight out: the elbow's limit of -10 degrees leaves 2 * 0.2 cos(5 degrees) m from the shoulder.
    const double outwards = 0.4 * std::cos(5 * std::numbers::pi / 180) - 0.2 * std::numbers::sqrt2;
    EXPECT_NEAR(report["workspace"]["high"][0], outwards, 0.005);
    EXPECT_LE(report["workspace"]["ball"], outwards + 1e-3);
    EXPECT_GE(report["workspace"]["ball"], 0.05);
    EXPECT_EQ(report["workspace"]["out_of_reach"], 0);
    EXPECT_NE(report["workspace"]["ball_stop"].get<std::string>().find("axis"), std::string::npos);

    std::string wide(two_links);
    wide.replace(wide.find("radius = 0.05"), 13, "radius = 0.2 ");
    const json wider = checked(folder.file("wide.toml", wide));
    EXPECT_GT(wider["workspace"]["out_of_reach"], 0.1);
    EXPECT_NE(wider["notes"].dump().find("out of reach"), std::string::npos);
}

TEST(DeviceCheck, ConditionAndSingularPosturesAreThoseOfTheStretchedArm) {
    const Folder folder;
    std::string free(two_links);
    free.replace(free.find("[-170, -10]"), 11, "[-170, 10]");
    const json report = checked(folder.file("free.toml", free));
    const json& singular = report["condition"]["singular"];
    ASSERT_FALSE(singular.is_null());
    const auto at = singular["at"].get<std::vector<double>>();
    const double from_shoulder = std::hypot(at[0] + 0.2 * std::numbers::sqrt2, at[1], at[2]);
    EXPECT_NEAR(from_shoulder, 0.4, 0.005) << "stretched";
    EXPECT_TRUE(checked(folder.file("two.toml", two_links))["condition"]["singular"].is_null())
        << "the limits keep away from it";
    EXPECT_GE(report["condition"]["best"], 1);
    EXPECT_LE(report["condition"]["median"], report["condition"]["worst"]["value"]);
}

TEST(DeviceCheck, EveryShippedArmReachesItsWorkspace) {
    for (const char* name :
         {"premium15", "premium15_wrist", "omni", "woodenhaptics", "generic6", "generic7", "falcon"}) {
        const json report = checked(name);
        EXPECT_EQ(report["workspace"]["out_of_reach"], 0) << name;
        EXPECT_GE(report["workspace"]["ball"], report["workspace"]["radius"]) << name;
        EXPECT_LT(report["condition"]["worst"]["value"], 10) << name;
        for (const json& figure : report["figures"]) EXPECT_NE(figure["source"], "") << name;
    }
}

TEST(DeviceCheck, SaysItInWordsWithSourcesAndWhatIsAssumed) {
    const Outcome outcome = knurl({"device", "check", "omni"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    for (const char* words : {"PHANToM Omni", "URDF", "largest ball", "Jacobian's condition", "largest force",
                              "resolution", "assumed where the file says nothing", "6 sensed, 3 driven"}) {
        EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
    }
}

TEST(DeviceCheck, DrawsAPicture) {
    const Folder folder;
    const std::string path = folder.path("omni.png");
    const Outcome outcome = knurl({"device", "check", "omni", "--picture", path});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_file(&image, path.c_str()), 0) << image.message;
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
    ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << image.message;
    std::size_t coloured = 0;
    for (std::size_t i = 0; i < pixels.size(); i += 3) coloured += pixels[i] != 255 ? 1 : 0;
    EXPECT_GT(coloured, pixels.size() / 3 / 20) << "there is something to see";
    EXPECT_LT(coloured, pixels.size() / 3 * 9 / 10);

    const Outcome nowhere = knurl({"device", "check", "omni", "--picture", "/no/such/folder/omni.png"});
    EXPECT_EQ(nowhere.code, 1);
    EXPECT_NE(nowhere.err.find("/no/such/folder/omni.png: cannot be written"), std::string::npos)
        << nowhere.err;
}

TEST(DeviceCheck, ABadFileIsOneLineAndExitCodeTwo) {
    const Folder folder;
    std::string bad(two_links);
    bad.replace(bad.find("a = 0.2"), 7, "a = 200");
    const std::string path = folder.file("bad.toml", bad);
    const Outcome outcome = knurl({"device", "check", path});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err,
              "knurl device check: " + path +
                  ":7:5: a of row 2 is 200 m: links are in metres, at most 3 m; did you mean 0.2?\n");
    EXPECT_EQ(knurl({"device", "check", folder.path("none.toml")}).code, 2);
    EXPECT_NE(knurl({"device", "check", "onmi"}).err.find("no arm \"onmi\"; there are"), std::string::npos);
    EXPECT_EQ(knurl({"device"}).code, 2);
    EXPECT_EQ(knurl({"device", "check"}).code, 2);
}

}  // namespace
}  // namespace knurl::test
