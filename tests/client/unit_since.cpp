// newest(): the edges and contacts that it reports, whichever reports in between were read.

#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <since.hpp>

namespace {

using namespace knurl;

/// The buttons and contacts in a servo's reports.
struct Servo {
    Report report;
    Report cycle(std::uint32_t buttons, bool touching = false) {
        ++report.cycle;
        report.presses ^= buttons & ~report.buttons;
        report.buttons = buttons;
        report.touches += touching && (report.flags & report_flags::touching) == 0 ? 1 : 0;
        report.flags = touching ? report_flags::touching : 0;
        return report;
    }
};

HandFrame told(detail::Since& since, const Report& newest) {
    HandFrame frame;
    static_cast<Report&>(frame) = newest;
    since.tell(frame);
    return frame;
}

TEST(Since, APressIsToldWhetherItsReportsWereReadOrNot) {
    for (const bool read : {true, false}) {
        SCOPED_TRACE(read);
        Servo servo;
        detail::Since since;
        since.add(servo.cycle(0x4));
        EXPECT_EQ(told(since, servo.report).pressed, 0u) << "held from the start: no edge was seen";
        const auto step = [&](std::uint32_t buttons) {
            servo.cycle(buttons);
            if (read) since.add(servo.report);
        };
        step(0x5), step(0x4), step(0x0), step(0x2);
        since.add(servo.cycle(0x2));
        const HandFrame frame = told(since, servo.report);
        EXPECT_EQ(frame.pressed, 0x3u);
        EXPECT_EQ(frame.released, 0x5u);
        EXPECT_EQ(frame.skipped, 4u);
        since.add(servo.cycle(0x2));
        const HandFrame next = told(since, servo.report);
        EXPECT_EQ(next.pressed | next.released, 0u) << "each edge is told once";
        EXPECT_EQ(next.skipped, 0u);
    }
}

TEST(Since, AGapThatBeginsAndEndsAlikeTellsTheEdgesBetween) {
    Servo servo;
    detail::Since since;
    since.add(servo.cycle(0x1));
    servo.cycle(0x0);
    since.add(servo.cycle(0x1));
    const HandFrame let_go = told(since, servo.report);
    EXPECT_EQ(let_go.pressed, 0x1u);
    EXPECT_EQ(let_go.released, 0x1u);
    // Pressed twice, with one release in between.
    since.add(servo.cycle(0x0));
    told(since, servo.report);
    servo.cycle(0x1), servo.cycle(0x0);
    since.add(servo.cycle(0x1));
    const HandFrame twice = told(since, servo.report);
    EXPECT_EQ(twice.pressed, 0x1u);
    EXPECT_EQ(twice.released, 0x1u);
}

TEST(Since, ContactsAreCountedAndToldThoughTheyHaveEnded) {
    Servo servo;
    detail::Since since;
    since.add(servo.cycle(0));
    EXPECT_FALSE(told(since, servo.report).touched);
    servo.cycle(0, true), servo.cycle(0), servo.cycle(0, true), servo.cycle(0);
    since.add(servo.report);
    const HandFrame frame = told(since, servo.report);
    EXPECT_TRUE(frame.touched);
    EXPECT_EQ(frame.touches, 2u);
    since.add(servo.cycle(0));
    EXPECT_FALSE(told(since, servo.report).touched);
    EXPECT_EQ(told(since, servo.report).touches, 0u);
}

TEST(Since, WhenEveryReportIsReadNoEdgeIsMissedAndNoneIsMadeUp) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Servo servo;
    detail::Since since;
    since.add(servo.cycle(0));
    std::uint32_t pressed = 0, released = 0, before = 0;
    for (int i = 0; i < 20'000; ++i) {
        const auto buttons = static_cast<std::uint32_t>(random() & random());
        pressed |= buttons & ~before;
        released |= before & ~buttons;
        before = buttons;
        since.add(servo.cycle(buttons));
        if (random() % 5 != 0) continue;
        const HandFrame frame = told(since, servo.report);
        ASSERT_EQ(frame.pressed, pressed);
        ASSERT_EQ(frame.released, released);
        pressed = released = 0;
    }
}

}  // namespace
