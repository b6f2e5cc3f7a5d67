#pragma once
// The two channels of a claim, and their effects.

#include <knurl/reps/plane.hpp>

#include "core_support.hpp"

namespace knurl::servo::testing {

/// Offline, the hand 1 mm below z = 0, no fades: forces show at once what is in force.
struct ClaimFixture {
    PuppetDevice device;
    Offline servo{device};
    OfflineClaim& claim = servo.claim();
    ClaimFixture() { device.tip = {0, 0, -1e-3}; }

    static Plane plane(double stiffness) { return {.stiffness = stiffness, .recovery = 0}; }
    double force() { return servo.step().scene_force.z; }
    Verdict::Code code(std::size_t i = 0) { return static_cast<Verdict::Code>(claim.replies().at(i).code); }
};

}  // namespace knurl::servo::testing
