// What who watches is shown is what is in the scenes, whatever happens to them; a cycle writes little of it at a time;
// and a servo that is watched does what it does unwatched, bit for bit.

#include <map>
#include <set>

#include <gtest/gtest.h>

#include <knurl/servo/scene_log.hpp>

#include "claim_impl.hpp"
#include "input_log_run.hpp"
#include "unshown.hpp"

namespace knurl::servo::core_scene_log_tests {
namespace {

using namespace testing;

/// A watcher's picture, put together from the records alone.
struct Picture {
    struct Item {
        RepresentationId id;
        Kind kind = 0;
        AddOptions options;
        std::vector<std::byte> params;
    };
    struct Seen {
        SceneClaim claim;
        std::map<std::uint32_t, Item> items;
        std::map<std::uint32_t, ProbePlacement> probes;
        SceneFelt felt;
        std::vector<SceneContact> contacts;
    };
    std::map<std::uint64_t, Seen> claims;
    std::uint64_t records = 0, begins = 0;

    template <class T>
    static T take(std::span<const std::byte>& bytes) {
        T value;
        if (bytes.size() < sizeof value) throw std::runtime_error("a record is too short");
        std::memcpy(&value, bytes.data(), sizeof value);
        bytes = bytes.subspan(sizeof value);
        return value;
    }
    void put(const LogRecord& record) {
        ++records;
        std::span<const std::byte> bytes(record.bytes);
        const auto type = static_cast<SceneRecord>(record.type);
        if (type == SceneRecord::begin) {
            claims.clear();
            ++begins;
            return;
        }
        const auto number = take<std::uint64_t>(bytes);
        if (type == SceneRecord::claim) claims[number].claim = take<SceneClaim>(bytes);
        if (type == SceneRecord::claim_gone) {  // also of one that left before its turn came
            claims.erase(number);
            return;
        }
        ASSERT_TRUE(claims.contains(number)) << "something of a claim that was not shown";
        Seen& seen = claims[number];
        if (type == SceneRecord::probe) {
            const auto probe = take<SceneProbe>(bytes);
            ASSERT_LT(probe.probe, max_probes);
            seen.probes[probe.probe] = probe.placement;
        }
        if (type == SceneRecord::item) {
            const auto item = take<SceneItem>(bytes);
            ASSERT_EQ(bytes.size(), kinds()[item.kind].size);
            seen.items[item.id.slot] = {item.id, item.kind, item.options, {bytes.begin(), bytes.end()}};
        }
        if (type == SceneRecord::item_gone) seen.items.erase(take<RepresentationId>(bytes).slot);
        if (type == SceneRecord::felt) {
            seen.felt = take<SceneFelt>(bytes);
            seen.contacts.clear();
            for (std::uint32_t i = 0; i < seen.felt.contacts; ++i)
                seen.contacts.push_back(take<SceneContact>(bytes));
        }
    }
};

struct Watcher {
    OfflineMemory memory{scene_log_bytes};
    RecordLog log{memory.data(), scene_log_slots};
    RecordLogReader reader{memory.data(), scene_log_slots, 0, max_scene_record};
    Picture picture;

