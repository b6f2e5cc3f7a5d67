#pragma once
// The functions of libdhd that are used, declared from the SDK's documentation, as the bindings of forcedimension_core
// (Python) repeat it.

#include <string>

#include "library.hpp"

namespace knurl::device {

/// The functions that are used.
struct Dhd {
    Library library;

    void (*sdk_version)(int*, int*, int*, int*);
    int (*error)();
    const char* (*error_text)();
    int (*count)();
    int (*open_id)(char);
    int (*open_serial)(int);
    int (*close)(char);
    int (*stop)(char);
    int (*serial)(unsigned short*, char);
    int (*type)(char);
    const char* (*name)(char);
    int (*status)(int*, char);
    int (*enable_force)(unsigned char, char);
    int (*gravity)(int, char);
    int (*position)(double*, double*, double*, char);
    int (*orientation)(double*, char);
    int (*gap)(double*, char);
    unsigned (*buttons)(char);
    int (*set_force)(double, double, double, char);
    int (*set_all)(double, double, double, double, double, double, double, char);
    bool (*has_wrist)(char);
    bool (*has_active_wrist)(char);
    bool (*has_gripper)(char);
    bool (*has_active_gripper)(char);
    int (*expert_on)();
    int (*expert_off)();
    int (*set_watchdog)(unsigned char, char);
    int (*get_watchdog)(unsigned char*, char);
    int (*base_x)(double, char);
    int (*base_z)(double, char);
    int (*tool_mass)(double, char);

    explicit Dhd(const std::string& path) : library(path) {
        library.need("dhdGetSDKVersion", sdk_version);
        library.need("dhdErrorGetLast", error);
        library.need("dhdErrorGetLastStr", error_text);
        library.need("dhdGetDeviceCount", count);
        library.need("dhdOpenID", open_id);
        library.need("dhdOpenSerial", open_serial);
        library.need("dhdClose", close);
        library.need("dhdStop", stop);
        library.need("dhdGetSerialNumber", serial);
        library.need("dhdGetSystemType", type);
        library.need("dhdGetSystemName", name);
        library.need("dhdGetStatus", status);
        library.need("dhdEnableForce", enable_force);
        library.need("dhdSetGravityCompensation", gravity);
        library.need("dhdGetPosition", position);
        library.need("dhdGetOrientationFrame", orientation);
        library.need("dhdGetGripperGap", gap);
        library.need("dhdGetButtonMask", buttons);
        library.need("dhdSetForce", set_force);
        library.need("dhdSetForceAndTorqueAndGripperForce", set_all);
        library.need("dhdHasWrist", has_wrist);
        library.need("dhdHasActiveWrist", has_active_wrist);
        library.need("dhdHasGripper", has_gripper);
        library.need("dhdHasActiveGripper", has_active_gripper);
        library.need("dhdEnableExpertMode", expert_on);
        library.need("dhdDisableExpertMode", expert_off);
        library.want("dhdSetWatchdog", set_watchdog);
        library.want("dhdGetWatchdog", get_watchdog);
        library.want("dhdSetBaseAngleXDeg", base_x);
        library.want("dhdSetBaseAngleZDeg", base_z);
        library.want("dhdSetEffectorMass", tool_mass);
    }
    std::string last_error() const {
        const char* text = error_text();
        return text == nullptr || *text == '\0' ? "error " + std::to_string(error()) : text;
    }
};

}  // namespace knurl::device
