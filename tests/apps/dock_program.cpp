// knurl-dock as a person runs it: on a simulated device, with a simulation in the test.

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/json/json.hpp>

#include "fake_imd.hpp"
#include "program.hpp"

namespace {

using knurl::test::Background;
using knurl::test::FakeImd;
using knurl::test::FakeImdOptions;
using knurl::test::Folder;
using knurl::test::Outcome;
using knurl::test::run;
using testing::HasSubstr;

class DockProgram : public testing::Test {
  protected:
    void SetUp() override {
        std::filesystem::create_directory(temporary_);
        ::setenv("TMPDIR", temporary_.c_str(), 1);
    }
    void TearDown() override { ::unsetenv("TMPDIR"); }

    Outcome dock(const FakeImd& simulation, std::vector<std::string> words) {
        words.insert(words.begin(), {KNURL_DOCK_PROGRAM, simulation.address(), "--demo"});
        return run(words);
    }
    knurl::Json figures() { return knurl::Json::parse(knurl::test::text_of_file(folder_.path("f.json"))); }

    const Folder folder_;
    const std::filesystem::path temporary_ = folder_.path("tmp");
};

bool is_let_go(const FakeImd::Forces& forces) {
    return forces.size() == 1 && forces.begin()->second == std::array<float, 3>{};
}

TEST_F(DockProgram, PullsAnAtomAndSaysWhatCameOfIt) {
    FakeImd simulation({.swapped = true});
    const std::string picture = folder_.path("dock.png"), csv = folder_.path("dock.csv");
    const Outcome docked = dock(simulation, {"--atom", "4", "--seconds", "2", "--picture", picture, "--csv",
                                             csv, "--json", folder_.path("f.json"), "--kill"});
    ASSERT_EQ(docked.code, 0) << docked.err;
    EXPECT_THAT(docked.out, HasSubstr("9 atoms, the other byte order; atom 4"));
    EXPECT_THAT(docked.out, HasSubstr("the coupling created"));
    EXPECT_EQ(knurl::test::text_of_file(picture).substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_TRUE(simulation.was_pulled());
    EXPECT_TRUE(simulation.eventually_pulled(is_let_go));
    EXPECT_TRUE(simulation.was_killed());
    const knurl::Json of = figures();
    EXPECT_GT(of["frames"], 10);
    EXPECT_GT(of["rms_force"], 0.05);
    EXPECT_GT(of["moved_nm"], 0.05);
    EXPECT_LE(of["created_share"], 0.01);
    EXPECT_EQ(of["atom"], 4);
    std::ifstream rows(csv);
    std::size_t count = 0;
    for (std::string line; std::getline(rows, line);) ++count;
    EXPECT_GT(count, 500u);
    EXPECT_TRUE(std::filesystem::is_empty(temporary_)) << "it leaves nothing behind";
}

TEST_F(DockProgram, AsksForFramesAsTheEngineIsFast) {
    FakeImd simulation({.steps_per_second = 5000});
    const Outcome docked =
        dock(simulation, {"--rate", "50", "--seconds", "3", "--json", folder_.path("f.json")});
    ASSERT_EQ(docked.code, 0) << docked.err;
    // A frame takes 100 of its steps; on a loaded machine it may be slower, with fewer steps.
    const knurl::Json of = figures();
    const double wanted = double(of["steps_per_second"]) / 50;
    EXPECT_NEAR(simulation.rate(), wanted, 0.5 * wanted);
}

TEST_F(DockProgram, LetsGoHoweverItEnds) {
    for (const int signal : {SIGKILL, SIGABRT, SIGTERM, SIGINT, SIGHUP}) {
        SCOPED_TRACE(signal);
        FakeImd simulation;
        Background program(
            {KNURL_DOCK_PROGRAM, simulation.address(), "--demo", "--atom", "1", "--seconds", "100"});
        ASSERT_TRUE(simulation.eventually_pulled(
            [](const FakeImd::Forces& forces) { return !forces.empty() && !is_let_go(forces); }));
        const int code = program.end(signal);
        EXPECT_EQ(code, signal == SIGKILL || signal == SIGABRT ? 128 + signal : 0);
        EXPECT_TRUE(simulation.eventually_gone());
        EXPECT_TRUE(simulation.eventually_pulled(is_let_go));
    }
}

TEST_F(DockProgram, LetsGoWhileItIsStoppedAndTakesHoldAgain) {
    FakeImd simulation;
    Background program(
        {KNURL_DOCK_PROGRAM, simulation.address(), "--demo", "--atom", "1", "--seconds", "100"});
    const auto is_pulled = [](const FakeImd::Forces& forces) {
        return !forces.empty() && !is_let_go(forces);
    };
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(simulation.eventually_pulled(is_pulled)) << i;
        bool let_go = false;
        // A program that is stopped within a message cannot send: then the test repeats.
        for (int tries = 0; tries < 4 && !let_go; ++tries) {
            ::kill(program.pid(), SIGSTOP);
            let_go = simulation.eventually_pulled(is_let_go, std::chrono::seconds(8));
            ::kill(program.pid(), SIGCONT);
        }
        ASSERT_TRUE(let_go) << i;
    }
    ASSERT_TRUE(simulation.eventually_pulled(is_pulled));
    EXPECT_EQ(program.end(SIGTERM), 0);
    EXPECT_TRUE(simulation.eventually_pulled(is_let_go));
    // Not each of the three counts: a stop that is over before the program looks again is no stop to it, and on a busy
    // machine the atom may have been let go just before.
    EXPECT_THAT(program.said(), testing::ContainsRegex("stopped [1-9] times"))
        << "it is no other end of the simulation";
}

TEST_F(DockProgram, SaysThatTheSimulationEnded) {
    {
        FakeImd simulation({.once_pulled = true, .close_at = 60});
        const Outcome docked = dock(simulation, {"--seconds", "60"});
        EXPECT_EQ(docked.code, 1);
        EXPECT_THAT(docked.err, HasSubstr("the simulation has ended"));
        EXPECT_THAT(docked.out, HasSubstr("frames")) << "what came of it is told all the same";
    }
    FakeImd killed({.once_pulled = true, .cut_at = 60});
    const Outcome docked = dock(killed, {"--seconds", "60"});
    EXPECT_EQ(docked.code, 1);
    EXPECT_THAT(docked.err, HasSubstr("within a message"));
    EXPECT_TRUE(std::filesystem::is_empty(temporary_));
}

TEST_F(DockProgram, WaitsForASimulationThatPauses) {
    FakeImd simulation({.once_pulled = true, .pause_at = 30});
    const Outcome docked =
        dock(simulation, {"--rate", "50", "--seconds", "4", "--json", folder_.path("f.json")});
    ASSERT_EQ(docked.code, 0) << docked.err;
    EXPECT_THAT(docked.out, testing::ContainsRegex("stopped [1-9][0-9]* times"));
    EXPECT_LE(figures()["created_share"], 0.01);
}

TEST_F(DockProgram, LeavesAHotSimulationAlone) {
    FakeImd simulation({.hot_at = 0});
    const Outcome docked = dock(simulation, {"--seconds", "2"});
    ASSERT_EQ(docked.code, 0) << docked.err;
    EXPECT_THAT(docked.out, HasSubstr("above 450 K"));
    EXPECT_FALSE(simulation.was_pulled());
}

TEST_F(DockProgram, RoughHandlingAtTheStiffestScaleThatItTakesIsNoKick) {
    for (const char* rate : {"60", "2"}) {
        SCOPED_TRACE(rate);
        double step = 0;  // N in a cycle, without the part from the hand's own motion
        // A delayed program takes hold at the hand's old place: then the test repeats.
        for (int tries = 0; tries < 4 && (tries == 0 || step > 0.5); ++tries) {
            FakeImd simulation({.atoms = 300});
            const Outcome docked =
                dock(simulation, {"--rough", "--seed", "3", "--rate", rate, "--seconds", "6", "--force-scale",
                                  "0.5", "--greatest-force", "30", "--json", folder_.path("f.json")});
            ASSERT_EQ(docked.code, 0) << docked.err;
            EXPECT_GT(figures()["hand_in"], 0.01) << "J: it was pulled";
            EXPECT_TRUE(simulation.was_pulled());
            step = figures()["end_step"];
        }
        EXPECT_LE(step, 0.5)
            << "taken hold of under way it is faded in within 50 ms; a kick was 2 N and more";
    }
}

TEST_F(DockProgram, RefusesWhatMakesNoSense) {
    FakeImd simulation;
    const Outcome range = dock(simulation, {"--atom", "9", "--seconds", "1"});
    EXPECT_EQ(range.code, 1);
    EXPECT_THAT(range.err, HasSubstr("there is no atom 9: the simulation sends 9, counted from 0"));
    const std::string nobody = "127.0.0.1:1";
    const auto says = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {KNURL_DOCK_PROGRAM, nobody});
        return run(words);
    };
    EXPECT_THAT(says({"--force-scale", "0.2"}).err, HasSubstr("a larger --force-scale"));
    EXPECT_THAT(says({"--wait", "1"}).err, HasSubstr("is a simulation running there"));
    EXPECT_THAT(says({"--picture", "/nowhere/p.png"}).err, HasSubstr("/nowhere"));
    EXPECT_EQ(says({"--rate", "0.5"}).code, 2);
    EXPECT_EQ(says({"--greatest-force", "1000"}).code, 2);
    EXPECT_EQ(run({KNURL_DOCK_PROGRAM}).code, 2);
    EXPECT_EQ(says({"--servo", "a b"}).code, 2);
}

}  // namespace
