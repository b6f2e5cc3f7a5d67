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
