// Two runs of `knurl latency`, from their files.

#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <latency_compare.hpp>
#include <latency_load.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using ordered_json = knurl::Json;
using testing::HasSubstr;

const measure::Machine machine{.processor = "a",
                               .cpus = 2,
                               .kernel = "6.1",
                               .load = "0",
                               .idle = "none",
                               .build = "gcc",
                               .date = "2026-01-01"};

/// A path and its floor on a machine that is slower by this factor.
cli::LatencyFile file(double slower, double path, unsigned seed, int blocks = 40) {
    std::mt19937_64 random(seed);
    measure::Blocks floor_blocks, path_blocks;
    std::lognormal_distribution<double> spread(0, 0.3);
    for (int i = 0; i < blocks; ++i) {
        std::vector<double> floors, paths;
        for (int n = 0; n < 60; ++n) {
            floors.push_back(40 * slower * spread(random));
            paths.push_back(60 * slower * path * spread(random));
        }
        floor_blocks.add(floors);
        path_blocks.add(paths);
    }
    cli::LatencyFile made{.run = {.machine = machine, .results = {}},
                          .setting = {{"rate", 1000}, {"load", "none"}}};
    made.run.results = {measure::summarise_blocks("report.blocking", "us", path_blocks),
                        measure::summarise_blocks("floor.eventfd_wake", "us", floor_blocks)};
    measure::relate(made.run.results[0], made.run.results[1]);
    return made;
}

std::string text_of(const cli::LatencyFile& file) {
    auto all = ordered_json::parse(measure::to_json(file.run));
    all["format"] = {{"program", cli::LatencyFile::program}, {"version", cli::LatencyFile::version}};
    all["setting"] = file.setting;
    return all.dump();
}

TEST(LatencyCompare, ASlowerMachineIsSeenAtTheFloorAndNotAtThePath) {
    const auto comparison = cli::compare_runs(file(1, 1, 1), file(1.5, 1, 2));
    ASSERT_EQ(comparison.paths.size(), 4u) << "medians and 99th percentiles of two";
    EXPECT_TRUE(comparison.warnings.empty());
    EXPECT_EQ(comparison.paths[0].name, "report.blocking");
    EXPECT_EQ(comparison.paths[0].reference, "floor.eventfd_wake");
    EXPECT_EQ(comparison.paths[0].result.verdict, measure::Verdict::undecided);
    EXPECT_EQ(comparison.paths[2].result.verdict, measure::Verdict::undecided) << "a floor is the machine";
    EXPECT_NEAR(comparison.paths[2].result.ratio, 1.5, 0.05);
    EXPECT_NEAR(comparison.moved, 1.5, 0.05);
    const auto better = cli::compare_runs(file(1, 1, 1), file(1.5, 0.8, 2));
    EXPECT_EQ(better.paths[0].result.verdict, measure::Verdict::better);
    EXPECT_THAT(cli::to_text(better), HasSubstr("better, beside floor.eventfd_wake"));
}

TEST(LatencyCompare, TooFewBlocksAreNoVerdictAndSayWhy) {
    const auto comparison = cli::compare_runs(file(1, 1, 1), file(3, 3, 2, 12));
    EXPECT_EQ(comparison.paths[0].result.verdict, measure::Verdict::undecided);
    EXPECT_THAT(cli::to_text(comparison), HasSubstr("undecided: the new run has 12 blocks, 30 are needed"));
    EXPECT_TRUE(cli::to_json(comparison).at("paths").at(0).at("ratio").is_null());
}

TEST(LatencyCompare, SaysWhatWasNotAlike) {
    auto other = file(1, 1, 2);
    other.run.machine.processor = "b";
    other.setting["load"] = "spin";
    const auto comparison = cli::compare_runs(file(1, 1, 1), other);
    EXPECT_THAT(comparison.warnings, testing::ElementsAre("the machine's processor was a, is b",
                                                          "`load` was \"none\", is \"spin\""));
}

TEST(LatencyCompare, AFileSaysTheSameAsTheRunThatItIsOf) {
    const Folder folder;
    const auto before = file(1, 1, 1), now = file(1, 1.3, 2);
    const auto read = cli::read_latency_file(folder.file("now.json", text_of(now)));
    EXPECT_EQ(cli::to_json(cli::compare_runs(before, read)), cli::to_json(cli::compare_runs(before, now)));
}

TEST(LatencyCompare, RefusesWhatItCannotCompareInOneLine) {
    const Folder folder;
    const std::string fine = text_of(file(1, 1, 1));
    const auto with = [&fine](const char* pointer, ordered_json value) {
        auto all = ordered_json::parse(fine);
        ordered_json* place = &all;
        std::istringstream steps(pointer + 1);
        for (std::string step; std::getline(steps, step, '/');)
            place = place->is_array() ? &place->at(std::stoul(step)) : &(*place)[step];
        *place = std::move(value);
        return all.dump();
    };
    struct Case {
        std::string text;
        const char* says;
    };
    for (const Case& c :
         {Case{"", "is not what knurl latency --json writes"}, Case{"{", "is not what"},
          Case{"[1, 2]", "does not say so"}, Case{R"({"results": []})", "does not say so"},
          Case{with("/format/version", 7), "has version 7 of the format, this program reads 1"},
          Case{with("/format/program", "other"), "does not say so"}, Case{with("/results", 3), "is not what"},
          Case{with("/setting", 3), "no \"setting\""},
          Case{with("/results/0/blocks/0/0/0", 33.33), "a bucket [33.33,"},
          Case{with("/results/0/blocks/0/0/1", -4), "a bucket ["},
          Case{with("/machine/cpus", "many"), "is not what"},
          Case{fine.substr(0, fine.size() / 2), "is not what"}}) {
        const Outcome outcome = knurl({"latency", "--compare", folder.file("old.json", c.text)});
        EXPECT_EQ(outcome.code, 1) << c.text.substr(0, 80);
        EXPECT_THAT(outcome.err, HasSubstr("old.json: "));
        EXPECT_THAT(outcome.err, HasSubstr(c.says));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    EXPECT_THAT(knurl({"latency", "--compare", folder.path("none.json")}).err,
                HasSubstr("cannot be read: No such"));
}

TEST(Load, WorksOnEachCpuUntilItIsEnded) {
    for (const char* kind : {"spin", "memory"}) {
        const cli::Load load(kind);
        EXPECT_EQ(load.threads(), measure::allowed_cpus().size());
        const std::size_t before = load.rounds();
        EXPECT_TRUE(eventually([&] { return load.rounds() > before + 2 * load.threads(); })) << kind;
    }
    EXPECT_EQ(cli::Load("none").threads(), 0u);
}

}  // namespace
}  // namespace knurl::test
