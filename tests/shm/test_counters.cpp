#include <gtest/gtest.h>

#include <knurl/shm/counters.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::shm {
namespace {

constexpr std::string_view names[] = {"cycles", "late_cycles", "faults"};

TEST(Counters, AnyProcessReadsWhatTheOneWriterCounts) {
    Segment servo = Segment::create("knurl-test", counters_bytes(std::size(names)));
    Counters counters(servo.data(), names);
    const Segment client = Segment::open(servo.fd(), servo.size(), Segment::Access::read_only);
    const CountersReader reader(client.data(), names);
    ASSERT_EQ(reader.size(), 3u);
    EXPECT_EQ(reader.read(0), 0u);
    counters.increment(0);
    counters.increment(0);
    counters.increment(1, 10);
    counters.set(2, 99);
    EXPECT_EQ(reader.read(0), 2u);
    EXPECT_EQ(reader.read(1), 10u);
    EXPECT_EQ(reader.read(2), 99u);
    EXPECT_EQ(reader.name(1), "late_cycles");
}

TEST(Counters, RefuseMemoryThatIsNotAligned) {
    Segment segment = Segment::create("knurl-test", 4096);
    EXPECT_THROW(Counters(segment.data() + 8, names), std::invalid_argument);
}

}  // namespace
}  // namespace knurl::shm
