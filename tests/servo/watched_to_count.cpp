// Cycles in contact with a plane that changes 20 times a second, for callgrind to count: watched_cycles.py judges.
// Usage: knurl_cycles_that_are_watched plain|watched CYCLES

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <knurl/reps/plane.hpp>
#include <knurl/servo/offline.hpp>
#include <knurl/servo/scene_log.hpp>

#include "table_arm.hpp"

using namespace knurl;
using namespace knurl::servo;

int main(int count, char** words) {
    if (count != 3) return 2;
    const bool watched = std::string_view(words[1]) == "watched";
    const int cycles = std::atoi(words[2]);

    TableArm arm;
    VirtualClock clock;
    OfflineMemory segment(protocol::device_layout().total), memory(scene_log_bytes);
    RecordLog log(memory.data(), scene_log_slots);
    ServoOptions options;
    options.start_active = true;
    options.silence = false;
    Servo servo(arm, clock, segment.data(), options);
    Nanoseconds now = 0;
    ClaimTerms terms;
    terms.limits = limits_for(arm.link(), 1000, terms.frame);
    OfflineClaim claim(terms);
    servo.adopt(&claim.servo_side());
    Plane plane{.offset = 1.0, .stiffness = 20, .recovery = 0.05};
    const RepresentationId id = claim.add(plane);
    claim.commit();
    if (watched) servo.show_scenes(&log);
    for (int i = 0; i < cycles; ++i) {
        if (i % 50 == 0) {
            plane.offset = plane.offset > 1 ? 1 : 1 + 1e-4;
            claim.update(id, plane);
            claim.commit();
        }
        clock.time = now;
        servo.step(now, now);
        now += 1'000'000;
    }
    const std::uint64_t written = watched ? RecordLog::written(memory.data(), scene_log_slots) : 0;
    std::printf("%llu slots of the scene log, effort %g\n", static_cast<unsigned long long>(written),
                arm.efforts()[0]);
    return watched && written < static_cast<std::uint64_t>(cycles / 50);
}
