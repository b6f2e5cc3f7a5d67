// `knurl eval` as a program: its cycles, its devices, and its messages about bad input.

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "eval_table.hpp"

namespace knurl::test {
namespace {

TEST(EvalCycles, AreAtIOverTheRateWithBothEndsOfTheMotion) {
    for (const auto& [rate, hertz] :
         {std::pair("500", 500.), {"1000", 1000.}, {"3000", 3000.}, {"20000", 20000.}}) {
        const auto rows = eval("", rest_at(0, 0.3), {"--rate", rate}).rows;
        ASSERT_EQ(rows.size(), static_cast<std::size_t>(std::lround(0.3 * hertz)) + 1) << rate;
        for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].t, static_cast<double>(i) / hertz);
    }
}

TEST(EvalCycles, ThoseOfAMotionThatStartsLaterAreThoseWithinItsSpan) {
    const auto rows =
        eval("[[constant_force]]\nforce = [1, 0, 0]\n[[constant_force]]\nat = 2.4\nforce = [0, 1, 0]\n",
             "2.0005,1,0,0\n2.5,2,0,0\n")
            .rows;
    ASSERT_EQ(rows.size(), 500u);
    EXPECT_EQ(rows.front().t, 2.001);
    EXPECT_EQ(rows.back().t, 2.5);
    EXPECT_EQ(rows.front().f[0], 1) << "there from the start";
    EXPECT_EQ(rows[398].f[1], 0);
    EXPECT_GT(rows[399].f[1], 0) << "at 2.4 s";
}

TEST(EvalCycles, AMotionOfOneRowIsOneCycle) {
    const auto rows = eval("[[plane]]\nstiffness = 10\n", "0,0,0,-0.1\n").rows;
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_NEAR(rows[0].f[2], 1, 1e-15);
}

TEST(EvalOutput, SurvivesAsDoubles) {
    // 1/3 has no short decimal: the output must be exactly the double of the motion's row.
    const auto result = eval("", "0,0.33333333333333331,0,0\n0.001,0.1,0,0\n");
    EXPECT_EQ(result.rows.front().x[0], 1. / 3);
    EXPECT_EQ(result.rows.back().x[0], 0.1);
}

TEST(EvalOutput, IsTheSameToTheLastBitEachTime) {
    const std::string scene = "[[plane]]\nstiffness = 1500\ndamping = 1\nnormal = [0.1, 0.2, 1]\n";
    const std::string motion = "0,0,0,0.01\n0.5,0.02,0.01,-0.02\n1,0,0.01,0.01\n";
    EXPECT_EQ(eval(scene, motion).csv, eval(scene, motion).csv);
    const std::vector<std::string> device = {"--device", "sim:premium15"};
    EXPECT_EQ(eval(scene, motion, device).csv, eval(scene, motion, device).csv);
}

TEST(EvalDevice, TheMotionIsWhereTheHandWantsToGoAndThePlaneStopsIt) {
    const auto result = eval("[[plane]]\nstiffness = 1000\n", "0,0,0,0.01\n0.5,0,0,-0.02\n2,0,0,-0.02\n",
                             {"--device", "sim:premium15"});
    const Row& last = result.rows.back();
    EXPECT_LT(last.x[2], -1e-4) << "the hand presses";
    EXPECT_GT(last.x[2], -0.008) << "and is stopped well before where it wants to be";
    EXPECT_NEAR(last.f[2], -1000 * last.x[2], 1e-9) << "the scene's force, before the supervisor";
    EXPECT_EQ(result.remarks, "");
}

