// knurl-surface as a person runs it: beside a servo of its own, with a small model so that it takes seconds.

#include <cmath>
#include <cstdlib>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/json/json.hpp>

#include "program.hpp"

namespace {

using knurl::test::Background;
using knurl::test::Folder;
using knurl::test::run;
using testing::HasSubstr;

class SurfaceProgram : public testing::Test {
  protected:
    void SetUp() override {
        ::setenv("KNURL_RUNTIME_DIR", folder_.path("").c_str(), 1);
        ::setenv("KNURL_STATE_DIR", folder_.path("").c_str(), 1);
        std::ostringstream pgm;  // one broad hill: 40 x 20 mm, 10 mm high
        pgm << "P2 80 40 10000\n";
        for (int r = 0; r < 40; ++r)
            for (int c = 0; c < 80; ++c)
                pgm << std::lround(10000 * std::pow(std::sin(M_PI * c / 79) * std::sin(M_PI * r / 39), 2))
                    << '\n';
        model_ = folder_.file("hill.pgm", pgm.str());
        stroke_ = folder_.path("stroke.csv");
        ASSERT_EQ(run({KNURL_SURFACE_PROGRAM, model_, "--write-stroke", stroke_}).code, 0);
    }

    std::vector<std::string> servo() const {
        return {KNURLD_PROGRAM, "--device", "sim:premium15", "--hand", stroke_};
    }

    const Folder folder_;
    std::string model_, stroke_;
};

TEST_F(SurfaceProgram, StrokesOncePerWayAndSaysHowItWent) {
    Background knurld(servo());  // in whichever order the two start
    const auto outcome = run({KNURL_SURFACE_PROGRAM, model_, "--wait", "30", "--ways", "force,knurl",
                              "--json", folder_.path("out.json"), "--csv", folder_.path("out.csv"),
                              "--relief", folder_.path("relief.asc")});
    ASSERT_EQ(outcome.code, 0) << outcome.err << knurld.said();
    EXPECT_THAT(outcome.out, HasSubstr("hill.pgm: 0.5 mm per cell"));
    // What scripts/demo ends with.
    const auto drawn = run({KNURL_PLOT_SURFACE, folder_.path("out.json"), folder_.path("out.csv"),
                            folder_.path("relief.asc"), folder_.path("picture.png")});
    EXPECT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_EQ(knurl::test::text_of_file(folder_.path("picture.png")).substr(0, 4), "\x89PNG");
    const auto json = knurl::Json::parse(knurl::test::text_of_file(folder_.path("out.json")));
    ASSERT_EQ(json.at("strokes").size(), 2u);
    for (const auto& stroke : json.at("strokes")) {
        EXPECT_EQ(stroke.at("missed"), 0) << stroke;
        EXPECT_GT(stroke.at("updates"), 5) << stroke;
    }
    // Forces from a slow application cannot render a stiff surface. What the servo does about it is a result
    // too.
    EXPECT_FALSE(json.at("strokes").at(0).at("stable"));
    // The second stroke was made even if the first one faulted the device.
    EXPECT_GT(json.at("strokes").at(1).at("cycles"), 1000);
    EXPECT_GT(json.at("strokes").at(1).at("mean_force"), 0.5);
    EXPECT_EQ(knurld.end(SIGTERM), 0);
}

TEST_F(SurfaceProgram, AHandThatDoesNotStrokeIsNoVerdictAndExitCode1) {
    const Background knurld({KNURLD_PROGRAM, "--device", "sim:premium15"});  // forgotten: --hand
    const auto outcome = run({KNURL_SURFACE_PROGRAM, model_, "--wait", "30", "--ways", "knurl", "--json",
                              folder_.path("out.json")});
    EXPECT_EQ(outcome.code, 1) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("no verdict: the hand "));
    EXPECT_THAT(outcome.out, HasSubstr("knurld --hand"));
    const auto json = knurl::Json::parse(knurl::test::text_of_file(folder_.path("out.json")));
    EXPECT_TRUE(json.at("strokes").at(0).at("stable").is_null());
}

TEST_F(SurfaceProgram, EachIsJudgedAgainstWhatItSentToo) {
    Background knurld(servo());
    const auto outcome = run({KNURL_SURFACE_PROGRAM, model_, "--wait", "30", "--ways", "planes,field",
                              "--json", folder_.path("out.json"), "--csv", folder_.path("out.csv")});
    ASSERT_EQ(outcome.code, 0) << outcome.err << knurld.said();
    EXPECT_THAT(outcome.out, HasSubstr("as a height field"));
    const auto json = knurl::Json::parse(knurl::test::text_of_file(folder_.path("out.json")));
    ASSERT_EQ(json.at("strokes").size(), 2u);
    for (const auto& stroke : json.at("strokes")) {
        ASSERT_TRUE(stroke.at("own_force_error").is_number()) << stroke;
        // The servo renders what was sent, however wrong that is.
        EXPECT_LT(stroke.at("own_force_error"), stroke.at("force_error")) << stroke;
    }
    // A model that is sent once never fades and is never late, unless the machine stood still for seconds.
    const auto& whole = json.at("strokes").at(1);
    if (whole.at("stalls") == 0 && whole.at("missed") == 0) {
        EXPECT_LT(whole.at("own_force_error"), 1e-6) << whole;
    }
    EXPECT_THAT(knurl::test::text_of_file(folder_.path("out.csv")), HasSubstr("sent_fx"));
    EXPECT_EQ(knurld.end(SIGTERM), 0);
}

TEST_F(SurfaceProgram, AnInterruptReleasesTheDeviceAndSaysWhatWasSeen) {
    Background knurld(servo());
    ASSERT_TRUE(knurld.says("ready"));
    Background surface({KNURL_SURFACE_PROGRAM, model_, "--ways", "knurl"});
    ASSERT_TRUE(surface.says("planes at 20 Hz"));
    EXPECT_EQ(surface.end(SIGINT), 130);
    EXPECT_THAT(surface.said(), HasSubstr("interrupted"));
    // The device is free: another program may claim it.
    EXPECT_EQ(run({KNURL_SURFACE_PROGRAM, model_, "--ways", "knurl"}).code, 0);
}

TEST_F(SurfaceProgram, WhatIsWrongIsOneLineAndAnExitCode) {
    const std::vector<std::vector<std::string>> wrong = {
        {folder_.file("letter.txt", "Dear reader")},
        {model_, "--connect", "knurl:absent", "--wait", "0"},
        {model_, "--ways", "best"},
        {model_, "--rate", "fast"},
        {model_, "--write-stroke", folder_.path("absent/stroke.csv")},
    };
    for (auto words : wrong) {
        words.insert(words.begin(), KNURL_SURFACE_PROGRAM);
        const auto outcome = run(words);
        EXPECT_NE(outcome.code, 0) << words.back();
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_THAT(outcome.err, testing::StartsWith("knurl-surface: "));
    }
}

}  // namespace
