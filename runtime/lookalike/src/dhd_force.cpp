// Forces: set again and again by the program's own loop, and all that switches or limits them.

#include <algorithm>
#include <chrono>
#include <cmath>

#include <knurl/gateway/frames.hpp>

#include "dhd.h"
#include "dhd_state.hpp"

namespace knurl::lookalike::dhd {

namespace {

constexpr gateway::Axes back = gateway::frames::force_dimension.back();
/// What dhdSetForce returns beside 0: the force is shortened.
constexpr int motor_saturated = 2;

Vec3 limited(const Vec3& v, double most) {
    const double length = std::hypot(v.x, v.y, v.z);
    if (most < 0 || length <= most) return v;
    const double scale = most / length;
    return {scale * v.x, scale * v.y, scale * v.z};
}

bool finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

int set_force(const Vec3& force, const Vec3& torque, double gripper, char id) {
    return call([&] {
        if (!finite(force) || !finite(torque) || !std::isfinite(gripper)) throw Refused{Code::invalid};
        if (gripper != 0) say_once("no device here has a gripper: its force is ignored");
        const auto device = opened(id);
        if (device->brakes.exchange(false)) device->hand.allow_force(true);  // a force ends the braking
        const Pushed pushed = device->hand.push(back.direction(limited(force, device->most_force)),
                                                back.axial(limited(torque, device->most_torque)));
        // The vendor's call takes as long as the way to the device and back, and loops without a clock rely on it: the
        // second call within a cycle waits for the next.
        device->hand.pace();
        if (pushed == Pushed::not_armed && device->hand.force_allowed()) throw Refused{Code::not_ready};
        return pushed == Pushed::saturated ? motor_saturated : 0;
    });
}

int stop(char id) {
    return call([=] {
        opened(id)->hand.allow_force(false);
        return 0;
    });
}

}  // namespace

}  // namespace knurl::lookalike::dhd

using namespace knurl::lookalike::dhd;
using knurl::lookalike::say_once;

