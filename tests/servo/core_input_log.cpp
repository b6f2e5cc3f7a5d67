// A recording replays to the last bit, whatever happens to a servo. And every input is needed: a missing one
// shows.

#include <functional>
#include <map>

#include <knurl/servo/asset_build.hpp>
#include <knurl/servo/asset_digest.hpp>

#include "input_log_run.hpp"

namespace knurl::servo::core_input_log_tests {
namespace {

using namespace testing;

struct Outcome {
    std::uint64_t replayed = 0;
    std::string first_difference;  // empty: none
};

/// Replays the records and compares each report with the recorded one, every byte.
Outcome replayed(const RecordedRun& run, const std::vector<InputRecord>& records,
                 Replay::Sources sources = {}) {
    Replay replay(run.device, run.options, std::move(sources));
    Outcome outcome;
    try {
        for (const InputRecord& record : records) {
            const Report* report = replay.feed(record);
            if (report == nullptr) continue;
            ++outcome.replayed;
            const Report& recorded = run.reports.at(report->cycle - 1);
            if (std::memcmp(report, &recorded, sizeof recorded) == 0) continue;
            outcome.first_difference = "cycle " + std::to_string(report->cycle);
            break;
        }
    } catch (const InputLogError& error) {
        outcome.first_difference = error.what();
    }
    return outcome;
}

TEST(InputLog, ReplaysEveryByteOfEveryReport) {
    std::map<DeviceState, int> states;
    std::map<InputType, int> types;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        RecordedRun run(seed, seed % 3 == 0 ? 3000 : 1000);
        std::vector<InputRecord> records;
        // the recording begins in the middle of its life
        const int before = static_cast<int>(seed % 5) * 400;
        for (int i = 0; i < 9000; ++i) {
            if (i == before) run.start();
            run.cycle();
            for (InputRecord& record : run.drain()) records.push_back(std::move(record));
        }
        EXPECT_EQ(run.reader.missed(), 0u);
        const Outcome outcome = replayed(run, records);
        EXPECT_EQ(outcome.first_difference, "");
        EXPECT_GT(outcome.replayed, 5000u);
        for (const Report& report : run.reports) ++states[report.state];
        for (const InputRecord& record : records) ++types[record.type];
    }
    for (const auto state : {DeviceState::disconnected, DeviceState::idle, DeviceState::ramp_up,
                             DeviceState::active, DeviceState::ramp_down, DeviceState::fault})
        EXPECT_GT(states[state], 500) << "state " << static_cast<int>(state) << " hardly happened";
    for (const auto type :
         {InputType::keyframe, InputType::adopt, InputType::drop, InputType::commands,
          InputType::commands_broken, InputType::batch, InputType::batch_broken, InputType::cycle})
        EXPECT_GT(types[type], 0) << "type " << static_cast<int>(type) << " never happened";
}

TEST(InputLog, TheEndOfAServoReplays) {
    RecordedRun run(77);
    run.start();
    for (int i = 0; i < 1500; ++i) run.cycle();
    run.servo->drop_all();
    for (int i = 0; i < 200; ++i) run.cycle();
    const Outcome outcome = replayed(run, run.drain());
    EXPECT_EQ(outcome.first_difference, "");
    EXPECT_GT(outcome.replayed, 1500u);
}

/// A square metre as an application sends it.
std::vector<std::uint64_t> square() {
    const std::vector<Point3> vertices{{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}};
    const std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
    protocol::AssetSource header;
    header.vertices = vertices.size();
    header.triangles = triangles.size();
    const auto layout = *protocol::layout_of(header);
    std::vector<std::uint64_t> words(layout.total / 8);
    auto* bytes = reinterpret_cast<std::byte*>(words.data());
    std::memcpy(bytes, &header, sizeof header);
    std::memcpy(bytes + layout.vertices, vertices.data(), 24 * vertices.size());
    std::memcpy(bytes + layout.triangles, triangles.data(), 12 * triangles.size());
    return words;
}

/// An application's assets come and go; a second shape under a forgotten number is refused.
TEST(InputLog, AssetsReplayAndEachOfTheirRecordsMatters) {
    const std::vector<std::uint64_t> words = square();
    const std::span<const std::byte> source = std::as_bytes(std::span(words));
    const BuiltAsset built = build_asset(source, 1 << 20);
    RecordedRun run(1);
    run.start();
    std::uint64_t n = 0;
    double pushed = 0;
    const auto go_on = [&](int cycles) {
        for (int i = 0; i < cycles; ++i, ++n) {
            const auto t = static_cast<double>(n);
            run.device.tip = {3e-3 * std::sin(4e-3 * t), 0, 3e-3 * std::cos(5e-3 * t)};
            run.clock.time += 990'000;
            const Nanoseconds now = run.clock.now();
            run.servo->step(now, now);
            run.reports.push_back(run.servo->last());
            pushed = std::max(pushed, run.servo->last().scene_force.z);
            while (run.servo->returned()) {
            }
        }
    };
    go_on(10);
    ClaimTerms terms;
    terms.capacity = {.representations = 16, .batch_bytes = 16 * 512};
    terms.frame = frame_for(run.device.link(), {});
    terms.limits = limits_for(run.device.link(), run.options.rate, terms.frame);
    OfflineClaim claim(terms);
    run.servo->adopt(&claim.servo_side());
    const auto add = [&](std::uint32_t slot) {
        const Shape shape{.asset = 2, .stiffness = 300};
        claim.add({slot, 1}, kind_of<Shape>, &shape, sizeof shape);
    };
    const protocol::AssetDigest digest = digest_of(source);
    run.servo->give(&claim.servo_side(), 2, built.asset.get(), digest);
    add(0);
    claim.arm();
    go_on(900);
    EXPECT_GT(pushed, 0.1);
    claim.remove({0, 1});
    run.servo->forget(&claim.servo_side(), 2);
    go_on(200);
    add(1);  // from an asset that is gone
    go_on(600);
    run.servo->give(&claim.servo_side(), 2, built.asset.get(), digest);
    add(2);
    go_on(700);
    run.servo->drop(&claim.servo_side());
    go_on(100);
    const std::vector<InputRecord> records = run.drain();
    const Replay::Sources sources = [&](const protocol::AssetDigest& wanted) {
        if (wanted != digest) throw InputLogError("another one");
        return source;
    };
    EXPECT_EQ(replayed(run, records, sources).first_difference, "");
    EXPECT_GE(replayed(run, records, sources).replayed, run.reports.size() - 2);
    EXPECT_NE(replayed(run, records).first_difference.find("was not recorded"), std::string::npos);
    for (const InputType type : {InputType::asset, InputType::asset_forgotten}) {
        std::vector<InputRecord> edited;
        for (const InputRecord& record : records)
            if (record.type != type) edited.push_back(record);
        EXPECT_NE(replayed(run, edited, sources).first_difference, "") << static_cast<int>(type);
    }
}

/// Without any one of the inputs the replay differs. So each is recorded for a reason, and the comparison
/// detects its loss.
TEST(InputLog, EveryInputMatters) {
    using Edit = std::function<bool(InputRecord&)>;  // false: the record is left out
    const auto without = [](InputType type) -> Edit {
        return [type](InputRecord& record) { return record.type != type; };
    };
    const auto cycles = [](auto change) -> Edit {
        return [change](InputRecord& record) {
            if (record.type != InputType::cycle) return true;
            CycleInput cycle;
            std::memcpy(&cycle, record.bytes.data(), record.bytes.size());
            change(cycle);
            record.bytes.resize(cycle.bytes());
            std::memcpy(record.bytes.data(), &cycle, record.bytes.size());
            return true;
        };
    };
    const std::vector<std::pair<std::string, Edit>> edits = {
        {"adopt", without(InputType::adopt)},
        {"drop", without(InputType::drop)},
        {"drop_all", without(InputType::drop_all)},
        {"commands", without(InputType::commands)},
        {"commands_broken", without(InputType::commands_broken)},
        {"batch", without(InputType::batch)},
        {"batch_broken", without(InputType::batch_broken)},
        {"cycle", without(InputType::cycle)},
        {"deadline", cycles([](CycleInput& c) { c.deadline = 0; })},
        {"now", cycles([](CycleInput& c) { c.now += c.cycle % 100 == 0 ? 1000 : 0; })},
        {"read_ns", cycles([](CycleInput& c) { c.read_ns = 0; })},
        {"write_ns", cycles([](CycleInput& c) { c.write_ns = 0; })},
        {"status", cycles([](CycleInput& c) { c.status = 0; })},
        {"position", cycles([](CycleInput& c) { c.position[1] += 1e-15; })},
        {"velocity", cycles([](CycleInput& c) { c.velocity[2] = 0; })},
        {"buttons", cycles([](CycleInput& c) { c.buttons ^= 1; })},
        {"has_velocity", cycles([](CycleInput& c) { c.flags &= ~CycleInput::has_velocity; })},
        {"calibrated", cycles([](CycleInput& c) { c.flags |= CycleInput::calibrated; })},
        {"written", cycles([](CycleInput& c) { c.flags |= CycleInput::written; })},
        {"guardian", cycles([](CycleInput& c) { c.flags &= ~CycleInput::guardian; })},
        {"jumped", cycles([](CycleInput& c) { c.flags &= ~CycleInput::jumped; })},
        {"keyframe", [](InputRecord& record) {
             // The last bit of each word of the hand's state: which of them still matter depends on how long
             // the hand has moved since.
             for (std::size_t word = 10; word < 35 && record.type == InputType::keyframe; ++word)
                 record.bytes[word * 8] ^= std::byte{1};
             return true;
         }}};
    std::map<std::string, int> seen;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        RecordedRun run(seed);
        for (int i = 0; i < 300; ++i) run.cycle();
        run.start();
        for (int i = 0; i < 6000; ++i) run.cycle();
        run.servo->drop_all();
        for (int i = 0; i < 200; ++i) run.cycle();
        const std::vector<InputRecord> records = run.drain();
        ASSERT_EQ(replayed(run, records).first_difference, "") << "seed " << seed;
        for (const auto& [name, edit] : edits) {
            std::vector<InputRecord> edited;
            for (InputRecord record : records)
                if (edit(record)) edited.push_back(std::move(record));
            const Outcome outcome = replayed(run, edited);
            seen[name] += !outcome.first_difference.empty() || outcome.replayed == 0;
        }
    }
    for (const auto& [name, edit] : edits) EXPECT_GT(seen[name], 0) << name << " could be left out";
}

