// What one cycle does, seen from the device and from the report.

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;

TEST(Cycle, OfflineASceneOfTheFirstCycleIsInFullForceAtOnce) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-3};
    Offline servo(device);
    servo.claim().add(Plane{.stiffness = 800});

    const Report& report = servo.step();

    EXPECT_EQ(report.cycle, 1u);
    EXPECT_EQ(report.state, DeviceState::active);
    EXPECT_DOUBLE_EQ(report.scene_force.z, 0.8);
    EXPECT_DOUBLE_EQ(device.force().z(), 0.8);
    EXPECT_EQ(report.flags & report_flags::touching, report_flags::touching);
    EXPECT_NEAR(report.contact_point.z, 0, 1e-15);
}

TEST(Cycle, OfflineALaterChangeIsFadedOverTenMilliseconds) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-3};
    Offline servo(device);
    OfflineClaim& claim = servo.claim();
    const Handle plane = claim.add(Plane{.stiffness = 800});
    run(servo, 3);

    claim.update(plane, Plane{.stiffness = 400});
    claim.commit();

    double last = 0.8;
    for (int i = 0; i < 12; ++i) {
        const double force = servo.step().scene_force.z;
        EXPECT_LE(force, last + 1e-12);
        EXPECT_LE(last - force, 0.4 / 10 + 1e-12) << "cycle " << i;
        last = force;
    }
    EXPECT_NEAR(last, 0.4, 1e-12);
}

}  // namespace
}  // namespace knurl::servo