extern "C" {

int dhdSetForce(double x, double y, double z, char id) {
    return set_force({x, y, z}, {}, 0, id);
}
int dhdSetTorque(double a, double b, double c, char id) {
    return set_force({}, {a, b, c}, 0, id);
}
int dhdSetForceAndTorque(double x, double y, double z, double a, double b, double c, char id) {
    return set_force({x, y, z}, {a, b, c}, 0, id);
}
int dhdSetForceAndGripperForce(double x, double y, double z, double gripper, char id) {
    return set_force({x, y, z}, {}, gripper, id);
}
int dhdSetForceAndGripperTorque(double x, double y, double z, double gripper, char id) {
    return set_force({x, y, z}, {}, gripper, id);
}
int dhdSetForceAndTorqueAndGripperForce(double x, double y, double z, double a, double b, double c,
                                        double gripper, char id) {
    return set_force({x, y, z}, {a, b, c}, gripper, id);
}

int dhdGetForce(double* x, double* y, double* z, char id) {
    return call([=] { return give(report(id).sent_force, x, y, z), 0; });
}
int dhdGetTorque(double* a, double* b, double* c, char id) {
    return call([=] { return give(report(id).sent_torque, a, b, c), 0; });
}
int dhdGetForceAndTorque(double* x, double* y, double* z, double* a, double* b, double* c, char id) {
    return call([=] {
        require(x, y, z, a, b, c);
        const knurl::HandReport now = report(id);
        give(now.sent_force, x, y, z);
        return give(now.sent_torque, a, b, c), 0;
    });
}
int dhdGetForceAndTorqueAndGripperForce(double* x, double* y, double* z, double* a, double* b, double* c,
                                        double* gripper, char id) {
    if (gripper != nullptr) *gripper = 0;
    return dhdGetForceAndTorque(x, y, z, a, b, c, id);
}

int dhdEnableForce(unsigned char on, char id) {
    return call([=] {
        const auto device = opened(id);
        device->hand.allow_force(on != 0);
        device->brakes = false;
        if (on != 0 && !device->hand.arm()) throw Refused{Code::not_ready};
        return 0;
    });
}
int dhdStop(char id) {
    return stop(id);
}
int dhdSetBrakes(unsigned char on, char id) {
    return call([=] {
        const auto device = opened(id);
        device->brakes = on != 0;
        device->hand.allow_force(on == 0);
        return 0;
    });
}

int dhdSetMaxForce(double most, char id) {
    return call([=] {
        if (std::isnan(most)) throw Refused{Code::invalid};
        return opened(id)->most_force = most, 0;
    });
}
double dhdGetMaxForce(char id) {
    return call([=] { return std::max(opened(id)->most_force.load(), -1.0); }, -1.0);
}
int dhdSetMaxTorque(double most, char id) {
    return call([=] {
        if (std::isnan(most)) throw Refused{Code::invalid};
        return opened(id)->most_torque = most, 0;
    });
}
double dhdGetMaxTorque(char id) {
    return call([=] { return std::max(opened(id)->most_torque.load(), -1.0); }, -1.0);
}

double dhdGetComFreq(char id) {
    constexpr double kilohertz = 1e-3;
    return call([=] { return kilohertz * opened(id)->hand.rate(); }, 0.0);
}

int dhdSetWatchdog(unsigned char duration, char id) {
    return call([=] {
        require_expert();
        const auto device = opened(id);
        device->watchdog = duration;
        device->hand.set_lapse(std::chrono::microseconds(125) * duration);
        return 0;
    });
}
int dhdGetWatchdog(unsigned char* duration, char id) {
    return call([=] {
        require_expert();
        require(duration);
        return *duration = static_cast<unsigned char>(opened(id)->watchdog), 0;
    });
}
int dhdSetTimeGuard(int, char id) {
    return call([=] { return require_expert(), opened(id), 0; });  // dhdSetForce paces by itself
}

// What is done against gravity a driver does, whatever a program asks. Programs end where this fails.
int dhdSetGravityCompensation(unsigned char, char id) {
    say_once("gravity compensation is the device's own here: dhdSetGravityCompensation has no effect");
    return call([=] { return opened(id), 0; });
}
int dhdSetStandardGravity(double g, char id) {
    return call([=] {
        if (!std::isfinite(g)) throw Refused{Code::invalid};
        return opened(id), 0;
    });
}
int dhdSetEffectorMass(double mass, char id) {
    return call([=] {
        if (!(mass >= 0)) throw Refused{Code::invalid};
        return opened(id)->mass = mass, 0;
    });
}
int dhdGetEffectorMass(double* mass, char id) {
    return call([=] {
        require(mass);
        return *mass = opened(id)->mass, 0;
    });
}

int dhdGetStatus(int* status, char id) {
    return call([=] {
        require(status);
        const auto device = opened(id);
        const knurl::HandReport now = report(*device);
        using knurl::DeviceState;
        enum { power, connected, started, reset, idle, force, brake, torque, wrist, error };
        // As many as the shortest array of a program that is still in use has room for.
        constexpr int fields = 15, redundancy = 13, force_off_cause = 14, by_speed = 2, by_software = 4;
        std::fill_n(status, fields, 0);
        const bool there = now.state != DeviceState::disconnected;
        const bool on = now.state == DeviceState::active || now.state == DeviceState::ramp_up;
        status[power] = status[connected] = status[started] = status[reset] = there ? 1 : 0;
        status[idle] = there && !on && !device->brakes ? 1 : 0;
        status[force] = on ? 1 : 0;
        status[brake] = device->brakes ? 1 : 0;
        status[torque] = on && device->hand.device().renders_torque ? 1 : 0;
        status[wrist] = device->hand.device().senses_orientation ? 1 : 0;
        status[error] = now.state == DeviceState::fault ? 1 : 0;
        status[redundancy] = 0;
        if (now.state == DeviceState::fault)
            status[force_off_cause] = now.faults & knurl::fault::speed ? by_speed : by_software;
        return 0;
    });
}

int dhdReset(char id) {
    return call([=] {
        opened(id);
        return not_available("dhdReset");
    });
}
int dhdWaitForReset(int timeout, char id) {
    return call([=] {
        const auto device = opened(id);
        const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout);
        // Knurl's devices are calibrated by their drivers: it is waited for until one is.
        while (report(*device).state == knurl::DeviceState::disconnected) {
            if (timeout > 0 && std::chrono::steady_clock::now() > end) throw Refused{Code::timeout};
            device->hand.pace();
        }
        return 0;
    });
}

}  // extern "C"
