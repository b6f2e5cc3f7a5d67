#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/segment.hpp>

#include "support.hpp"

namespace knurl::shm {
namespace {

using test::Memory;
using Report = test::Record<48>;

class BroadcastRing : public testing::Test {
  protected:
    static constexpr std::uint32_t slots = 8;

    BroadcastRing() : memory_(broadcast_bytes(slots, sizeof(Report))) { broadcast_init(memory_.data()); }

    void publish(int n) {
        for (int i = 0; i < n; ++i) {
            const Report report = Report::numbered(writer_.published());
            writer_.publish(&report);
        }
    }
    BroadcastReader reader(std::uint64_t start = BroadcastReader::newest) {
        return {memory_.data(), slots, sizeof(Report), start};
    }

    Memory memory_;
    BroadcastWriter writer_{memory_.data(), slots, sizeof(Report)};
    Report report_{};
};

TEST_F(BroadcastRing, EveryReaderGetsEveryReportInOrder) {
    BroadcastReader first = reader(), second = reader();
    EXPECT_FALSE(first.next(&report_));
    for (std::uint64_t n = 0; n < 100; ++n) {
        publish(1);
        ASSERT_TRUE(first.fresh());
        ASSERT_TRUE(first.next(&report_));
        ASSERT_TRUE(report_.is(n));
        ASSERT_FALSE(first.next(&report_));
        ASSERT_TRUE(second.next(&report_));
        ASSERT_TRUE(report_.is(n));
    }
    EXPECT_EQ(first.missed(), 0u);
    EXPECT_EQ(first.position(), 100u);
}

TEST_F(BroadcastRing, ASlowReaderIsToldExactlyHowManyItMissed) {
    BroadcastReader slow = reader(0);
    publish(3);
    ASSERT_TRUE(slow.next(&report_));
    publish(20);  // 23 in all; the last 7 can be read: 16 to 22
    ASSERT_TRUE(slow.next(&report_));
    EXPECT_TRUE(report_.is(16));
    EXPECT_EQ(slow.missed(), 15u);
    std::uint64_t got = 2;
    while (slow.next(&report_)) ++got;
    EXPECT_EQ(got + slow.missed(), 23u);
}

/// Rows with a word of the caller's before each report, and one after it.
struct Row {
    std::uint64_t before = 7;
    Report report{};
    std::uint64_t after = 9;
};
std::byte* first_of(std::vector<Row>& rows) {
    return reinterpret_cast<std::byte*>(&rows.front().report);
}

TEST_F(BroadcastRing, ManyAtOnceAreWhatNextGives) {
    BroadcastReader one = reader(0), many = reader(0);
    std::vector<Row> rows(5);
    EXPECT_EQ(many.next_some(first_of(rows), sizeof(Row), rows.size()), 0u);
    std::uint64_t total = 0;
    // Around the ring many times, in every phase of it; also past its end, and with more than there is room for.
    for (int published = 0; published < 24; ++published) {
        publish(published);
        for (std::size_t got = 1; got > 0; total += got) {
            for (Row& row : rows) row = {};
            got = many.next_some(first_of(rows), sizeof(Row), rows.size());
            ASSERT_LE(got, rows.size());
            for (std::size_t i = 0; i < rows.size(); ++i) {
                ASSERT_EQ(rows[i].before, 7u);
                ASSERT_EQ(rows[i].after, 9u);
                if (i >= got) continue;
                ASSERT_TRUE(one.next(&report_));
                ASSERT_TRUE(rows[i].report.is(one.position() - 1));
                ASSERT_EQ(std::memcmp(&rows[i].report, &report_, sizeof report_), 0);
            }
            ASSERT_EQ(many.position(), one.position());
            ASSERT_EQ(many.missed(), one.missed());
        }
        ASSERT_EQ(many.position(), writer_.published());
        ASSERT_EQ(total + many.missed(), many.position());
    }
    EXPECT_GT(many.missed(), 0u);
    publish(1);
    EXPECT_EQ(many.next_some(first_of(rows), sizeof(Row), 0), 0u);
    EXPECT_EQ(many.position() + 1, writer_.published());
}

/// The writer goes on while a reader copies: before each report that is copied, so many are published.
struct OvertakingMemory : HardwareMemory {
    static inline std::function<void()> before_copy;
    static void load_payload(void* to, const Payload* shared, std::size_t words,
                             std::memory_order order) noexcept {
        before_copy();
        HardwareMemory::load_payload(to, shared, words, order);
    }
};

TEST_F(BroadcastRing, AWriterThatOvertakesInTheMiddleCostsWhatItOverwroteAndNoMore) {
    const std::uint64_t seed = test::seed();
    SCOPED_TRACE("KNURL_SEED=" + std::to_string(seed));
    std::mt19937_64 random(seed);
    const BroadcastPlaces<> hardware = broadcast_places(memory_.data(), slots, sizeof(Report));
    BasicBroadcastReader<OvertakingMemory> late({.end = hardware.end,
                                                 .slots = hardware.slots,
                                                 .count = slots,
                                                 .stride_words = hardware.stride_words,
                                                 .slot_words = hardware.slot_words},
                                                0);
    std::uint64_t got = 0, in_the_middle = 0;
    for (int round = 0; round < 20'000; ++round) {
        publish(static_cast<int>(random() % (2 * slots)));
        const std::uint64_t pause = 1 + random() % 40;  // copies from one publication to the next
        OvertakingMemory::before_copy = [&] {
            if (random() % pause != 0) return;
            publish(static_cast<int>(1 + random() % 3));
            ++in_the_middle;
        };
        std::vector<Row> rows(1 + random() % slots);
        const std::size_t read = late.next_some(first_of(rows), sizeof(Row), rows.size());
        got += read;
        for (std::size_t i = 0; i < read; ++i) ASSERT_TRUE(rows[i].report.is(late.position() - read + i));
        ASSERT_EQ(got + late.missed(), late.position());
        ASSERT_LE(late.position(), writer_.published());
    }
    EXPECT_GT(got, 0u);
    EXPECT_GT(late.missed(), 0u);
    EXPECT_GT(in_the_middle, 0u);
    // A writer that is never overtaken by any copy: the reader gives up until the next call, and counts on.
    OvertakingMemory::before_copy = [&] { publish(slots); };
    publish(slots);
    std::vector<Row> rows(slots);
    EXPECT_EQ(late.next_some(first_of(rows), sizeof(Row), rows.size()), 0u);
    OvertakingMemory::before_copy = [] {};
    got += late.next_some(first_of(rows), sizeof(Row), rows.size());
    EXPECT_EQ(got + late.missed(), writer_.published());
}

TEST_F(BroadcastRing, TheLastSlotsLessOneCanBeRead) {
    publish(100);
    for (std::uint64_t n = 0; n < 110; ++n) {
        const bool readable = n >= 93 && n < 100;
        EXPECT_EQ(reader().at(n, &report_), readable) << n;
        EXPECT_TRUE(!readable || report_.is(n)) << n;
    }
    EXPECT_FALSE(reader().at(~std::uint64_t{0}, &report_));
}

TEST_F(BroadcastRing, AReaderBeginsWithTheNewestReport) {
    publish(5);
    BroadcastReader late = reader();
    ASSERT_TRUE(late.next(&report_));
    EXPECT_TRUE(report_.is(4));
    EXPECT_EQ(late.missed(), 0u);
}

TEST_F(BroadcastRing, LatestSkipsAndDoesNotCallItMissed) {
    BroadcastReader view = reader(0);
    EXPECT_FALSE(view.latest(&report_));
    publish(30);
    ASSERT_TRUE(view.latest(&report_));
    EXPECT_TRUE(report_.is(29));
    EXPECT_EQ(view.skipped(), 29u);
    EXPECT_EQ(view.missed(), 0u);
    EXPECT_FALSE(view.latest(&report_));  // nothing new
    publish(1);
    ASSERT_TRUE(view.next(&report_));
    EXPECT_TRUE(report_.is(30));
    EXPECT_EQ(2 + view.missed() + view.skipped(), view.position());
}

TEST_F(BroadcastRing, AReaderNoticesThatTheWriterBeganAnew) {
    BroadcastReader view = reader(0);
    publish(5);
    while (view.next(&report_)) {
    }
    EXPECT_FALSE(view.restarted());
    broadcast_init(memory_.data());
    EXPECT_TRUE(view.restarted());
    EXPECT_TRUE(view.fresh());  // something to see to
    EXPECT_FALSE(view.next(&report_));
    EXPECT_FALSE(view.latest(&report_));
    EXPECT_EQ(view.missed(), 0u);
}

TEST_F(BroadcastRing, AWriterThatAttachesGoesOnWhereTheCounterStands) {
    publish(5);
    BroadcastWriter second(memory_.data(), slots, sizeof(Report));
    EXPECT_EQ(second.published(), 5u);
}

TEST(BroadcastRingMapping, ReadersNeedOnlyAReadOnlyMapping) {
    Segment servo = Segment::create("knurl-test", broadcast_bytes(8, sizeof(Report)));
    broadcast_init(servo.data());
    servo.seal_against_new_writers();
    BroadcastWriter writer(servo.data(), 8, sizeof(Report));
    const Segment client = Segment::open(servo.fd(), servo.size(), Segment::Access::read_only);
    BroadcastReader reader(client.data(), 8, sizeof(Report));
    const Report sent = Report::numbered(0);
    Report got{};
    writer.publish(&sent);
    ASSERT_TRUE(reader.fresh());
    ASSERT_TRUE(reader.next(&got));
    EXPECT_TRUE(got.is(0));
}

TEST(BroadcastRingLayout, RefusesWhatCannotWork) {
    Memory memory(broadcast_bytes(8, 64));
    EXPECT_THROW(BroadcastWriter(memory.data(), 6, 64), std::invalid_argument);
    EXPECT_THROW(BroadcastWriter(memory.data(), 1, 64), std::invalid_argument);
    EXPECT_THROW(BroadcastReader(memory.data(), 8, 60), std::invalid_argument);
    EXPECT_THROW(BroadcastReader(memory.data() + 8, 8, 64), std::invalid_argument);
    EXPECT_EQ(broadcast_bytes(8, 40), 128 + 8 * 64u);
}

}  // namespace
}  // namespace knurl::shm