    void look() {
        LogRecord record;
        RecordLogReader::Next next;
        while ((next = reader.next(record)) != RecordLogReader::Next::nothing) {
            ASSERT_EQ(next, RecordLogReader::Next::record);
            picture.put(record);
        }
    }
    std::uint64_t slots() const { return RecordLog::written(memory.data(), scene_log_slots); }
};

/// Compares it with the scenes themselves.
void expect_same(const RecordedRun& run, const Picture& picture) {
    std::set<std::uint64_t> there;
    for (const auto& app : run.apps) {
        const Claim::Impl& claim = *app.claim->servo_side().impl;
        there.insert(claim.number);
        const auto found = picture.claims.find(claim.number);
        ASSERT_NE(found, picture.claims.end()) << "claim " << claim.number << " was not shown";
        const Picture::Seen& seen = found->second;
        EXPECT_EQ(seen.claim.frame.scale, claim.terms.frame.scale);
        std::size_t items = 0;
        for (std::uint32_t slot = 0; slot < claim.terms.capacity.representations; ++slot) {
            const Scene::Shown shown = claim.scene.shown(slot);
            if (shown.params.empty()) {
                EXPECT_FALSE(seen.items.contains(slot)) << "slot " << slot << " is empty";
                continue;
            }
            ++items;
            ASSERT_TRUE(seen.items.contains(slot)) << "slot " << slot << " was not shown";
            const Picture::Item& item = seen.items.at(slot);
            EXPECT_EQ(item.id, shown.id);
            EXPECT_EQ(item.kind, shown.kind);
            EXPECT_EQ(item.options.probe, shown.options.probe);
            EXPECT_TRUE(
                std::equal(item.params.begin(), item.params.end(), shown.params.begin(), shown.params.end()));
        }
        EXPECT_EQ(seen.items.size(), items);
        const ProbePlacement placed = claim.scene.placement(1);
        const bool known = seen.probes.contains(1);
        EXPECT_EQ(known ? seen.probes.at(1).offset.x : 0, placed.offset.x);
        EXPECT_EQ(known ? seen.probes.at(1).radius : 0, placed.radius);
    }
    for (const auto& [number, seen] : picture.claims)
        EXPECT_TRUE(there.contains(number)) << "claim " << number;
}

TEST(SceneLog, ShowsWhatIsInTheScenesAfterAnything) {
    std::uint64_t shown = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        RecordedRun run(seed);
        Watcher watcher;
        const int before = static_cast<int>(seed % 4) * 500;  // somebody comes in the middle of its life
        for (int i = 0; i < 4000; ++i) {
            if (i == before) run.servo->show_scenes(&watcher.log);
            if (i == before + 1000)
                run.servo->show_scenes(&watcher.log);  // another one, or the same once more
            run.cycle();
            ASSERT_NO_FATAL_FAILURE(watcher.look());
        }
        run.quiet = true;
        for (int i = 0; i < 1000; ++i) run.cycle();
        ASSERT_NO_FATAL_FAILURE(watcher.look());
        ASSERT_NO_FATAL_FAILURE(expect_same(run, watcher.picture));
        EXPECT_EQ(watcher.picture.begins, 2u);
        shown += watcher.picture.records;
    }
    EXPECT_GT(shown, 1000u);
}

TEST(SceneLog, WhoWatchesChangesNothingInAnyReport) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        RecordedRun watched(seed), alone(seed);
        Watcher watcher;
        watched.servo->show_scenes(&watcher.log);
        for (int i = 0; i < 4000; ++i) {
            watched.cycle();
            alone.cycle();
            ASSERT_EQ(std::memcmp(&watched.reports.back(), &alone.reports.back(), sizeof(Report)), 0)
                << "cycle " << i;
        }
        EXPECT_GT(watcher.slots(), 100u);
    }
}

/// A live servo and a claim with many representations.
struct Crowd {
    static constexpr std::uint32_t most = 512;
    PuppetDevice device;
    RestlessClock clock;
    OfflineMemory segment{protocol::device_layout().total};
    ServoOptions options = live_options(1000);
    Servo servo{device, clock, segment.data(), options};
    std::unique_ptr<OfflineClaim> claim;
    Watcher watcher;

    Crowd() {
        ClaimTerms terms;
        terms.capacity = {.representations = most, .batch_bytes = most * 512};
        terms.limits = limits_for(device.link(), 1000, {});
        claim = std::make_unique<OfflineClaim>(terms);
        servo.adopt(&claim->servo_side());
        for (std::uint32_t slot = 0; slot < most; ++slot) {
            const Plane plane{.normal = {0, 0, 1}, .offset = -0.01, .stiffness = 100.0 + slot};
            claim->add({slot, 1}, kind_of<Plane>, &plane, sizeof plane, {});
            if (slot % 32 == 31) cycles(2);
        }
        cycles(20);
    }
    void cycles(int n) {
        for (int i = 0; i < n; ++i) {
            clock.time += 990'000;
            const Nanoseconds now = clock.now();
            servo.step(now, now);
            claim->replies();
        }
    }
    void change_all(double by) {
        for (std::uint32_t slot = 0; slot < most; ++slot) {
            const Plane plane{.normal = {0, 0, 1}, .offset = -0.01 - by, .stiffness = 100.0 + slot};
            claim->update({slot, 1}, kind_of<Plane>, &plane, sizeof plane);
        }
        claim->commit(1, clock.time);
    }
};