TEST(EvalDevice, ItsLimitsApplyAndAreTold) {
    const auto result = eval("[[plane]]\nid = 'wall'\nstiffness = inf\n", "0,0,0,0.01\n0.5,0,0,-0.02\n",
                             {"--device", "sim:premium15"});
    EXPECT_NE(result.remarks.find("S.toml:1: plane 'wall': "), std::string::npos) << result.remarks;
    double stiffest = 0;
    for (const Row& row : result.rows) {
        if (row.x[2] < -1e-5) stiffest = std::max(stiffest, row.f[2] / -row.x[2]);
    }
    EXPECT_GT(stiffest, 500);
    EXPECT_LT(stiffest, 10'000);
}

TEST(EvalDevice, WhatTheHandFeelsInAllIsBoundedAndTold) {
    // Five fingers of 1000 N/m on a device with a limit of 3105: none is scaled alone, together all are.
    std::string scene;
    for (int finger = 0; finger < 5; ++finger) scene += "[[probe]]\noffset = [0, 0, 0]\n";
    for (int finger = 0; finger < 5; ++finger)
        scene += "[[plane]]\nid = 'desk " + std::to_string(finger) + "'\nprobe = " + std::to_string(finger) +
                 "\nstiffness = 1000\n";
    const auto result =
        eval(scene, "0,0,0,0.01\n0.5,0,0,-0.02\n2,0,0,-0.02\n", {"--device", "sim:premium15"});
    EXPECT_NE(result.remarks.find("scaled down at times: the forces of surfaces to 0.6"), std::string::npos)
        << result.remarks;
    for (int finger = 0; finger < 5; ++finger)
        EXPECT_NE(result.remarks.find("plane 'desk " + std::to_string(finger) + "'"), std::string::npos);
    const Row& last = result.rows.back();
    const double stiffness = last.f[2] / -last.x[2];
    EXPECT_LT(stiffness, 3200);
    EXPECT_GT(stiffness, 3000) << "no more is taken away than must be";
}

struct RefusedScene {
    const char* name;
    const char* scene;
    const char* motion;
    std::vector<std::string> more;
    const char* says;
};
void PrintTo(const RefusedScene& refusal, std::ostream* out) {
    *out << refusal.name;
}
class EvalRefusals : public testing::TestWithParam<RefusedScene> {};

TEST_P(EvalRefusals, AreOneLineAndLeaveNoFile) {
    const Folder folder;
    std::vector<std::string> words = {"eval",
                                      "--scene",
                                      folder.file("S.toml", GetParam().scene),
                                      "--motion",
                                      folder.file("M.csv", GetParam().motion),
                                      "--out",
                                      folder.path("F.csv")};
    words.insert(words.end(), GetParam().more.begin(), GetParam().more.end());
    const Outcome outcome = knurl(words);
    EXPECT_NE(outcome.code, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.err.find("knurl eval: "), 0u) << outcome.err;
    EXPECT_NE(outcome.err.find(GetParam().says), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path("F.csv")));
}

const char* const a_motion = "t,x,y,z\n0,0,0,0\n1,0,0,0\n";
INSTANTIATE_TEST_SUITE_P(
    All, EvalRefusals,
    testing::Values(RefusedScene{"SceneKey", "[[plane]]\nstifness = 3\n", a_motion, {}, "S.toml:2:1: "},
                    RefusedScene{"SceneRange", "[[plane]]\nstiffness = -3\n", a_motion, {}, "S.toml:2:13: "},
                    RefusedScene{"SceneToml", "[[plane\n", a_motion, {}, "S.toml:1:8: "},
                    RefusedScene{"RateTooLow", "", a_motion, {"--rate", "499"}, "500 to 20000 Hz"},
                    RefusedScene{"RateTooHigh", "", a_motion, {"--rate", "20001"}, "500 to 20000 Hz"},
                    RefusedScene{"RateIsNoNumber", "", a_motion, {"--rate", "fast"}, "fast"},
                    RefusedScene{"RateIsNan", "", a_motion, {"--rate", "nan"}, "nan is no number"},
                    RefusedScene{"MotionNumber", "", "t,x,y,z\n0,0,0,zero\n", {}, "M.csv:2: "},
                    RefusedScene{"MotionNan", "", "t,x,y,z\n0,0,0,nan\n", {}, "M.csv:2: "},
                    RefusedScene{"MotionColumns", "", "t,x,y\n0,0,0\n", {}, "M.csv:1: "},
                    RefusedScene{"MotionOrder", "", "0,0,0,0\n0,0,0,0\n", {}, "M.csv:2: "},
                    RefusedScene{"MotionEmpty", "", "", {}, "M.csv"},
                    RefusedScene{"NoCycle", "", "0.0001,0,0,0\n0.0009,0,0,0\n", {}, "no cycle"},
                    RefusedScene{"UnknownProfile", "", a_motion, {"--device", "sim:premium16"}, "premium15"},
                    RefusedScene{"NoSimulation", "", a_motion, {"--device", "usb:1"}, "sim:PROFILE"},
                    RefusedScene{"UnknownOption", "", a_motion, {"--speed", "3"}, "--speed"}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(EvalRefusal, FilesThatAreNotThereAreNamed) {
    const Folder folder;
    const std::string scene = folder.file("S.toml", ""), motion = folder.file("M.csv", a_motion);
    EXPECT_NE(
        knurl({"eval", "--scene", "/no/S.toml", "--motion", motion, "--out", "-"}).err.find("/no/S.toml"),
        std::string::npos);
    EXPECT_NE(knurl({"eval", "--scene", scene, "--motion", "/no/M.csv", "--out", "-"}).err.find("/no/M.csv"),
              std::string::npos);
    const Outcome out = knurl({"eval", "--scene", scene, "--motion", motion, "--out", "/no/F.csv"});
    EXPECT_EQ(out.code, 1);
    EXPECT_NE(out.err.find("/no/F.csv: cannot be written"), std::string::npos) << out.err;
    EXPECT_NE(knurl({"eval", "--scene", scene}).err.find("--motion is required"), std::string::npos);
}

}  // namespace
}  // namespace knurl::test
