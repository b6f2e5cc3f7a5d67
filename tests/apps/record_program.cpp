// `knurl record` beside a servo and an application, `knurl replay` of its result, and independent readers.

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/client/client.hpp>
#include <knurl/json/json.hpp>
#include <knurl/reps/spring.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using namespace std::chrono_literals;
using json = knurl::Json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* device = "sim:premium15,tremor=0.3";

/// An application with contact, which holds the device until it ends.
class Application {
  public:
    Application()
        : client_(Client::connect("knurl:default")),
          claim_(client_.claim("premium15")),
          floor_(claim_.add(Plane{.offset = 2e-3, .stiffness = 500})) {
        claim_.add(Spring{.anchor = {0.01, 0, 0}, .stiffness = 30});
        claim_.arm();
    }
    /// Moves its plane until that many reports have come with the device active.
    void feel(int reports) {
        for (int felt = 0; felt < reports;) {
            const auto report = claim_.next_report(5s);
            ASSERT_TRUE(report) << "no report for 5 s";
            if (report->state == DeviceState::active) ++felt;
            if (report->cycle % 50 != 0) continue;
            floor_.set(Plane{.offset = report->cycle % 100 == 0 ? 2e-3 : 3e-3, .stiffness = 500});
            claim_.commit();
        }
    }

  private:
    Client client_;
    Claim claim_;
    Handle<Plane> floor_;
};

/// A recording of an application, made once for all tests that only read it.
const std::string& recording() {
    struct Made {
        Home home;
        std::string path = home.path("felt.mcap"), said;
        Made() {
            Servo servo({"--device", device});
            Background recorder({knurl_program(), "record", path});
            EXPECT_TRUE(recorder.says("recording device"));
            {
                Application application;
                application.feel(1500);
            }
            EXPECT_EQ(recorder.end(SIGINT), 0);
            said = recorder.said();
        }
    };
    static const Made made;
    EXPECT_THAT(made.said, HasSubstr("replay exactly"));
    EXPECT_THAT(made.said, HasSubstr(" 0 reports missed"));
    EXPECT_THAT(made.said, Not(HasSubstr("gap")));
    return made.path;
}

void replace(std::string& text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, to.size(), to);
}

TEST(Record, WhatAnApplicationFeltReplaysToTheLastBit) {
    const Outcome outcome = knurl({"replay", recording()});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("equal to the last bit"));
    EXPECT_GT(number_before(outcome.out, " cycles replayed"), 2000);
    EXPECT_EQ(outcome.err, "");
}

TEST(Record, ADeviceThatIsHeldIsSaidSoAndItsReportsAreExported) {
    const Home home;
    Servo servo({"--device", device});
    Application application;
    application.feel(10);
    Background recorder({knurl_program(), "record", home.path("late.mcap")});
    ASSERT_TRUE(recorder.says("an application holds the device"));
    application.feel(500);
    EXPECT_EQ(recorder.end(SIGINT), 0);
    EXPECT_THAT(recorder.said(), HasSubstr("does not replay"));
    const Outcome replayed = knurl({"replay", home.path("late.mcap"), "--csv", home.path("late.csv")});
    EXPECT_EQ(replayed.code, 0) << "the export is what was asked for";
    EXPECT_THAT(replayed.err, HasSubstr("nothing to replay: an application held the device"));
    EXPECT_EQ(std::count(replayed.err.begin(), replayed.err.end(), '\n'), 1);
    EXPECT_EQ(knurl({"replay", home.path("late.mcap")}).code, 1);
    const std::string csv = text_of_file(home.path("late.csv"));
    EXPECT_GT(std::count(csv.begin(), csv.end(), '\n'), 100);
    EXPECT_THAT(csv, testing::StartsWith("cycle,deadline_ns,"));
}

TEST(Record, EndsByItselfAndWhenTheServoDoes) {
    const Home home;
    Servo servo({"--device", device, "--device", "left=sim:cartesian3"});
    const Outcome which = knurl({"record", home.path("x.mcap")});
    EXPECT_EQ(which.code, 1);
    EXPECT_THAT(which.err, HasSubstr("say which one: premium15, left"));
    EXPECT_EQ(knurl({"record", home.path("x.mcap"), "--device", "right"}).code, 1);
    const Outcome some = knurl({"record", home.path("some.mcap"), "--device", "left", "--for", "0.2"});
    EXPECT_EQ(some.code, 0) << some.err;
    EXPECT_EQ(knurl({"replay", home.path("some.mcap")}).code, 0);
    Background recorder({knurl_program(), "record", home.path("end.mcap"), "--device", "premium15"});
    ASSERT_TRUE(recorder.says("recording device"));
    servo.end(SIGTERM);
    ASSERT_TRUE(recorder.says("the servo has ended"));
    const Outcome replayed = knurl({"replay", home.path("end.mcap")});
    EXPECT_EQ(replayed.code, 0) << replayed.err;
    const Outcome nobody = knurl({"record", home.path("x.mcap")});
    EXPECT_EQ(nobody.code, 1);
    EXPECT_EQ(std::count(nobody.err.begin(), nobody.err.end(), '\n'), 1) << nobody.err;
}