TEST(SceneLog, ACycleWritesLittleHoweverMuchChanges) {
    Crowd crowd;
    crowd.servo.show_scenes(&crowd.watcher.log);
    constexpr std::uint64_t item_slots = 4;  // of a plane: 264 bytes and what stands before them
    std::uint64_t before = crowd.watcher.slots(), most = 0;
    for (int i = 0; i < 2000; ++i) {
        if (i % 3 == 0) crowd.change_all(1e-6 * i);
        crowd.cycles(1);
        ASSERT_NO_FATAL_FAILURE(crowd.watcher.look());
        most = std::max(most, crowd.watcher.slots() - before);
        before = crowd.watcher.slots();
    }
    EXPECT_LE(most, most_scene_changes * item_slots + 2) << "slots in one cycle";
    // Whatever changes in each cycle is shown again and again, and nothing is left out for ever.
    EXPECT_EQ(crowd.watcher.picture.claims.begin()->second.items.size(), Crowd::most);
    const double last = -0.01 - 1e-6 * 1998;
    crowd.cycles(800);
    ASSERT_NO_FATAL_FAILURE(crowd.watcher.look());
    for (const auto& [slot, item] : crowd.watcher.picture.claims.begin()->second.items) {
        Plane plane;
        std::memcpy(&plane, item.params.data(), sizeof plane);
        EXPECT_EQ(plane.offset, last) << "slot " << slot;
        EXPECT_EQ(plane.stiffness, 100.0 + slot);
    }
}

TEST(SceneLog, NothingIsWrittenWhileNobodyWatches) {
    Crowd crowd;
    crowd.change_all(1e-4);
    crowd.cycles(100);
    EXPECT_EQ(crowd.watcher.slots(), 0u);
    crowd.servo.show_scenes(&crowd.watcher.log);
    crowd.cycles(800);
    crowd.servo.show_scenes(nullptr);
    crowd.cycles(1);
    const std::uint64_t then = crowd.watcher.slots();
    EXPECT_GT(then, Crowd::most);
    crowd.change_all(2e-4);
    crowd.cycles(100);
    EXPECT_EQ(crowd.watcher.slots(), then);
}

TEST(SceneLog, SaysWhatIsTouchedAndThatItIsNotAnyMore) {
    Crowd crowd;
    crowd.servo.show_scenes(&crowd.watcher.log);
    crowd.claim->arm();
    const auto look = [&] {
        crowd.cycles(700);
        crowd.watcher.look();
        return crowd.watcher.picture.claims.at(1);
    };
    crowd.device.tip = {0, 0, 0.05};
    EXPECT_TRUE(look().contacts.empty());
    for (int i = 0; i <= 70; ++i) {  // slowly: a jump of the encoder is none of a hand
        crowd.device.tip.z() = 0.05 - 1e-3 * i;
        crowd.cycles(20);
    }
    const Picture::Seen touched = look();
    ASSERT_FALSE(touched.contacts.empty());
    const Feedback* feedback = nullptr;
    crowd.claim->servo_side().impl->feedback.each_touched([&](const Feedback& entry) {
        if (entry.id == touched.contacts.front().id) feedback = &entry;
    });
    ASSERT_NE(feedback, nullptr);
    EXPECT_NEAR(touched.contacts.front().force.z, feedback->wrench.force.z(), 1e-9);
    EXPECT_GT(touched.contacts.front().force.z, 0);
    EXPECT_EQ(touched.felt.asleep, 0u);
    for (int i = 0; i <= 70; ++i) {
        crowd.device.tip.z() = -0.02 + 1e-3 * i;
        crowd.cycles(20);
    }
    const Picture::Seen left = look();
    EXPECT_TRUE(left.contacts.empty());
    EXPECT_EQ(left.felt.asleep, 1u) << "out of the hand's reach";
}

