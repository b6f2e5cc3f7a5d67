// Arms from files: what the shipped ones are, against closed forms and published poses; what a file says is
// what the device says; and one clear line for every mistake.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/drivers/sim_device.hpp>

namespace knurl::drivers {
namespace {

using Eigen::Vector3d;

/// A small arm without a mistake, in which tests make one.
constexpr std::string_view good = R"(name = "mine"
source = "measured"
position_only = true
coupling = [[1, 0, 0], [0, 1, 0], [0, -1, 1]]

[[row]]
alpha_deg = 90
[[row]]
a = 0.215
[[row]]
theta_deg = -90
a = 0.170

[[axis]]
name = "turret"
limits_deg = [-60, 60]
counts_per_turn = 4000
gear = 10
effort_limit = 1.5
[[axis]]
name = "upper arm"
limits_deg = [-20, 90]
radians_per_count = 1.5e-4
[[axis]]
name = "forearm"
limits = "unknown"

[workspace]
centre_deg = [0, 20, 0]
radius = 0.08
[tip]
peak_force = 8.5
friction = 0.04
friction_source = "a spring balance"
)";

/// The good arm with one piece replaced; the piece must be there.
std::string with(const std::string& piece, const std::string& other) {
    std::string text(good);
    const auto at = text.find(piece);
    if (at == std::string::npos) throw std::logic_error("the good arm has no " + piece);
    return text.replace(at, piece.size(), other);
}

std::string refusal(const std::string& text) {
    try {
        parse_arm(text, "mine.toml");
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "accepted";
}

/// Tip of a device's joints, from its mechanism.
Vector3d tip(const ArmFile& arm, const JointArray& q) {
    TipPose pose;
    Jacobian jacobian;
    EXPECT_TRUE(SerialChain(arm.table).forward(q, pose, jacobian));
    return pose.position;
}

JointArray random_joints(std::mt19937_64& engine, const JointArray& centre) {
    std::uniform_real_distribution<double> one(-1, 1);
    JointArray q = centre;
    for (double& joint : q) joint += one(engine);
    return q;
}

TEST(ShippedArms, ReadAndHaveTheirNamesAndASourceForEachFigure) {
    EXPECT_EQ(shipped_arms(), (std::vector<std::string>{"generic6", "generic7", "omni", "premium15",
                                                        "premium15_wrist", "woodenhaptics"}));
    for (const std::string& name : shipped_arms()) {
        const ArmFile arm = find_arm(name);
        EXPECT_EQ(arm.name, name);
        EXPECT_FALSE(arm.description.empty());
        EXPECT_GT(arm.figures.size(), arm.joints()) << name;
        for (const ArmFigure& figure : arm.figures) {
            EXPECT_FALSE(figure.source.empty()) << name << ": " << figure.name;
            if (!name.starts_with("generic")) {
                EXPECT_EQ(figure.source.find("invented"), std::string::npos) << name << ": " << figure.name;
            }
        }
        EXPECT_LT(tip(arm, arm.centre).norm(), 1e-15) << "the origin is the workspace's centre";
    }
}

TEST(ShippedArms, PremiumsHaveThePhantomsClosedForm) {
    // Cavusoglu et al. 2002, with x away from the base and z up.
    const auto closed = [](const JointArray& q) {
        const double out = 0.215 * std::cos(q[1]) + 0.170 * std::sin(q[2]);
        return Vector3d(std::cos(q[0]) * out, std::sin(q[0]) * out,
                        0.215 * std::sin(q[1]) - 0.170 * std::cos(q[2]));
    };
    std::mt19937_64 engine(1);
    for (const char* name : {"premium15", "premium15_wrist"}) {
        const ArmFile arm = find_arm(name);
        for (int trial = 0; trial < 300; ++trial) {
            const JointArray q = random_joints(engine, arm.centre);
            EXPECT_LT((tip(arm, q) - (closed(q) - closed(arm.centre))).norm(), 1e-15) << name;
        }
        EXPECT_EQ(link_of(arm).peak_force, 8.5);
        EXPECT_EQ(link_of(arm).continuous_force, 1.4);
    }
    const LinkConfig wrist = link_of(find_arm("premium15_wrist"));
    EXPECT_EQ(wrist.sensed_joints, 6);
    EXPECT_EQ(wrist.actuated_joints, 3);
    EXPECT_TRUE(wrist.senses_orientation);
    EXPECT_FALSE(wrist.renders_torque);
    const LinkConfig bare = link_of(find_arm("premium15"));
    EXPECT_EQ(bare.sensed_joints, 3);
    EXPECT_FALSE(bare.senses_orientation);
}

TEST(ShippedArms, OmniIsThePublishedUrdf) {
    // Its joints one after another: origin (xyz, rpy about x alone), then the turn about the axis.
    struct Urdf {
        Vector3d wrist, stylus;  // where wrist2 turns; the pen's direction
    };
    const auto urdf = [](const JointArray& q) -> Urdf {
        Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
        const auto joint = [&](const Vector3d& xyz, double about_x, const Vector3d& axis, double angle) {
            t.translate(xyz).rotate(Eigen::AngleAxisd(about_x, Vector3d::UnitX()));
            t.rotate(Eigen::AngleAxisd(angle, axis));
        };
        const double shoulder = q[1] - 0.23, elbow = q[2] - q[1] + 2.15 - std::numbers::pi / 2;
        joint({0, 0, 0.09}, 0, Vector3d::UnitZ(), q[0]);
        joint({-0.0075, 0, 0.035}, 0.23, Vector3d::UnitX(), shoulder);
        joint({0.0075, 0.134, 0}, -2.15, Vector3d::UnitX(), elbow);
        joint({0, 0.08, 0}, 0, Vector3d::UnitY(), q[3]);
        joint({0, 0.0525, 0}, -0.85, Vector3d::UnitX(), q[4] + 0.85);
        return {t.translation(), t.linear() * Vector3d::UnitY()};
    };
    // The URDF's y points away from the base; the file's x does.
    const Eigen::Matrix3d turned =
        Eigen::AngleAxisd(-std::numbers::pi / 2, Vector3d::UnitZ()).toRotationMatrix();
    const ArmFile omni = find_arm("omni");
    std::mt19937_64 engine(2);
    for (int trial = 0; trial < 300; ++trial) {
        const JointArray q = random_joints(engine, omni.centre);
        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(SerialChain(omni.table).forward(q, pose, jacobian));
        EXPECT_LT((pose.position - turned * (urdf(q).wrist - urdf(omni.centre).wrist)).norm(), 1e-15);
        EXPECT_LT((pose.orientation * Vector3d::UnitZ() - turned * urdf(q).stylus).norm(), 1e-15);
    }
    // Counts of the protocol at the links of the URDF are the data sheet's 450 dpi.
    EXPECT_NEAR(link_of(omni).radians_per_count[1] * 0.134, 25.4e-3 / 450, 0.5e-6);
    EXPECT_NEAR(omni.axes[1].limits.least, 0.23 - 0.24, 1e-12);
    EXPECT_NEAR(omni.axes[4].limits.least, -2.07 - 0.85, 1e-12);
    EXPECT_NEAR(omni.axes[4].limits.greatest, 0.23 - 0.85, 1e-12);
    EXPECT_NEAR(omni.row_limits[2].least, -0.2 - 2.15 + std::numbers::pi / 2, 1e-3);
    EXPECT_NEAR(omni.row_limits[2].greatest, 1.95 - 2.15 + std::numbers::pi / 2, 1e-3);
}

TEST(ShippedArms, WoodenHapticsHasItsClosedForm) {
    const auto closed = [](const JointArray& q) {
        const double out = 0.205 * std::sin(q[1]) + 0.245 * std::sin(q[2]);
        return Vector3d(std::cos(q[0]) * out, std::sin(q[0]) * out,
                        0.080 + 0.205 * std::cos(q[1]) - 0.245 * std::cos(q[2]));
    };
    const ArmFile arm = find_arm("woodenhaptics");
    EXPECT_LT((closed(arm.centre) - Vector3d(0.220, 0, 0.080)).norm(), 1e-4)
        << "the centre that its code states";
    std::mt19937_64 engine(3);
    for (int trial = 0; trial < 300; ++trial) {
        const JointArray q = random_joints(engine, arm.centre);
        EXPECT_LT((tip(arm, q) - (closed(q) - closed(arm.centre))).norm(), 1e-15);
    }
    const LinkConfig link = link_of(arm);
    EXPECT_NEAR(link.radians_per_count[0], 2 * std::numbers::pi / 2000 / (0.160 / 0.010), 1e-18);
    EXPECT_NEAR(link.effort_limit[1], 0.0259 * 3 * (0.120 / 0.010), 1e-12);
    EXPECT_NEAR(*arm.axes[2].effort_per_count, 0.0259 * 1e-3 * 12, 1e-15);
    EXPECT_TRUE(link.has_watchdog);
}

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
    const ArmFile plain = parse_arm(good, "mine.toml");
    const ArmFile turned = parse_arm(std::string(good) + "[base]\nrpy_deg = [180, 0, 0]\n", "mine.toml");
    const JointArray q = {0.1, 0.5, 0.2};
    const Vector3d upright = tip(plain, q), hanging = tip(turned, q);
    EXPECT_LT((hanging - Vector3d(upright.x(), -upright.y(), -upright.z())).norm(), 1e-15);
    const ArmFile longer = parse_arm(std::string(good) + "[tool]\nposition = [0.03, 0, 0]\n", "mine.toml");
    const ArmFile same = parse_arm(with("a = 0.170", "a = 0.2"), "mine.toml");
    EXPECT_LT((tip(longer, q) - tip(same, q)).norm(), 1e-15);
}

TEST(ArmFile, SaysWhatIsWrongWhereAndWhatToDo) {
    const struct {
        std::string text;
        std::string expected;
    } cases[] = {
        {std::string(good), "accepted"},
        {with("a = 0.215", "a = 215"),
         "mine.toml:9:5: a of row 2 is 215 m: links are in metres, at most 3 m; did you mean 0.215?"},
        {with("a = 0.215", "a = nan"), "mine.toml:9:5: a of row 2 is nan; it must be finite"},
        {with("a = 0.215", "a = \"0.215\""), "mine.toml:9:5: a of row 2 must be a number, not a string"},
        {with("alpha_deg = 90", "alpha = 90"),
         "mine.toml:7:9: alpha of row 1 is 90 rad: angles are in radians; did you mean alpha_deg, in "
         "degrees?"},
        {with("alpha_deg = 90", "alpha_deg = 1.5708"),
         "mine.toml:7:13: alpha_deg of row 1 is 1.5708 degrees: that is 90 degrees in radians; did you mean "
         "90?"},
        {with("alpha_deg = 90", "alpha = 0\nalpha_deg = 90"),
         "mine.toml:8:13: row 1 has both alpha and alpha_deg; keep one"},
        {with("alpha_deg = 90", "alhpa_deg = 90"),
         "mine.toml:7:13: unknown key 'alhpa_deg' in row 1; it takes theta, theta_deg, d, a, alpha, "
         "alpha_deg, prismatic, limits, limits_deg"},
        {with("[workspace]", "[wrkspace]"),
         "mine.toml:28:1: unknown key 'wrkspace' in an arm; it takes name, description, position_only, "
         "coupling, row, axis, base, tool, workspace, tip, drive"},
        {with("friction_source", "frcition_source"),
         "mine.toml:34:19: frcition_source in [tip] is the source of a figure that is not known there"},
        {with("limits_deg = [-60, 60]", "limits_deg = [60, -60]"),
         "mine.toml:16:14: limits_deg of axis 1 are the wrong way round: 60 is not less than -60"},
        {with("limits_deg = [-60, 60]\n", ""),
         "mine.toml:14:1: axis 1 (turret) has no limits; write limits_deg = [-60, 60], or limits = "
         "\"unknown\" if "
         "nobody knows them"},
        {with("limits_deg = [-60, 60]", "limits_deg = [-60]"),
         "mine.toml:16:14: limits_deg of axis 1 must be a list of 2 numbers in degrees, not a list of 1"},
        {with("limits_deg = [-60, 60]", "limits = [-60, 60]"),
         "mine.toml:16:11: number 1 of limits of axis 1 is -60 rad: angles are in radians; did you mean "
         "limits_deg, in degrees?"},
        {with("limits = \"unknown\"", "limits = \"none\""),
         "mine.toml:26:10: limits of axis 3 is a string; write two numbers, or \"unknown\" if nobody knows "
         "them"},
        {with("[0, -1, 1]]", "[0, 1, 0]]"),
         "mine.toml:4:12: coupling is singular (determinant 0, condition inf): some motion of the rows "
         "belongs to "
         "no axis; no row of it may be a sum of others"},
        {with("[0, -1, 1]]", "[0, -1]]"),
         "mine.toml:4:35: row 3 of coupling has 2 columns; coupling must be 3 rows of 3 numbers"},
        {with(", [0, -1, 1]]", "]"),
         "mine.toml:4:12: coupling must be 3 rows of 3 numbers, one row per [[row]], one column per "
         "[[axis]]; it "
         "has 2 rows"},
        {with("[[axis]]\nname = \"forearm\"\nlimits = \"unknown\"\n", ""),
         "mine.toml:20:1: 2 axes for 3 rows; give one [[axis]] for each [[row]], passive ones too"},
        {with("centre_deg = [0, 20, 0]", "centre_deg = [0, 20]"),
         "mine.toml:29:14: centre_deg of [workspace] must be a list of 3 numbers in degrees, not a list of "
         "2"},
        {with("centre_deg = [0, 20, 0]", "centre_deg = [0, 100, 0]"),
         "mine.toml:29:14: the workspace's centre is outside of the limits of axis 2: 1.74533 is not from "
         "-0.349066 to 1.5708 rad (m)"},
        {with("radius = 0.08", "radius = 80"),
         "mine.toml:30:10: radius of [workspace] is 80 m; give more than 0, at most 3 m"},
        {with("radius = 0.08\n", ""),
         "mine.toml:28:1: [workspace] has no radius; write the radius in m of a ball that the tip reaches"},
        {with("peak_force = 8.5\n", ""),
         "mine.toml:14:1: axis 2 has no effort_limit and [tip] no peak_force; one of them is needed, since "
         "nothing "
         "else bounds the motor"},
        {with("peak_force = 8.5", "peak_force = -8.5"),
         "mine.toml:32:14: peak_force of [tip] is -8.5 N; give more than 0, at most 1000 N"},
        {with("source = \"measured\"\n", ""),
         "mine.toml:6:13: alpha_deg of row 1 has no source; write source = \"...\" at the top of the file, "
         "in the "
         "table, or alpha_source (a paper, a data sheet, \"measured\", \"invented\")"},
        {with("gear = 10", "gear = 0"),
         "mine.toml:18:8: gear of axis 1 is 0 turns of the encoder a turn of the axis; give 0.001 to 10000 "
         "turns "
         "of the encoder a turn of the axis"},
        {with("counts_per_turn = 4000\n", ""),
         "mine.toml:17:8: gear of axis 1 is that of counts_per_turn, which is missing"},
        {with("gear = 10", "radians_per_count = 1e-4"),
         "mine.toml:17:19: axis 1 has both counts_per_turn and radians_per_count; keep one"},
        {with("effort_limit = 1.5", "effort_limit = 1.5\npassive = true"),
         "mine.toml:19:16: axis 1 is passive and has no effort; remove this, or passive"},
        {with("gear = 10\neffort_limit = 1.5", "gear = 10\npassive = true"),
         "mine.toml:20:1: axis 2 is driven and comes after a passive one; name the driven ones first"},
        {with("name = \"mine\"", "name = \"my arm\""),
         "mine.toml:1:8: name is \"my arm\"; use letters, digits, _ and -"},
    };
    for (const auto& [text, expected] : cases) {
        EXPECT_EQ(refusal(text), expected) << text;
    }
    std::string many(good);
    for (int i = 0; i < 6; ++i) many = many.replace(many.find("[[row]]"), 0, "[[row]]\n");
    EXPECT_EQ(refusal(many), "mine.toml:16:1: 9 rows; an arm has at most 8 joints");
    EXPECT_NE(refusal("name = ").find("mine.toml:1:"), std::string::npos) << "TOML's own errors too";
    EXPECT_NE(refusal("").find("no name; write name = \"my_arm\" at the top"), std::string::npos);
    EXPECT_NE(refusal("name = \"a\"\nsource = \"b\"\n").find("no [[row]]"), std::string::npos);
    EXPECT_NE(refusal("name = \"a\"\nsource = \"b\"\n[row]\n").find("write [[row]]"), std::string::npos);
}

TEST(ArmFile, AFileThatIsDamagedIsRefusedAndNeverMore) {
    // Every shipped file with a byte changed, cut or doubled: read or refused in one line that names it.
    constexpr std::uint64_t seed = 5;
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 engine(seed);
    constexpr std::string_view letters = "0123456789.-=[]\"\n abez";
    for (int trial = 0; trial < 3'000; ++trial) {
        std::string text(good);
        for (int change = 0; change < 1 + trial % 3; ++change) {
            const std::size_t at = engine() % text.size();
            switch (engine() % 3) {
                case 0:
                    text[at] = letters[engine() % letters.size()];
                    break;
                case 1:
                    text.erase(at, 1 + engine() % 5);
                    break;
                default:
                    text.insert(at, 1, letters[engine() % letters.size()]);
            }
        }
        const std::string said = refusal(text);
        if (said == "accepted") {
            const ArmFile arm = parse_arm(text, "mine.toml");
            EXPECT_TRUE(tip(arm, arm.centre).allFinite());
            continue;
        }
        EXPECT_TRUE(said.starts_with("mine.toml:")) << said << "\n" << text;
    }
}

TEST(FindArm, LooksInsideFirstThenInFoldersAndTakesPaths) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("knurl-arms-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    for (const char* name : {"mine", "omni"}) std::ofstream(folder / (std::string(name) + ".toml")) << good;
    setenv("KNURL_ARMS_DIR", folder.c_str(), 1);
    EXPECT_EQ(find_arm("mine").name, "mine");
    EXPECT_EQ(find_arm("omni").name, "omni") << "what is built in comes first";
    EXPECT_EQ(find_arm((folder / "omni.toml").string()).name, "mine");
    unsetenv("KNURL_ARMS_DIR");
    std::filesystem::remove_all(folder);
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
    const std::string path =
        (std::filesystem::temp_directory_path() / ("knurl-arm-" + std::to_string(getpid()) + ".toml"))
            .string();
    std::ofstream(path) << good;
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
