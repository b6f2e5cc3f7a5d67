// Where the hand is, how fast, what it presses; and what there is none of here: grippers.

#include <cmath>
#include <initializer_list>
#include <numbers>

#include <knurl/gateway/frames.hpp>

#include "dhd.h"
#include "dhd_state.hpp"
#include "drd.h"

namespace knurl::lookalike::dhd {

namespace {

/// Their axes, Knurl's today: one place says so.
constexpr gateway::Axes axes = gateway::frames::force_dimension;

/// Radians, degrees.
constexpr double as_is = 1, degrees = 180 / std::numbers::pi;

/// Angles of the wrist's joints, as the servo has them; 0 without a wrist.
Vec3 wrist(const Opened& device, const HandReport& report) {
    if (!device.hand.device().senses_orientation) return {};
    return {report.joints[3], report.joints[4], report.joints[5]};
}

/// Columns are the tool's axes in the device's frame.
void give_matrix(const Quat& q, double* matrix) {
    require(matrix);
    const double rows[3][3] = {
        {1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z), 2 * (q.x * q.z + q.w * q.y)},
        {2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x)},
        {2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}};
    for (std::size_t i = 0; i < 9; ++i) matrix[i] = rows[i / 3][i % 3];
}

int give_position_and_angles(double* x, double* y, double* z, double* a, double* b, double* c, double scale,
                             char id) {
    return call([=] {
        require(x, y, z, a, b, c);
        const auto device = opened(id);
        const HandReport now = report(*device);
        give(axes.position(now.position), x, y, z);
        give(wrist(*device, now), a, b, c, scale);
        return 0;
    });
}

/// No device here has a gripper. What the program reads is set all the same: programs seldom look at what is returned.
int no_gripper(const char* function, std::initializer_list<double*> out) {
    for (double* one : out)
        if (one != nullptr) *one = 0;
    return not_available(function);
}

/// A base that stands as it is: every angle is 0.
int upright(double* angle, char id) {
    return call([=] {
        require(angle);
        opened(id);
        return *angle = 0, 0;
    });
}

int stand(const char* function, double angle, char id) {
    return call([=] {
        opened(id);
        return angle == 0 ? 0 : not_available(function);
    });
}

}  // namespace

}  // namespace knurl::lookalike::dhd

using namespace knurl::lookalike::dhd;