TEST(Record, AFullDiskDropsCountsAndSaysSo) {
    const Home home;
    Servo servo({"--device", device});
    // A limit on the file's size represents a full disk: 512 KiB in blocks of 1 KiB.
    Background recorder({"/bin/bash", "-c", "ulimit -f 512; exec \"$0\" record \"$1\"", knurl_program(),
                         home.path("full.mcap")});
    ASSERT_TRUE(recorder.says("recording device"));
    ASSERT_TRUE(recorder.says("dropping what does not fit"));
    EXPECT_EQ(recorder.end(SIGINT), 1);
    EXPECT_THAT(recorder.said(), HasSubstr("messages dropped (disk full)"));
    EXPECT_LE(std::filesystem::file_size(home.path("full.mcap")), 512u * 1024);
    const Outcome replayed = knurl({"replay", home.path("full.mcap")});
    EXPECT_EQ(replayed.code, 0) << replayed.err;
    EXPECT_GT(number_before(replayed.out, " cycles replayed"), 500);
    EXPECT_EQ(knurl({"record", "/dev/full"}).code, 1);
    EXPECT_EQ(knurl({"top", "--count", "1"}).code, 0) << "the servo goes on";
}

// ------------------------------------------------------------------------------------------- bad input

TEST(Replay, UsesWhatIsWholeOfAFileThatWasCutOff) {
    const Home home;
    const std::string all = text_of_file(recording());
    const int cycles = number_before(knurl({"replay", recording()}).out, " cycles replayed");
    for (const double part : {0.6, 0.8, 0.95}) {
        const std::string path = home.file(
            "cut.mcap", all.substr(0, static_cast<std::size_t>(part * static_cast<double>(all.size()))));
        const Outcome outcome = knurl({"replay", path});
        EXPECT_EQ(outcome.code, 0) << part << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("cut off; its first "));
        EXPECT_LE(number_before(outcome.out, " cycles replayed"), cycles);
        EXPECT_GT(number_before(outcome.out, " cycles replayed"), static_cast<int>(part * cycles) - 1200);
    }
    const Outcome nothing = knurl({"replay", home.file("cut.mcap", all.substr(0, 40))});
    EXPECT_EQ(nothing.code, 1);
    EXPECT_THAT(nothing.err, HasSubstr("cut off before anything was recorded"));
    // The file has no input yet; the message names the cut as the reason.
    const std::size_t metadata_ends = all.find(std::string("wire\x10\0\0\0", 8)) + 24;  // its last entry
    const std::string begun = home.file("cut.mcap", all.substr(0, metadata_ends + 1000));
    const Outcome no_input = knurl({"replay", begun});
    EXPECT_EQ(no_input.code, 1);
    EXPECT_THAT(no_input.err,
                HasSubstr("nothing to replay: " + begun + ": the recording is cut off behind "));
    EXPECT_THAT(no_input.err, HasSubstr("before the first input"));
    EXPECT_THAT(no_input.err, Not(HasSubstr("held")));
    EXPECT_EQ(std::count(no_input.err.begin(), no_input.err.end(), '\n'), 1) << no_input.err;
}

TEST(Record, OverwritesNothingUnlessItIsForced) {
    const Home home;
    Servo servo({"--device", device});
    const std::string path = home.file("mine.mcap", "months of work");
    const std::vector<std::string> words{"record", "--for", "0.3", path};
    const Outcome refused = knurl(words);
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, HasSubstr(path + ": is there already; --force replaces it"));
    EXPECT_EQ(text_of_file(path), "months of work");
    const Outcome salvaged = knurl({"record", "--salvage", home.file("flight-a-b-c.csv", ""), path});
    EXPECT_EQ(salvaged.code, 1);
    EXPECT_EQ(text_of_file(path), "months of work");

    const Outcome forced = knurl({"record", "--force", "--for", "0.3", path});
    EXPECT_EQ(forced.code, 0) << forced.err;
    const Outcome again = knurl({"replay", path});
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(number_before(again.out, " cycles replayed"),
              number_before(forced.out, " cycles replay exactly"))
        << "all sentences count the same cycles";
    EXPECT_EQ(number_before(again.out, " reports"), number_before(forced.out, " cycles in")) << forced.out;
}

