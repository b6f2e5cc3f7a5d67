// Servo and guardian, each of which watches the other, in every order of three changes: each notices that the other
// stands still, in time, and neither raises a false alarm. Wrong twins, which see nothing, must be found.

#include <array>
#include <string>

#include <gtest/gtest.h>

#include <knurl/servo/guardian.hpp>

namespace knurl::servo::core_standstill_tests {
namespace {

/// The two processes, each of which watches the other, in steps of 1 ms while force is on.
struct Pair {
    static constexpr Nanoseconds ms = 1'000'000;
    StallWatch stall{20 * ms};
    GuardianWatch watch{GuardianWatch::patience};
    Nanoseconds now = 1000 * ms;
    std::uint64_t reports = 0, beat = 0;
    bool servo_stopped = false, servo_hangs = false, guardian_stopped = false;
    bool zeroed = false;                                    // since the servo ran last
    bool told = false;                                      // the servo, in its last cycle
    int servo_still = 0, guardian_still = 0, both_ran = 0;  // ms

    bool servo_runs() const { return !servo_stopped && !servo_hangs; }

    void tick(bool deaf_guardian, bool deaf_servo) {
        now += ms;
        bool acted = false;
        if (!guardian_stopped) {
            ++beat;
            acted = !deaf_guardian && stall.tick(now, reports, true, servo_stopped);
        }
        if (servo_runs()) {
            ++reports;
            told = !deaf_servo && watch.still(now, beat);
            zeroed = false;
        }
        zeroed = zeroed || acted;
        // Time in which the one stood still and the other ran without a break.
        servo_still = !servo_runs() && !guardian_stopped ? servo_still + 1 : 0;
        guardian_still = guardian_stopped && servo_runs() ? guardian_still + 1 : 0;
        both_ran = servo_runs() && !guardian_stopped ? both_ran + 1 : 0;
        false_alarm = both_ran > 2 && (acted || told);
    }
    bool false_alarm = false;

    std::string judged() const {
        if (servo_stopped && servo_still > 4 && !zeroed) return "a stopped servo's device keeps its force";
        if (servo_still > 24 && !zeroed) return "a servo that hangs keeps its force";
        if (guardian_still > 42 && !told) return "the servo does not notice that its guardian stands still";
        if (false_alarm) return "an alarm while both run";
        return "";
    }
};

/// Up to three changes, of any kind, in steps of 2 ms in 70 ms; then 60 ms more.
std::string explore_pair(bool deaf_guardian, bool deaf_servo) {
    constexpr int last = 70;
    for (int kinds = 0; kinds < 27; ++kinds)
        for (int first = 0; first < last; first += 2)
            for (int second = first; second < last; second += 2)
                for (int third = second; third < last; third += 2) {
                    Pair pair;
                    const std::array times{first, second, third};
                    const std::array which{kinds % 3, kinds / 3 % 3, kinds / 9};
                    for (int t = 0; t < last + 60; ++t) {
                        for (std::size_t i = 0; i < 3; ++i) {
                            if (times[i] != t) continue;
                            bool& changes = which[i] == 0   ? pair.servo_stopped
                                            : which[i] == 1 ? pair.servo_hangs
                                                            : pair.guardian_stopped;
                            changes = !changes;
                        }
                        pair.tick(deaf_guardian, deaf_servo);
                        if (const std::string what = pair.judged(); !what.empty())
                            return what + ", after changes " + std::to_string(kinds) + " at " +
                                   std::to_string(first) + ", " + std::to_string(second) + ", " +
                                   std::to_string(third) + " ms";
                    }
                }
    return "";
}

TEST(Standstill, ServoAndGuardianNoticeEachOthersStandstillAndRaiseNoFalseAlarm) {
    EXPECT_EQ(explore_pair(false, false), "");
    EXPECT_NE(explore_pair(true, false), "") << "a wrong twin: the guardian sees nothing";
    EXPECT_NE(explore_pair(false, true), "") << "a wrong twin: the servo sees nothing";
}

}  // namespace
}  // namespace knurl::servo::core_standstill_tests