extern "C" {

int dhdGetPosition(double* x, double* y, double* z, char id) {
    return call([=] { return give(axes.position(report(id).position), x, y, z), 0; });
}
int dhdGetLinearVelocity(double* x, double* y, double* z, char id) {
    return call([=] { return give(axes.position(report(id).velocity), x, y, z), 0; });
}
int dhdGetAngularVelocityRad(double* x, double* y, double* z, char id) {
    return call([=] { return give(axes.axial(report(id).angular_velocity), x, y, z), 0; });
}
int dhdGetAngularVelocityDeg(double* x, double* y, double* z, char id) {
    return call([=] { return give(axes.axial(report(id).angular_velocity), x, y, z, degrees), 0; });
}
int dhdGetOrientationRad(double* a, double* b, double* c, char id) {
    return call([=] {
        const auto device = opened(id);
        return give(wrist(*device, report(*device)), a, b, c), 0;
    });
}
int dhdGetOrientationDeg(double* a, double* b, double* c, char id) {
    return call([=] {
        const auto device = opened(id);
        return give(wrist(*device, report(*device)), a, b, c, degrees), 0;
    });
}
int dhdGetOrientationFrame(double* matrix, char id) {
    return call([=] { return give_matrix(axes.orientation(report(id).orientation), matrix), 0; });
}
int dhdGetPositionAndOrientationRad(double* x, double* y, double* z, double* a, double* b, double* c,
                                    char id) {
    return give_position_and_angles(x, y, z, a, b, c, as_is, id);
}
int dhdGetPositionAndOrientationDeg(double* x, double* y, double* z, double* a, double* b, double* c,
                                    char id) {
    return give_position_and_angles(x, y, z, a, b, c, degrees, id);
}
int dhdGetPositionAndOrientationFrame(double* x, double* y, double* z, double* matrix, char id) {
    return call([=] {
        require(x, y, z, matrix);
        const knurl::HandReport now = report(id);
        give(axes.position(now.position), x, y, z);
        give_matrix(axes.orientation(now.orientation), matrix);
        return 0;
    });
}

int drdGetPositionAndOrientation(double* x, double* y, double* z, double* a, double* b, double* c,
                                 double* gripper, double* matrix, char id) {
    if (gripper != nullptr) *gripper = 0;
    return call([=] {
        require(x, y, z, a, b, c, matrix);
        const auto device = opened(id);
        const knurl::HandReport now = report(*device);
        give(axes.position(now.position), x, y, z);
        give(wrist(*device, now), a, b, c);
        give_matrix(axes.orientation(now.orientation), matrix);
        return 0;
    });
}
int drdGetVelocity(double* x, double* y, double* z, double* a, double* b, double* c, double* gripper,
                   char id) {
    if (gripper != nullptr) *gripper = 0;
    return call([=] {
        require(x, y, z, a, b, c);
        const knurl::HandReport now = report(id);
        give(axes.position(now.velocity), x, y, z);
        give(axes.axial(now.angular_velocity), a, b, c);
        return 0;
    });
}

int dhdGetJointAngles(double* angles, char id) {
    return call([=] {
        require_expert();
        require(angles);
        const auto device = opened(id);
        const knurl::HandReport now = report(*device);
        const std::size_t sensed = device->hand.device().senses_orientation ? 6 : 3;
        for (std::size_t i = 0; i < now.joints.size(); ++i) angles[i] = i < sensed ? now.joints[i] : 0;
        return 0;
    });
}
int dhdGetDeltaJointAngles(double* a, double* b, double* c, char id) {
    return call([=] {
        require_expert();
        const knurl::HandReport now = report(id);
        return give({now.joints[0], now.joints[1], now.joints[2]}, a, b, c), 0;
    });
}
int dhdGetWristJointAngles(double* a, double* b, double* c, char id) {
    return call([=] { return require_expert(), dhdGetOrientationRad(a, b, c, id); });
}

int dhdGetButton(int index, char id) {
    return call([=] {
        if (index < 0 || index > 31) throw Refused{Code::invalid_index};
        return static_cast<int>(report(id).buttons >> index & 1u);
    });
}
unsigned dhdGetButtonMask(char id) {
    return call([=] { return report(id).buttons; }, 0u);
}

int dhdConfigLinearVelocity(int, int, char id) {
    return call([=] { return opened(id), 0; });
}
int dhdConfigAngularVelocity(int, int, char id) {
    return call([=] { return opened(id), 0; });
}
int dhdConfigGripperVelocity(int, int, char id) {
    return call([=] { return opened(id), 0; });
}

int dhdGetGripperAngleRad(double* out, char) {
    return no_gripper("dhdGetGripperAngleRad", {out});
}
int dhdGetGripperAngleDeg(double* out, char) {
    return no_gripper("dhdGetGripperAngleDeg", {out});
}
int dhdGetGripperGap(double* out, char) {
    return no_gripper("dhdGetGripperGap", {out});
}
int dhdGetGripperThumbPos(double* x, double* y, double* z, char) {
    return no_gripper("dhdGetGripperThumbPos", {x, y, z});
}
int dhdGetGripperFingerPos(double* x, double* y, double* z, char) {
    return no_gripper("dhdGetGripperFingerPos", {x, y, z});
}
int dhdGetGripperLinearVelocity(double* out, char) {
    return no_gripper("dhdGetGripperLinearVelocity", {out});
}
int dhdGetGripperAngularVelocityRad(double* out, char) {
    return no_gripper("dhdGetGripperAngularVelocityRad", {out});
}
int dhdGetGripperAngularVelocityDeg(double* out, char) {
    return no_gripper("dhdGetGripperAngularVelocityDeg", {out});
}

int dhdGetDeviceAngleRad(double* out, char id) {
    return upright(out, id);
}
int dhdGetDeviceAngleDeg(double* out, char id) {
    return upright(out, id);
}
int dhdGetBaseAngleXRad(double* out, char id) {
    return upright(out, id);
}
int dhdGetBaseAngleXDeg(double* out, char id) {
    return upright(out, id);
}
int dhdGetBaseAngleZRad(double* out, char id) {
    return upright(out, id);
}
int dhdGetBaseAngleZDeg(double* out, char id) {
    return upright(out, id);
}
int dhdSetDeviceAngleRad(double angle, char id) {
    return stand("dhdSetDeviceAngleRad", angle, id);
}
int dhdSetDeviceAngleDeg(double angle, char id) {
    return stand("dhdSetDeviceAngleDeg", angle, id);
}
int dhdSetBaseAngleXRad(double angle, char id) {
    return stand("dhdSetBaseAngleXRad", angle, id);
}
int dhdSetBaseAngleXDeg(double angle, char id) {
    return stand("dhdSetBaseAngleXDeg", angle, id);
}
int dhdSetBaseAngleZRad(double angle, char id) {
    return stand("dhdSetBaseAngleZRad", angle, id);
}
int dhdSetBaseAngleZDeg(double angle, char id) {
    return stand("dhdSetBaseAngleZDeg", angle, id);
}

}  // extern "C"