TEST(Record, ShowsHowFarItIsOnATerminalOnly) {
    const Home home;
    Servo servo({"--device", device});
    OnTerminal recorder({knurl_program(), "record", "--for", "600", home.path("long.mcap")});
    ASSERT_TRUE(recorder.shows(" of 600 s, ")) << recorder.shown;
    constexpr char interrupt = 3;  // Ctrl-C
    recorder.type(interrupt);
    EXPECT_EQ(recorder.end(), 0);
    EXPECT_THAT(recorder.shown, HasSubstr(" cycles in "));
    const Outcome elsewhere = knurl({"record", "--for", "0.3", home.path("short.mcap")});
    EXPECT_THAT(elsewhere.err, Not(HasSubstr(" of 0.3 s")));
}

TEST(Replay, SeesThatAFileWasChanged) {
    const Home home;
    const std::string all = text_of_file(recording());
    for (const double part : {0.3, 0.5, 0.7}) {
        std::string changed = all;
        changed[static_cast<std::size_t>(part * static_cast<double>(all.size()))] ^= 1;
        const Outcome outcome = knurl({"replay", home.file("changed.mcap", changed)});
        EXPECT_EQ(outcome.code, 1) << part;
        EXPECT_THAT(outcome.err, HasSubstr("changed"));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
}

TEST(Replay, RefusesOtherBuildsOtherDevicesAndOtherFiles) {
    const Home home;
    const auto refused = [&](const std::string& text, const char* why) {
        const Outcome outcome = knurl({"replay", home.file("other.mcap", text)});
        EXPECT_EQ(outcome.code, 1);
        EXPECT_THAT(outcome.err, HasSubstr(why));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    };
    const std::string all = text_of_file(recording());
    std::string other = all;
    replace(other, std::string("wire\x10\0\0\0", 8), std::string("wire\x10\0\0\0ffff", 12));
    refused(other, "replay it with the build that made it");
    other = all;
    replace(other, std::string("device_figures\x10\0\0\0", 18),
            std::string("device_figures\x10\0\0\0ffff", 22));
    refused(other, "recorded on another device: sim:premium15");
    other = all;
    replace(other, std::string("rate\x04\0\0\0001000", 12), std::string("rate\x04\0\0\000-100", 12));
    refused(other, "rate = -100, no servo's (500 to 20000 Hz)");
    refused("t,x,y,z\n", "is no MCAP file");
    refused("", "is no MCAP file");
    refused(
        std::string("\x89MCAP0\r\n\x01\x08\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x0f\x04\0\0\0\0\0\0\0\0\0\0\0", 38),
        "none that knurl record made");
    EXPECT_EQ(knurl({"replay", home.path("there is none")}).code, 1);
}

// --------------------------------------------------------------------------------------- other uses

TEST(Record, SalvagesWhatTheGuardianSaved) {
    const Home home;
    {
        Servo servo({"--device", device});
        Application application;
        application.feel(300);
        servo.end(SIGKILL);
    }
    const auto saved = [&] {
        std::string found;
        for (const auto& file : std::filesystem::directory_iterator(home.path("")))
            if (file.path().extension() == ".csv") found = file.path().string();
        return found;
    };
    ASSERT_TRUE(eventually([&] { return !saved().empty(); }));
    const Outcome all = knurl({"record", "--salvage", home.path(""), home.path("last.mcap")});
    ASSERT_EQ(all.code, 0) << all.err;
    EXPECT_THAT(all.out, HasSubstr("device 'premium15' (" + std::string(device) + ")"));
    ASSERT_EQ(knurl({"replay", home.path("last.mcap"), "--csv", home.path("again.txt")}).code, 0);
    // The same digits as the guardian wrote, without its comments.
    const std::string before = text_of_file(saved());
    EXPECT_EQ(text_of_file(home.path("again.txt")), before.substr(before.find("cycle,deadline_ns")));
    const Outcome replayed = knurl({"replay", home.path("last.mcap")});
    EXPECT_EQ(replayed.code, 1);
    EXPECT_THAT(replayed.err, HasSubstr("reports alone, which do not replay"));

    const Outcome cut =
        knurl({"record", "--salvage", home.file("cut.csv", before.substr(0, before.size() - 20)),
               home.path("x.mcap")});
    EXPECT_EQ(cut.code, 1);
    EXPECT_THAT(cut.err, HasSubstr("cut.csv:"));
    EXPECT_THAT(cut.err, HasSubstr("is no report"));
    EXPECT_EQ(knurl({"record", "--salvage", home.file("a.csv", "t,x\n"), home.path("x.mcap")}).code, 1);
}

TEST(Replay, FeelsTheRecordedMotionWithAnotherScene) {
    const Home home;
    // The recorded spring, and one of half its stiffness: each force is half as large.
    const auto felt = [&](const char* stiffness) {
        const std::string scene = home.file("scene.toml", std::string("[[spring]]\nanchor = [0.5, 0, 0]\n"
                                                                      "stiffness = ") +
                                                              stiffness + "\n");
        const Outcome outcome = knurl({"replay", recording(), "--scene", scene});
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("recorded: mean "));
        const std::size_t at = outcome.out.find("scene.toml: mean ");
        EXPECT_NE(at, std::string::npos) << outcome.out;
        return std::atof(outcome.out.c_str() + at + std::strlen("scene.toml: mean "));
    };
    const double whole = felt("40"), half = felt("20");
    EXPECT_NEAR(whole, 40 * 0.5, 2) << "the hand is about the origin";
    EXPECT_NEAR(half, whole / 2, 1e-3);
    const Outcome none = knurl({"replay", recording(), "--scene", home.path("none.toml")});
    EXPECT_NE(none.code, 0);
    EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
}

