// A timeline has the content of the reports, as properly nested events.

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <trace_timeline.hpp>

namespace knurl::test {
namespace {

using cli::Around, cli::CycleParts, cli::Nanoseconds, cli::Timeline;
using knurl::Json;

constexpr Nanoseconds us = 1000, period = 1000 * us, start = 5'000'000'000;

Report cycle(std::uint64_t number, Nanoseconds late = 30 * us, Nanoseconds work = 20 * us) {
    Report report;
    report.cycle = number;
    report.deadline_ns = start + static_cast<Nanoseconds>(number) * period;
    report.read_ns = report.deadline_ns + late;
    report.write_ns = report.read_ns + work;
    return report;
}

Timeline cycles(std::uint64_t first, std::uint64_t count) {
    Timeline timeline{.servo = "default", .device = "right", .address = "sim:x", .rate = 1000};
    for (std::uint64_t n = first; n < first + count; ++n) timeline.reports.push_back(cycle(n));
    return timeline;
}

/// read, kinematics, take, scenes, supervise, write, publish. The middle four sum to 20 us.
CycleParts stamped(std::uint64_t number) {
    return {.cycle = number, .ns = {8 * us, 2 * us, 1 * us, 15 * us, 3 * us, 1 * us, 1 * us}};
}

struct Event {
    std::string name;
    double begin, end;  // us
};

std::vector<Event> spans(const Json& trace) {
    std::vector<Event> all;
    for (const Json& event : trace.at("traceEvents"))
        if (event.at("ph") == "X")
            all.push_back({event.at("name"), event.at("ts"),
                           event.at("ts").get<double>() + event.at("dur").get<double>()});
    return all;
}

const Event& named(const std::vector<Event>& all, const std::string& name) {
    const auto found = std::ranges::find(all, name, &Event::name);
    if (found == all.end()) throw std::runtime_error("no " + name);
    return *found;
}

/// Demands what a viewer needs of a track: an event that begins within another ends in it, and time never
/// goes back.
void expect_nested(const std::vector<Event>& all) {
    constexpr double rounding = 1e-6;
    std::vector<Event> open;
    double last = -rounding;
    for (const Event& event : all) {
        EXPECT_GE(event.begin, last - rounding) << event.name;
        EXPECT_GE(event.end, event.begin) << event.name;
        last = event.begin;
        while (!open.empty() && open.back().end <= event.begin + rounding) open.pop_back();
        const double outer = open.empty() ? event.end : open.back().end;
        EXPECT_LE(event.end, outer + rounding) << event.name;
        open.push_back(event);
    }
}

TEST(Trace, EachCycleRunsFromItsDeadlineUntilItHasWritten) {
    const Timeline timeline = cycles(1, 20);
    const Json trace = cli::to_trace(timeline, choose(timeline, Around::last, 4));
    const auto all = spans(trace);
    const auto zero = trace.at("otherData").at("zero_ns").get<Nanoseconds>();
    EXPECT_EQ(all.size(), 3u * 5) << "the newest and four before it";
    for (std::uint64_t n = 16; n <= 20; ++n) {
        const Report& report = timeline.reports[n - 1];
        const Event& event = named(all, "cycle " + std::to_string(n));
        EXPECT_EQ(zero + std::llround(event.begin * 1e3), report.deadline_ns);
        EXPECT_EQ(zero + std::llround(event.end * 1e3), report.write_ns);
    }
    EXPECT_EQ(zero + std::llround(named(all, "until read").end * 1e3), timeline.reports[15].read_ns);
    expect_nested(all);
}

TEST(Trace, AStampedCycleHasAllItsPartsWhereTheReportSaysTheyWere) {
    Timeline timeline = cycles(50, 30);
    timeline.parts.push_back(stamped(64));
    const auto stretch = choose(timeline, Around::last, 8);
    EXPECT_EQ(stretch.stamped, 64u);
    EXPECT_EQ(stretch.end - stretch.begin, 17u);
    const auto all = spans(cli::to_trace(timeline, stretch));
    const double deadline = named(all, "cycle 64").begin;
    EXPECT_NEAR(named(all, "asleep too long").end, deadline + 20, 1e-6);
    EXPECT_NEAR(named(all, "read").begin, deadline + 20, 1e-6);
    EXPECT_NEAR(named(all, "kinematics").end, deadline + 30, 1e-6) << "when the report says it was read";
    EXPECT_NEAR(named(all, "scenes").end - named(all, "scenes").begin, 15, 1e-6);
    EXPECT_NEAR(named(all, "write").end, deadline + 50, 1e-6) << "when the report says it was written";
    EXPECT_NEAR(named(all, "cycle 64").end, named(all, "publish").end, 1e-6);
    expect_nested(all);
}

TEST(Trace, AroundALateCycleIsTheNewestThatWasLate) {
    Timeline timeline = cycles(1, 300);
    for (std::size_t i = 99; i < 300; ++i) ++timeline.reports[i].late_count;
    for (std::size_t i = 199; i < 300; ++i) ++timeline.reports[i].late_count;
    timeline.reports[99] = cycle(100, 5000 * us);
    timeline.reports[99].late_count = 1;
    timeline.reports[199] = cycle(200, 30 * us, 1400 * us);
    timeline.reports[199].late_count = 2;
    const auto stretch = choose(timeline, Around::late, 8);
    EXPECT_TRUE(stretch.late);
    EXPECT_EQ(timeline.reports[stretch.middle].cycle, 200u);
    const auto all = spans(cli::to_trace(timeline, stretch));
    EXPECT_EQ(named(all, "cycle 200 (late)").end, named(all, "cycle 201").begin)
        << "which had to wait for it";
    expect_nested(all);
}

TEST(Trace, WhereNoneWasLateItIsTheOneThatWasReadLatest) {
    Timeline timeline = cycles(1, 300);
    timeline.reports[41] = cycle(42, 400 * us);
    timeline.parts.push_back(stamped(64));
    timeline.parts.push_back(stamped(256));
    const auto stretch = choose(timeline, Around::late, 8);
    EXPECT_FALSE(stretch.late);
    EXPECT_EQ(timeline.reports[stretch.middle].cycle, 42u);
    EXPECT_EQ(stretch.stamped, 64u) << "the nearest, though further away than eight";
    EXPECT_EQ(timeline.reports[stretch.end - 1].cycle, 64u);
}

TEST(Trace, WhateverTheReportsSayEventsLieInsideEachOther) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto up_to = [&random](Nanoseconds most) {
        return static_cast<Nanoseconds>(random() % static_cast<std::uint64_t>(most));
    };
    for (int round = 0; round < 300; ++round) {
        Timeline timeline{.servo = "a", .device = "b", .address = "c", .rate = 1000};
        const std::uint64_t first = 1 + random() % 200, count = 1 + random() % 200;
        for (std::uint64_t n = first; n < first + count; ++n) {
            Report report = cycle(n, up_to(4 * period) - period, up_to(4 * period) - period);
            report.late_count = n / 7;
            timeline.reports.push_back(report);
            if (n % 64 != 0) continue;
            CycleParts parts{.cycle = n};
            for (Nanoseconds& ns : parts.ns) ns = up_to(period);
            timeline.parts.push_back(parts);
        }
        const auto around = random() % 2 == 0 ? Around::last : Around::late;
        expect_nested(spans(cli::to_trace(timeline, choose(timeline, around, 1 + random() % 300))));
    }
}

cli::DeviceView counters(std::uint64_t stamped, std::uint64_t each) {
    cli::DeviceView view;
    view.counters["stamped_cycles"] = stamped;
    for (std::size_t i = 0; i < cli::cycle_parts.size(); ++i)
        view.counters[std::string(cli::cycle_parts[i]) + "_ns"] = each * (i + 1);
    return view;
}

TEST(PartsWatch, KnowsTheCycleWhoseStampsCameBetweenTwoLooks) {
    cli::PartsWatch watch;
    watch.look(counters(1, 100), 65, 66);
    watch.look(counters(1, 100), 120, 121);
    EXPECT_TRUE(watch.seen().empty());
    watch.look(counters(2, 130), 129, 190);
    ASSERT_EQ(watch.seen().size(), 1u);
    EXPECT_EQ(watch.seen()[0].cycle, 128u);
    EXPECT_THAT(watch.seen()[0].ns, testing::ElementsAre(30, 60, 90, 120, 150, 180, 210));
}

TEST(PartsWatch, BelievesNoLookWhileACycleMayBeStamping) {
    cli::PartsWatch watch;
    watch.look(counters(1, 100), 65, 66);
    watch.look(counters(2, 130), 127, 128);  // cycle 128 may be in progress, with some parts missing
    watch.look(counters(2, 130), 128, 129);
    EXPECT_TRUE(watch.seen().empty());
    watch.look(counters(3, 170), 193, 194);  // the sum of two cycles does not count
    EXPECT_TRUE(watch.seen().empty());
    watch.look(counters(4, 180), 257, 258);
    ASSERT_EQ(watch.seen().size(), 1u);
    EXPECT_EQ(watch.seen()[0].cycle, 256u);
}

}  // namespace
}  // namespace knurl::test
