// A counterfeit of Force Dimension's libdhd, written from the documentation of its functions: the same names and return
// codes, calls that block for as long as an exchange over USB, one device a handle. Its hardware is control.hpp's file.
// Built also without one of its functions, as another version would be.

#include <csignal>

#include "control.hpp"

namespace {

using namespace knurl::counterfeit;

constexpr int ok = 0, failed = -1, guarded = 1;
int last_error = 0;
bool expert = false;

Device* of(char id) {
    Control* control = hardware();
    const auto index = static_cast<std::size_t>(id < 0 ? 0 : id);
    if (control == nullptr || index >= control->devices.load()) return nullptr;
    return &control->device[index];
}
int fail(int error) {
    last_error = error;
    return failed;
}
/// An exchange with the device: nullptr if it fails.
Device* reach(char id) {
    Device* device = of(id);
    if (device == nullptr || device->plugged.load() == 0 || device->opened_by.load() == 0) {
        last_error = 5;
        return nullptr;
    }
    if (hardware()->has(Fault::com_error)) {
        last_error = 2;
        return nullptr;
    }
    exchange_takes(*hardware());
    return device;
}
[[maybe_unused]] bool refused() {
    Control& control = *hardware();
    if (!control.has(Fault::refuse_once) || control.left.load() == 0) return false;
    control.left.fetch_sub(1);
    last_error = 7;
    return true;
}

int open_device(std::size_t index) {
    Control* control = hardware();
    if (control == nullptr || index >= control->devices.load()) return fail(5);
    if (control->has(Fault::hang_in_open)) hang();
    if (control->has(Fault::crash_in_open)) crash();
    Device& device = control->device[index];
    if (device.plugged.load() == 0) return fail(5);
    const std::uint32_t other = device.opened_by.load();
    if (other != 0 && other != static_cast<std::uint32_t>(getpid()) &&
        kill(static_cast<pid_t>(other), 0) == 0)
        return fail(20);
    device.opened_by = static_cast<std::uint32_t>(getpid());
    device.enabled = 0;
    device.braked = 1;
    device.watchdog = 0;
    return static_cast<int>(index);
}

int set(char id, const std::array<double, axes>& force) {
    if (hardware() != nullptr && hardware()->has(Fault::hang_in_force)) hang();
    Device* device = reach(id);
    if (device == nullptr) return failed;
    if (hardware()->has(Fault::refuse_force)) return fail(1);
    const double alive = device->watchdog.load();
    if (alive > 0 && device->forced.load() > 0 && device->enabled.load() != 0 &&
        static_cast<double>(now_ns() - device->forced.load()) * 1e-9 > alive) {
        device->enabled = 0;
        device->off_cause = 3;
    }
    give(*device, force);
    return ok;
}

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
    Control* control = hardware();
    *major = control == nullptr ? 3 : static_cast<int>(control->major.load());
    *minor = control == nullptr ? 17 : static_cast<int>(control->minor.load());
    *release = *revision = 1;
}
int dhdErrorGetLast() {
    return last_error;
}
const char* dhdErrorGetLastStr() {
    switch (last_error) {
        case 2:
            return "communication error";
        case 5:
            return "no device found";
        case 7:
            return "timeout";
        case 20:
            return "device already in use";
        default:
            return "undocumented error";
    }
}
int dhdGetDeviceCount() {
    Control* control = hardware();
    if (control == nullptr) return 0;
    int count = 0;
    for (std::size_t i = 0; i < control->devices.load(); ++i)
        count += control->device[i].plugged.load() != 0 ? 1 : 0;
    return count;
}
int dhdOpenID(char id) {
    return open_device(static_cast<std::size_t>(id));
}
int dhdOpenSerial(int serial) {
    Control* control = hardware();
    for (std::size_t i = 0; control != nullptr && i < control->devices.load(); ++i)
        if (static_cast<int>(control->device[i].serial.load()) == serial) return open_device(i);
    return fail(5);
}
int dhdClose(char id) {
    if (hardware() != nullptr && hardware()->has(Fault::hang_in_close)) hang();
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    device->opened_by = 0;
    return ok;
}
int dhdStop(char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    device->enabled = 0;
    device->braked = 1;
    return ok;
}
int dhdGetSerialNumber(unsigned short* serial, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    *serial = static_cast<unsigned short>(device->serial.load());
    return ok;
}
int dhdGetSystemType(char id) {
    Device* device = of(id);
    return device == nullptr ? fail(5) : static_cast<int>(device->type.load());
}
const char* dhdGetSystemName(char) {
    return "counterfeit";
}
int dhdGetStatus(int* status, char id) {
    Device* device = reach(id);
    if (device == nullptr) return failed;
    std::fill_n(status, 17, 0);
    const bool on = device->enabled.load() != 0 && device->forces_allowed.load() != 0;
    status[0] = status[1] = status[2] = 1;
    status[3] = static_cast<int>(device->homed.load());
    status[5] = on ? 1 : 0;
    status[9] = hardware()->has(Fault::device_error) ? 1 : 0;
    status[10] = static_cast<int>(device->gravity.load());
    status[14] = on ? 0 : device->forces_allowed.load() == 0 ? 1 : static_cast<int>(device->off_cause.load());
    return ok;
}
int dhdEnableForce(unsigned char on, char id) {
    Device* device = reach(id);
    if (device == nullptr) return failed;
    device->enabled = on;
    device->braked = on != 0 ? 0 : 1;
    device->forced = now_ns();
    return ok;
}
int dhdSetGravityCompensation(int on, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    device->gravity = static_cast<std::uint32_t>(on);
    return ok;
}
#ifndef KNURL_COUNTERFEIT_WITHOUT_POSITION
int dhdGetPosition(double* x, double* y, double* z, char id) {
    Control* control = hardware();
    if (control != nullptr && control->has(Fault::hang_in_position)) hang();
    if (control != nullptr && control->has(Fault::crash_in_position)) crash();
    Device* device = reach(id);
    if (device == nullptr || refused()) return failed;
    if (!control->has(Fault::time_guard)) move(*device);
    device->positions.fetch_add(1);
    *x = counted(*device, 0);
    *y = counted(*device, 1);
    *z = counted(*device, 2);
    if (control->has(Fault::nan)) *y = std::nan("");
    return control->has(Fault::time_guard) ? guarded : ok;
}
#endif
int dhdGetOrientationFrame(double* rows, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    // Rodrigues' formula, by elements.
    const double x = device->position[3], y = device->position[4], z = device->position[5];
    const double angle = std::sqrt(x * x + y * y + z * z);
    const double s = angle > 0 ? std::sin(angle) / angle : 1;
    const double c = angle > 0 ? (1 - std::cos(angle)) / (angle * angle) : 0.5;
    const double skew[9] = {0, -z, y, z, 0, -x, -y, x, 0};
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            double square = 0;
            for (int k = 0; k < 3; ++k) square += skew[3 * row + k] * skew[3 * k + column];
            rows[3 * row + column] = (row == column ? 1 : 0) + s * skew[3 * row + column] + c * square;
        }
    if (hardware()->has(Fault::no_rotation)) rows[4] = 7;
    return ok;
}
int dhdGetGripperGap(double* gap, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    *gap = device->position[6];
    return ok;
}
unsigned dhdGetButtonMask(char id) {
    Device* device = of(id);
    return device == nullptr ? 0 : device->buttons.load();
}
int dhdSetForce(double x, double y, double z, char id) {
    return set(id, {x, y, z});
}
int dhdSetForceAndTorqueAndGripperForce(double x, double y, double z, double tx, double ty, double tz,
                                        double grip, char id) {
    return set(id, {x, y, z, tx, ty, tz, grip});
}
bool dhdHasWrist(char id) {
    Device* device = of(id);
    return device != nullptr && device->wrist.load() != 0;
}
bool dhdHasActiveWrist(char id) {
    Device* device = of(id);
    return device != nullptr && device->active_wrist.load() != 0;
}
bool dhdHasGripper(char id) {
    Device* device = of(id);
    return device != nullptr && device->gripper.load() != 0;
}
bool dhdHasActiveGripper(char id) {
    Device* device = of(id);
    return device != nullptr && device->active_gripper.load() != 0;
}
int dhdEnableExpertMode() {
    expert = true;
    return ok;
}
int dhdDisableExpertMode() {
    expert = false;
    return ok;
}
int dhdSetWatchdog(unsigned char units, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    if (!expert) return fail(9);
    if (device->no_watchdog.load() != 0) return fail(6);
    device->watchdog = units * 125e-6;
    return ok;
}
int dhdGetWatchdog(unsigned char* units, char id) {
    Device* device = of(id);
    if (device == nullptr || device->no_watchdog.load() != 0) return fail(6);
    *units = static_cast<unsigned char>(std::lround(device->watchdog.load() / 125e-6));
    return ok;
}
int dhdSetBaseAngleXDeg(double angle, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    device->base_x = angle;
    return ok;
}
int dhdSetBaseAngleZDeg(double angle, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    device->base_z = angle;
    return ok;
}
int dhdSetEffectorMass(double mass, char id) {
    Device* device = of(id);
    if (device == nullptr) return fail(5);
    device->tool = mass;
    return ok;
}
}
#pragma GCC visibility pop
