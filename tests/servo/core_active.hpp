#pragma once
// A servo in the middle of its work.

#include <knurl/reps/plane.hpp>

#include "core_support.hpp"

namespace knurl::servo::testing {

/// Active with a plane under the hand, 1 mm deep: 0.5 N.
struct Active {
    PuppetDevice device;
    Offline servo;
    OfflineClaim& claim;

    explicit Active(const ServoOptions& options = without_silence())
        : servo(device, options), claim(servo.claim()) {
        device.tip = {0, 0, -1e-3};
        claim.add(Plane{.stiffness = 500, .recovery = 0});
        claim.arm();
        run(servo, 600);
        EXPECT_EQ(state(), DeviceState::active);
        EXPECT_NEAR(device.force().z(), 0.5, 1e-12);
    }
    static ServoOptions without_silence() {
        ServoOptions options = live_options();
        options.silence = false;
        return options;
    }
    DeviceState state() { return servo.servo().last().state; }
    std::uint32_t faults() { return servo.servo().last().faults; }
};

}  // namespace knurl::servo::testing