// --------------------------------------------------------------------------------- readers that are not ours

TEST(Record, AnIndependentReaderFindsEverythingInItsPlace) {
    const Outcome outcome = run({"/usr/bin/env", "python3", KNURL_READ_MCAP ".py", recording()});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json found = json::parse(outcome.out);
    EXPECT_THAT(found.at("library").get<std::string>(), testing::StartsWith("Knurl "));
    EXPECT_EQ(found.at("metadata").at("knurl").at("address"), device);
    EXPECT_EQ(found.at("schemas")[0][1], "ros2msg");
    ASSERT_GT(found.at("reports").size(), 2000u);
    EXPECT_EQ(found.at("messages").at("/premium15/report"), found.at("reports").size());
    // Each is compared with the report before it.
    for (const char* topic : {"/premium15/measured_cp", "/premium15/measured_cf", "/premium15/measured_cv",
                              "/premium15/measured_js", "/premium15/joy", "/tf"}) {
        EXPECT_GE(found.at("messages").at(topic).get<std::size_t>(), found.at("reports").size() / 11)
            << topic;
        EXPECT_LE(found.at("messages").at(topic).get<std::size_t>(), found.at("reports").size() / 9) << topic;
    }
    EXPECT_EQ(found.at("dropped"), 0);
    int felt = 0;
    for (std::size_t i = 1; i < found.at("reports").size(); ++i) {
        const json& report = found.at("reports")[i];
        ASSERT_EQ(report.at("cycle").get<int>(), found.at("reports")[i - 1].at("cycle").get<int>() + 1);
        felt += report.at("state") == 4 && report.at("sent_fz") != 0;
    }
    EXPECT_GE(felt, 1400);
}

TEST(Record, TheFormatsOwnReaderOpensIt) {
    const char* modules = std::getenv("KNURL_MCAP_MODULES");
    if (modules == nullptr)
        GTEST_SKIP() << "MCAP's own reader is not there: npm install --prefix DIR @mcap/core fzstd, then "
                        "KNURL_MCAP_MODULES=DIR/node_modules";
    ::setenv("NODE_PATH", modules, 1);
    const Outcome outcome = run({"/usr/bin/env", "node", KNURL_READ_MCAP ".js", recording()});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json found = json::parse(outcome.out);
    EXPECT_TRUE(found.at("ended").get<bool>());
    EXPECT_GT(found.at("lastCycle"), 2000);
    int all = 0;
    for (const json& count : found.at("topics")) all += count.get<int>();
    EXPECT_EQ(found.at("streamed").get<int>(), all);
    EXPECT_GT(found.at("topics").at("/premium15/report"), 2000);
    EXPECT_EQ(found.at("topics").size(), 11u);
}

}  // namespace
}  // namespace knurl::test
