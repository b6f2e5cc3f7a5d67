// A counterfeit of OpenHaptics' libHD, written from the documentation of its functions: a scheduler thread at 1 kHz that
// calls back, frames, an error stack, a current device per thread. Its hardware is control.hpp's file. x right, y up, z
// towards the user, millimetres.

#include <atomic>
#include <csignal>
#include <thread>
#include <vector>

#include "control.hpp"

namespace {

using namespace knurl::counterfeit;

struct ErrorInfo {
    unsigned code;
    int internal;
    unsigned device;
};
struct Scheduled {
    unsigned (*call)(void*);
    void* data;
    bool on;
};

thread_local unsigned current = 0xffffffff;
std::atomic<unsigned> pending = 0;
std::vector<Scheduled> calls;
std::atomic<bool> running = false;
std::thread scheduler;
std::array<double, 3> ordered{}, twisted{};
bool set = false;  // a force, in this frame

Device* present() {
    Control* control = hardware();
    return control == nullptr || current >= most_devices ? nullptr : &control->device[current];
}
void fail(unsigned code) {
    pending = code;
}

void live() {
    if (hardware() == nullptr) return;
    std::int64_t next = now_ns();
    while (running.load()) {
        next = std::max(next + 1'000'000, now_ns() - 1'000'000);
        const timespec until{.tv_sec = next / 1'000'000'000, .tv_nsec = next % 1'000'000'000};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
        for (Scheduled& one : calls)
            if (one.on && one.call(one.data) == 0) one.on = false;
    }
}

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

unsigned hdInitDevice(const char* name) {
    Control* control = hardware();
    const std::string wanted = name == nullptr ? "Default Device" : name;
    const std::size_t index = wanted == "Default Device" ? 0 : wanted == "second" ? 1 : most_devices;
    if (control != nullptr && control->has(Fault::hang_in_open)) hang();
    if (control != nullptr && control->has(Fault::crash_in_open)) crash();
    if (control == nullptr || index >= control->devices.load() ||
        control->device[index].plugged.load() == 0) {
        fail(control != nullptr && index < most_devices ? 0x0302 : 0x0104);
        return 0xffffffff;
    }
    Device& device = control->device[index];
    const std::uint32_t other = device.opened_by.load();
    if (other != 0 && other != static_cast<std::uint32_t>(getpid()) &&
        kill(static_cast<pid_t>(other), 0) == 0) {
        fail(0x0301);
        return 0xffffffff;
    }
    device.opened_by = static_cast<std::uint32_t>(getpid());
    device.enabled = 0;
    device.watchdog = 0;
    current = static_cast<unsigned>(index);
    return current;
}
void hdDisableDevice(unsigned device) {
    if (hardware() != nullptr && hardware()->has(Fault::hang_in_close)) hang();
    if (hardware() == nullptr || device >= most_devices) return;
    hardware()->device[device].enabled = 0;
    hardware()->device[device].opened_by = 0;
}
void hdMakeCurrentDevice(unsigned device) {
    current = device;
}
ErrorInfo hdGetError() {
    return {pending.exchange(0), 0, current};
}
void hdEnable(unsigned what) {
    if (Device* device = present(); device != nullptr && what == 0x4000) device->enabled = 1;
}
unsigned char hdIsEnabled(unsigned what) {
    Device* device = present();
    return what == 0x4000 && device != nullptr && device->enabled.load() != 0 ? 1 : 0;
}
void hdStartScheduler() {
    if (running.exchange(true)) return;
    scheduler = std::thread(live);
}
void hdStopScheduler() {
    if (!running.exchange(false)) return;
    scheduler.join();
}
unsigned long hdScheduleAsynchronous(unsigned (*call)(void*), void* data, unsigned short) {
    calls.push_back({call, data, true});
    return calls.size();
}
void hdUnschedule(unsigned long handle) {
    if (handle >= 1 && handle <= calls.size()) calls[handle - 1].on = false;
}
void hdBeginFrame(unsigned device) {
    current = device;
    Control* control = hardware();
    Device* there = present();
    if (control->has(Fault::hang_in_position)) hang();
    if (control->has(Fault::crash_in_position)) crash();
    if (there == nullptr || there->plugged.load() == 0 || control->has(Fault::com_error)) {
        fail(0x0302);
        return;
    }
    if (control->has(Fault::device_error)) fail(0x0300);
    exchange_takes(*control);
    move(*there);
    there->positions.fetch_add(1);
    ordered = twisted = {};
    set = false;
}
void hdEndFrame(unsigned) {
    Control* control = hardware();
    Device* there = present();
    if (control->has(Fault::hang_in_force)) hang();
    if (there == nullptr || there->plugged.load() == 0) return;
    if (control->has(Fault::refuse_once) && control->left.load() > 0) {
        control->left.fetch_sub(1);
        fail(0x0204);
    }
    if (control->has(Fault::refuse_force)) {  // too fast: the force is cut
        fail(0x0203);
        there->enabled = 0;
    }
    if (control->has(Fault::warm)) fail(0x0200);
    if (!set) return;
    // Into Knurl's axes: (z, x, y).
    give(*there,
         {ordered[2], ordered[0], ordered[1], twisted[2] * 1e-3, twisted[0] * 1e-3, twisted[1] * 1e-3});
}
void hdGetDoublev(unsigned what, double* out) {
    Device* there = present();
    if (there == nullptr) return fail(0x0104);
    const auto at = [&](std::size_t i) { return counted(*there, i) * 1e3; };
    switch (what) {
        case 0x2050:  // position, mm
            out[0] = hardware()->has(Fault::nan) ? std::nan("") : at(1);
            out[1] = at(2);
            out[2] = at(0);
            break;
        case 0x2052: {  // transform, columns: a turn about their x (Knurl's y) by the test's target[4]
            const double a = there->position[4].load();
            std::fill_n(out, 16, 0.0);
            out[0] = out[15] = 1;
            out[5] = out[10] = std::cos(a);
            out[6] = std::sin(a);
            out[9] = -std::sin(a);
            if (hardware()->has(Fault::no_rotation)) out[5] = 7;
            break;
        }
        case 0x2551: {  // usable workspace, mm: the Touch's
            const double box[6] = {-80, -60, -35, 80, 60, 35};
            std::copy_n(box, 6, out);
            break;
        }
        case 0x2603:
            *out = 3.3;
            break;
        case 0x2604:
            *out = 0.88;
            break;
        case 0x2605:
            std::fill_n(out, 6, 0.9);
            break;
        case 0x2622:
            *out = 515;
            break;
        default:
            fail(0x0100);
    }
}
void hdGetIntegerv(unsigned what, int* out) {
    Device* there = present();
    if (there == nullptr) return fail(0x0104);
    switch (what) {
        case 0x2000:
            *out = static_cast<int>(there->buttons.load() & 3U);
            break;
        case 0x2002:
            *out = static_cast<int>(there->buttons.load() >> 4 & 1U);
            break;
        case 0x2553:
            *out = there->wrist.load() != 0 ? 6 : 3;
            break;
        case 0x2554:
            *out = there->active_wrist.load() != 0 ? 6 : 3;
            break;
        case 0x2555:
            *out = 4;  // by the inkwell
            break;
        case 0x2600:
            *out = 1000;
            break;
        default:
            fail(0x0100);
    }
}
const char* hdGetString(unsigned what) {
    switch (what) {
        case 0x2500:
            return "3.40";
        case 0x2501:
            return "Touch";
        case 0x2504:
            return current == 1 ? "SECOND" : "FIRST";
        default:
            return "";
    }
}
void hdSetDoublev(unsigned what, const double* values) {
    set = true;
    if (what == 0x2700) std::copy_n(values, 3, ordered.begin());
    if (what == 0x2701) std::copy_n(values, 3, twisted.begin());
}
unsigned hdCheckCalibration() {
    Device* there = present();
    return there != nullptr && there->homed.load() != 0 ? 0x5000 : 0x5002;
}
void hdUpdateCalibration(unsigned) {}
}
#pragma GCC visibility pop