TEST(SceneLog, ARecordHoldsSoManyContactsAndNoMore) {
    Crowd crowd;
    for (std::uint32_t slot = 0; slot < 2 * most_scene_contacts; ++slot) {
        const Spring spring{.anchor = {0.01, 0, 0}, .stiffness = 1};
        crowd.claim->remove({slot, 1});
        crowd.claim->add({slot, 2}, kind_of<Spring>, &spring, sizeof spring, {});
        if (slot % 16 == 15) crowd.cycles(2);
    }
    crowd.claim->arm();
    crowd.servo.show_scenes(&crowd.watcher.log);
    crowd.cycles(1000);
    ASSERT_NO_FATAL_FAILURE(crowd.watcher.look());
    EXPECT_EQ(crowd.watcher.picture.claims.at(1).contacts.size(), most_scene_contacts);
}

TEST(SceneLog, ACycleWritesLittleHoweverManyClaimsAreTouched) {
    Crowd crowd;
    crowd.servo.drop(&crowd.claim->servo_side());  // the others alone, with a contact each
    crowd.cycles(100);
    std::vector<std::unique_ptr<OfflineClaim>> others;
    constexpr std::size_t many = 100;
    for (std::size_t i = 0; i < many; ++i) {
        ClaimTerms terms;
        terms.capacity = {.representations = 4, .batch_bytes = 2048};
        terms.limits = limits_for(crowd.device.link(), 1000, {});
        others.push_back(std::make_unique<OfflineClaim>(terms));
        crowd.servo.adopt(&others.back()->servo_side());
        crowd.cycles(1);
        others.back()->add(Spring{.anchor = {0.01, 0, 0}, .stiffness = 0.1});
        others.back()->arm();
        crowd.cycles(1);
    }
    // They never commit: all is over before the first of them counts as silent, after 3.5 s.
    crowd.cycles(700);
    crowd.servo.show_scenes(&crowd.watcher.log);
    crowd.cycles(600);
    ASSERT_NO_FATAL_FAILURE(crowd.watcher.look());
    for (auto& [number, seen] : crowd.watcher.picture.claims) seen.contacts.clear();
    std::uint64_t before = crowd.watcher.slots(), most = 0;
    for (int i = 0; i < 500; ++i) {
        crowd.cycles(1);
        most = std::max(most, crowd.watcher.slots() - before);
        before = crowd.watcher.slots();
    }
    EXPECT_LE(most, static_cast<std::uint64_t>(most_scene_felt))
        << "records of one contact in one cycle: one slot each";
    ASSERT_NO_FATAL_FAILURE(crowd.watcher.look());
    std::size_t touched = 0;
    for (const auto& [number, seen] : crowd.watcher.picture.claims) touched += !seen.contacts.empty();
    EXPECT_EQ(touched, many) << "each has its turn";
}

TEST(Unshown, GivesEachSlotOnceAndInBoundedSteps) {
    Unshown unshown(200);
    EXPECT_FALSE(unshown.any());
    unshown.slot(7);
    unshown.slot(199);
    unshown.slot(7);
    std::uint32_t most = 0;  // none of the sweep is needed
    EXPECT_EQ(unshown.take_slot(most)->slot, 7u);
    EXPECT_EQ(unshown.take_slot(most)->slot, 199u);
    EXPECT_FALSE(unshown.take_slot(most));
    EXPECT_FALSE(unshown.any());
    unshown.all();
    unshown.slot(3);
    std::set<std::uint32_t> seen;
    int steps = 0;
    while (unshown.any()) {
        most = 64;
        ++steps;
        while (const auto next = unshown.take_slot(most)) {
            EXPECT_EQ(next->changed, next->slot == 3);
            EXPECT_TRUE(seen.insert(next->slot).second);
        }
        unshown.take_claim();
        while (unshown.take_probe()) {
        }
        if (steps > 10) break;
    }
    EXPECT_EQ(seen.size(), 200u);
    EXPECT_LE(steps, 5);
}

}  // namespace
}  // namespace knurl::servo::core_scene_log_tests
