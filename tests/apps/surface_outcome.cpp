// The output of knurl-surface: ages of its updates, the table, and files that other programs read.

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/json/json.hpp>

#include "surface/elevation.hpp"
#include "surface/outcome.hpp"

namespace {

using surface::Outcome;
using surface::Recording;
using surface::Terrain;
using surface::Way;
using testing::HasSubstr;

constexpr std::int64_t ms = 1'000'000;

/// A servo that reads at k ms and writes 0.1 ms later; a level surface, 1 mm deep.
Recording recording(Way way, int cycles = 2000) {
    Recording r;
    r.way = way;
    r.stiffness = 1000;
    r.max_stiffness = 3000;
    r.greatest_force = 8;
    for (int i = 0; i < cycles; ++i) {
        surface::Cycle cycle;
        cycle.number = static_cast<std::uint64_t>(i);
        cycle.t = i * 1e-3;
        cycle.position = {std::min(6e-3, i * 1e-5) - 3e-3, 0, -1e-3};  // 6 mm along it, then at rest
        cycle.force = {0, 0, 1};
        r.cycles.push_back(cycle);
        r.read_ns.push_back(i * ms);
        r.write_ns.push_back(i * ms + ms / 10);
    }
    return r;
}

Terrain level() {
    return Terrain({.rows = 8, .columns = 9, .cell = 1e-3, .heights = std::vector<double>(72, 0.0)});
}

TEST(Ages, FromTheReadOfItsReportToTheFirstWriteAfterItsCommit) {
    Recording r = recording(Way::planes);
    r.updates = {{.report_cycle = 10, .report_read_ns = 10 * ms, .commit_ns = 35 * ms + ms / 2},
                 {.report_cycle = 60, .report_read_ns = 60 * ms, .commit_ns = 85 * ms + ms / 2}};
    EXPECT_THAT(surface::ages_at_use(r),
                testing::ElementsAre(testing::DoubleNear(26.1e-3, 1e-9), testing::DoubleNear(26.1e-3, 1e-9)));
}

TEST(Ages, AnUpdateThatWasOvertakenBeforeTheServoReadItHasNone) {
    Recording r = recording(Way::planes);
    r.updates = {{.report_cycle = 10, .report_read_ns = 10 * ms, .commit_ns = 35 * ms + 100},
                 {.report_cycle = 12, .report_read_ns = 12 * ms, .commit_ns = 35 * ms + 200}};
    EXPECT_THAT(surface::ages_at_use(r), testing::ElementsAre(testing::DoubleNear(24.1e-3, 1e-9)));
}

TEST(Ages, AnUpdateAfterTheLastCycleHasNone) {
    Recording r = recording(Way::planes, 50);
    r.updates = {{.report_cycle = 49, .report_read_ns = 49 * ms, .commit_ns = 74 * ms}};
    EXPECT_TRUE(surface::ages_at_use(r).empty());
}

TEST(Quantile, IsTheNearestRank) {
    EXPECT_EQ(surface::quantile({5, 1, 4, 2, 3}, 0.5), 3);
    EXPECT_EQ(surface::quantile({5, 1, 4, 2, 3}, 1), 5);
    EXPECT_EQ(surface::quantile({7}, 0.99), 7);
    EXPECT_EQ(surface::quantile({}, 0.5), 0);
}

class Files : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) / ("knurl-outcome-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        outcomes_.push_back(surface::judged(recording(Way::planes), terrain_, span_));
        Recording jumpy = recording(Way::knurl);
        for (std::size_t i = 500; i < jumpy.cycles.size(); ++i) jumpy.cycles[i].force.z() = 3;
        outcomes_.push_back(surface::judged(std::move(jumpy), terrain_, span_));
        text_.model = "hills.png";
        text_.rate = 20;
        text_.machine = knurl::measure::this_machine();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string read(const std::filesystem::path& file) {
        std::ostringstream out;
        out << std::ifstream(file).rdbuf();
        return out.str();
    }

    const Terrain terrain_ = level();
    const surface::Span span_{.rest_at = 1.0, .end = 1.9};
    std::filesystem::path folder_;
    std::vector<Outcome> outcomes_;
    surface::RunText text_;
};

TEST_F(Files, TheTableHasAColumnAndAVerdictForEachWay) {
    const std::string table = surface::table(outcomes_, text_);
    EXPECT_THAT(table, HasSubstr("hills.png"));
    EXPECT_THAT(table, HasSubstr("as they come"));
    EXPECT_THAT(table, HasSubstr("not stable: jump"));
    EXPECT_THAT(table, HasSubstr(text_.machine.processor));
    EXPECT_THAT(table, HasSubstr("2.00 N"));
}

TEST_F(Files, JsonHasTheCommonFormAndTheStrokes) {
    surface::write_json(folder_ / "out.json", outcomes_, text_);
    const auto json = knurl::Json::parse(read(folder_ / "out.json"));
    EXPECT_EQ(json.at("machine").at("processor"), text_.machine.processor);
    ASSERT_EQ(json.at("results").size(), 6u);
    const auto& jump = json.at("results").at(1);
    EXPECT_EQ(jump.at("name"), "planes.force_jump");
    EXPECT_EQ(jump.at("unit"), "N");
    EXPECT_EQ(jump.at("max"), 0);
    EXPECT_TRUE(jump.at("p999").is_null()) << "fewer than 10 samples above it";
    ASSERT_EQ(json.at("strokes").size(), 2u);
    EXPECT_EQ(json.at("strokes").at(0).at("verdict"), "stable");
    EXPECT_EQ(json.at("strokes").at(1).at("verdict"), "not stable: jump");
    EXPECT_NEAR(json.at("strokes").at(1).at("jump").get<double>(), 2, 1e-12);
    EXPECT_TRUE(json.at("strokes").at(1).at("fault_at_s").is_null());
}

TEST_F(Files, CsvHasARowPerCycle) {
    surface::write_csv(folder_ / "out.csv", outcomes_, terrain_);
    std::istringstream lines(read(folder_ / "out.csv"));
    std::string line;
    std::getline(lines, line);
    const auto columns = std::count(line.begin(), line.end(), ',');
    std::size_t rows = 0;
    while (std::getline(lines, line)) {
        ++rows;
        EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns);
    }
    EXPECT_EQ(rows, 4000u);
}

TEST_F(Files, TheReliefIsAGridThatKnurlSurfaceReadsItself) {
    surface::write_relief(folder_ / "relief.asc", terrain_);
    const auto model = surface::load_elevation(folder_ / "relief.asc");
    EXPECT_EQ(model.rows, 8);
    EXPECT_EQ(model.columns, 9);
    EXPECT_EQ(model.counts[40], 0);
}

TEST_F(Files, AFileThatCannotBeWrittenIsNamed) {
    EXPECT_THROW(surface::write_json(folder_ / "absent" / "out.json", outcomes_, text_), std::runtime_error);
    EXPECT_THROW(surface::write_csv(folder_ / "absent" / "out.csv", outcomes_, terrain_), std::runtime_error);
}

}  // namespace
