// One clear line for every mistake in an arm's file, and nothing worse for any damage.

#include <filesystem>
#include <fstream>
#include <random>

#include <sys/stat.h>
#include <unistd.h>

#include "../refusal.hpp"
#include "../temp_folder.hpp"
#include "arm_example.hpp"

namespace knurl::drivers {
namespace {

using namespace arms;

std::string refusal(const std::string& text) {
    return test::refusal_of([&] { parse_arm(text, "mine.toml"); });
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
         "alpha_deg, prismatic, limits, limits_deg; did you mean 'alpha_deg'?"},
        {with("[workspace]", "[=workspace]"),
         "mine.toml:28:2: '=' stands where the name of a table should begin; write [name] or [[name]]"},
        {with("[workspace]", "[wrkspace]"),
         "mine.toml:28:1: unknown key 'wrkspace' in an arm; it takes name, description, position_only, "
         "coupling, row, axis, base, tool, workspace, tip, drive; did you mean 'workspace'?"},
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
    // Bytes changed, cut or inserted: the file is read as an arm with a tip, or refused in one line that
    // names it.
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
        EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    }
}

TEST(ArmFile, WhatIsNoSmallFileIsNotRead) {
    namespace fs = std::filesystem;
    const test::TempFolder folder;
    const std::string huge = folder.file("huge.toml", good), pipe = folder.path("pipe.toml");
    fs::resize_file(huge, 5'000'000'000);  // a sparse file: takes no space
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const auto said = [](const std::string& path) -> std::string {
        return test::refusal_of([&] { load_arm(path); });
    };
    const std::string mend = "; give an arm's TOML file";
    EXPECT_EQ(said("/dev/zero"), "/dev/zero: is a device, pipe or socket, not a file" + mend);
    EXPECT_EQ(said(pipe), pipe + ": is a device, pipe or socket, not a file" + mend)
        << "does not wait for a writer";
    EXPECT_EQ(said(folder.path()), folder.path().string() + ": is a folder" + mend);
    EXPECT_EQ(said(huge), huge + ": is larger than 1 MiB, and an arm has some 3 KiB" + mend);
    EXPECT_EQ(said(folder.path("none.toml")),
              folder.path("none.toml") + ": cannot be read: No such file or directory");
    fs::resize_file(huge, good.size());
    EXPECT_EQ(said(huge), "accepted");
}

}  // namespace
}  // namespace knurl::drivers