/// A recorder that sleeps while the ring wraps: it learns of the gap, nobody waits for it, and after the gap
/// the replay continues from the next keyframe.
TEST(InputLog, ASlowReaderIsToldOfTheGapAndReplaysBehindIt) {
    RecordedRun run(5);
    run.start();
    Replay replay(run.device, run.options);
    std::uint64_t compared = 0, after_gap = 0, gaps = 0;
    const auto drain = [&] {
        InputRecord record;
        for (;;) {
            const InputLogReader::Next next = run.reader.next(record);
            if (next == InputLogReader::Next::nothing) return;
            if (next == InputLogReader::Next::gap) {
                ++gaps;
                replay.gap();
                EXPECT_FALSE(replay.exact());
                continue;
            }
            const Report* report = replay.feed(record);
            if (report == nullptr) continue;
            ++compared;
            after_gap += gaps > 0;
            ASSERT_EQ(std::memcmp(report, &run.reports.at(report->cycle - 1), sizeof *report), 0)
                << "cycle " << report->cycle;
        }
    };
    for (int i = 0; i < 3000; ++i) run.cycle();
    drain();
    const std::uint64_t before = compared;
    while (InputLog::written(run.memory.data()) < 3 * input_log_slots / 2 + 4000) run.cycle();
    drain();
    EXPECT_EQ(gaps, 1u);
    EXPECT_GT(run.reader.missed(), 0u);
    EXPECT_GT(before, 2000u);
    EXPECT_GT(after_gap, 10'000u);
}

/// An edited file may cause an error line or other forces, and nothing worse.
TEST(InputLog, AnEditedInputLogHarmsNothing) {
    RecordedRun run(3);
    run.start();
    for (int i = 0; i < 1500; ++i) run.cycle();
    const std::vector<InputRecord> records = run.drain();
    ASSERT_EQ(replayed(run, records).first_difference, "");
    int refused = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        std::vector<InputRecord> edited = records;
        for (int i = 0; i < 20; ++i) {
            InputRecord& record = edited[random() % edited.size()];
            if (random() % 4 == 0) record.type = static_cast<InputType>(random() % 12);
            if (random() % 4 == 0) record.bytes.resize(random() % 600);
            if (!record.bytes.empty()) record.bytes[random() % record.bytes.size()] = std::byte(random());
        }
        if (seed % 2 == 0)  // every byte of the first keyframe
            for (std::byte& byte : edited.front().bytes) byte = std::byte(random());
        Replay replay(run.device, run.options);
        try {
            for (const InputRecord& record : edited) replay.feed(record);
        } catch (const InputLogError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 30);
}

TEST(InputLog, NothingIsWrittenWhileNobodyRecords) {
    RecordedRun run(9);
    for (int i = 0; i < 100; ++i) run.cycle();
    EXPECT_EQ(InputLog::written(run.memory.data()), 0u);
    run.start();
    for (int i = 0; i < 100; ++i) run.cycle();
    EXPECT_GT(InputLog::written(run.memory.data()), 90u);
    run.servo->record(nullptr);
    run.cycle();
    const std::uint64_t written = InputLog::written(run.memory.data());
    for (int i = 0; i < 100; ++i) run.cycle();
    EXPECT_EQ(InputLog::written(run.memory.data()), written);
}

TEST(InputLog, ADeviceOfOtherFiguresIsAnotherDevice) {
    PuppetDevice one(6), same(6), stronger(6), shorter(3);
    stronger.link_.peak_force = 11;
    EXPECT_EQ(figures_of(one), figures_of(same));
    EXPECT_NE(figures_of(one), figures_of(stronger));
    EXPECT_NE(figures_of(one), figures_of(shorter));
}

}  // namespace
}  // namespace knurl::servo::core_input_log_tests
