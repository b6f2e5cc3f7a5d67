// Where a cycle's time goes, as `knurl top` shows it.

#include <gtest/gtest.h>
#include <stage_clock.hpp>

#include <knurl/protocol/device_segment.hpp>

#include "core_support.hpp"

namespace knurl::servo::testing {
namespace {

using protocol::Count;

/// Each look at it takes 100 ns.
class TickingClock final : public Clock {
  public:
    Nanoseconds now() noexcept override { return time += 100; }
    Nanoseconds time = 0;
};

TEST(Parts, OneCycleIn64IsStampedAndItsPartsAddUp) {
    TickingClock clock;
    StageClock stages(clock);
    for (std::uint64_t cycle = 1; cycle <= 640; ++cycle) {
        const Nanoseconds before = clock.time;
        stages.begin(cycle, clock.time);
        clock.time += 1000;  // the device was read
        stages.end(Stage::read);
        stages.end(Stage::kinematics);
        clock.time += 500;
        stages.end(Stage::scenes);
        EXPECT_EQ(clock.time - before, cycle % 64 == 0 ? 1800 : 1500)
            << "the others do not look at the clock";
    }
    EXPECT_EQ(stages.stamped(), 10u);
    EXPECT_EQ(stages.sum(Stage::read), 10 * 1100u);
    EXPECT_EQ(stages.sum(Stage::kinematics), 10 * 100u);
    EXPECT_EQ(stages.sum(Stage::scenes), 10 * 600u);
    EXPECT_EQ(stages.sum(Stage::publish), 0u);
}

TEST(Parts, AClockThatIsSetBackTakesNoTimeBack) {
    TickingClock clock;
    StageClock stages(clock);
    stages.begin(64, 5000);
    stages.end(Stage::read);
    EXPECT_EQ(stages.sum(Stage::read), 0u);
}

TEST(Parts, TheServoCountsThem) {
    PuppetDevice device;
    Offline servo(device, live_options());
    run(servo, 63);
    EXPECT_EQ(servo.count(Count::stamped_cycles), 0u);
    run(servo, 577);
    EXPECT_EQ(servo.count(Count::stamped_cycles), 10u);
    EXPECT_EQ(servo.count(Count::read_ns), 0u) << "its clock stands still within a cycle";
}

}  // namespace
}  // namespace knurl::servo::testing
