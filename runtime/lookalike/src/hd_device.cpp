// Devices and frames, capabilities, calibration, errors.

#include <algorithm>
#include <cmath>

#include <knurl/gateway/frames.hpp>

#include "hd_state.hpp"

namespace knurl::lookalike::hd {

namespace {

constexpr gateway::Axes back = gateway::frames::openhaptics.back();
constexpr double newton_metre = 1e-3;  // of their mN m

/// Which bit of Device::enabled. Throws Refused.
std::uint32_t bit_of(HDenum capability) {
    if (capability < HD_FORCE_OUTPUT || capability > HD_ONE_FRAME_LIMIT) throw Refused{HD_INVALID_ENUM};
    return 1u << (capability - HD_FORCE_OUTPUT);
}

void begin(HHD handle) {
    const auto device = device_of(handle);
    make_current(handle);
    const auto newest = device->hand.newest();
    const std::uint64_t now = turn();
    const std::lock_guard lock(device->mutex);
    const bool within = device->open_frames++ > 0;  // another one: the same snapshot
    // The frame is begun all the same, so that its end is no second mistake; the program goes on with what it knew.
    if (!newest) throw Refused{HD_COMM_ERROR};
    if (within) return;
    // Two callbacks of a turn see one state of the device, and the second adds to the first one's force.
    if (device->any_frame && device->tick == now) return;
    device->last = device->now;
    device->now = {.report = *newest, .force = {}, .torque = {}, .commanded = false};
    device->any_frame = true;
    device->tick = now;
}

void end(HHD handle) {
    const auto device = device_of(handle);
    Vec3 force, torque;
    {
        const std::lock_guard lock(device->mutex);
        if (device->open_frames == 0) throw Refused{HD_ILLEGAL_END};
        if (--device->open_frames > 0) return;
        if ((device->enabled & bit_of(HD_FORCE_OUTPUT)) == 0) return;
        if (device->now.commanded) {
            device->held_force = device->now.force;
            device->held_torque = device->now.torque;
        }
        force = back.direction(device->held_force);
        const Vec3 turned = back.axial(device->held_torque);
        torque = {newton_metre * turned.x, newton_metre * turned.y, newton_metre * turned.z};
    }
    if (device->hand.push(force, torque) == Pushed::not_armed && device->hand.force_allowed())
        throw Refused{HD_DEVICE_FAULT};
}

void enable(HDenum capability, bool on) {
    const std::uint32_t bit = bit_of(capability);
    const auto device = current();
    {
        const std::lock_guard lock(device->mutex);
        device->enabled = on ? device->enabled | bit : device->enabled & ~bit;
        if (capability == HD_FORCE_OUTPUT && !on) device->held_force = device->held_torque = {};
    }
    if (capability != HD_FORCE_OUTPUT) return;
    device->hand.allow_force(on);
    if (on && !device->hand.arm()) throw Refused{HD_DEVICE_FAULT};
}

HDenum calibration() {
    const auto newest = current()->hand.newest();
    if (!newest) throw Refused{HD_COMM_ERROR};
    // Drivers calibrate; one that waits for a hand to move the device there is not connected yet.
    return newest->state == DeviceState::disconnected ? HD_CALIBRATION_NEEDS_MANUAL_INPUT : HD_CALIBRATION_OK;
}

constexpr std::pair<HDerror, const char*> texts[] = {
    {HD_SUCCESS, "no error"},
    {HD_INVALID_ENUM, "invalid enumerator"},
    {HD_INVALID_VALUE, "invalid value"},
    {HD_INVALID_OPERATION, "invalid operation, or not available"},
    {HD_BAD_HANDLE, "bad device handle"},
    {HD_WARM_MOTORS, "warm motors"},
    {HD_EXCEEDED_MAX_FORCE, "exceeded the largest force"},
    {HD_EXCEEDED_MAX_FORCE_IMPULSE, "exceeded the largest change of force"},
    {HD_EXCEEDED_MAX_VELOCITY, "exceeded the largest velocity"},
    {HD_FORCE_ERROR, "force error"},
    {HD_DEVICE_FAULT, "device fault: it is held by another program, or not armed; see `knurl top`"},
    {HD_DEVICE_ALREADY_INITIATED, "device already initialised"},
    {HD_COMM_ERROR, "communication error: no servo or device; see `knurl ls`"},
    {HD_COMM_CONFIG_ERROR, "communication configuration error"},
    {HD_TIMER_ERROR, "timer error"},
    {HD_ILLEGAL_BEGIN, "illegal begin of a frame"},
    {HD_ILLEGAL_END, "end of a frame that was not begun"},
    {HD_FRAME_ERROR, "frame error"},
    {HD_INVALID_PRIORITY, "invalid priority"},
    {HD_SCHEDULER_FULL, "scheduler full"},
    {HD_INVALID_LICENSE, "invalid license"},
};

}  // namespace

}  // namespace knurl::lookalike::hd

using namespace knurl::lookalike::hd;

extern "C" {

HHD hdInitDevice(HDstring name) {
    return call([=] { return open(name); }, HD_INVALID_HANDLE);
}
void hdDisableDevice(HHD handle) {
    call([=] { close_device(handle); });
}
HHD hdGetCurrentDevice(void) {
    // Programs ask before they initialise anything, and compare with the first handle, which is 0.
    const HHD handle = current_handle();
    return handle == HD_INVALID_HANDLE ? 0 : handle;
}
void hdMakeCurrentDevice(HHD handle) {
    call([=] {
        device_of(handle);
        make_current(handle);
    });
}
void hdBeginFrame(HHD handle) {
    call([=] { begin(handle); });
}
void hdEndFrame(HHD handle) {
    call([=] { end(handle); });
}

HDErrorInfo hdGetError(void) {
    return take_error();
}
HDstring hdGetErrorString(HDerror code) {
    for (const auto& [number, text] : texts)
        if (number == code) return text;
    return "unknown error";
}

void hdEnable(HDenum capability) {
    call([=] { enable(capability, true); });
}
void hdDisable(HDenum capability) {
    call([=] { enable(capability, false); });
}
HDboolean hdIsEnabled(HDenum capability) {
    return call(
        [=] {
            const std::uint32_t bit = bit_of(capability);
            const auto device = current();
            const std::lock_guard lock(device->mutex);
            return static_cast<HDboolean>((device->enabled & bit) != 0 ? 1 : 0);
        },
        HDboolean{0});
}

HDenum hdCheckCalibration(void) {
    return call([] { return calibration(); }, HDenum{HD_CALIBRATION_NEEDS_MANUAL_INPUT});
}
HDenum hdCheckCalibrationStyle(void) {
    return HD_CALIBRATION_AUTO;
}
void hdUpdateCalibration(HDenum) {
    call([] { calibration(); });
}
void hdUpdateCalibrationMessage(HDenum) {
    call([] { calibration(); });
}
void hdScaleGimbalAngles(HDdouble, HDdouble, HDdouble, HDdouble*) {
    not_available("hdScaleGimbalAngles");
}
HDboolean hdDeploymentLicense(HDstring, HDstring, HDstring) {
    return 1;  // nothing of theirs is here to be licensed
}

}  // extern "C"
