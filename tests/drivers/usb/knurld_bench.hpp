#pragma once
// Shared by the tests with a real knurld on the emulated bus: an application that arms and renders a floor.

#include <optional>

#include "../../client/servo_process.hpp"
#include "motor_bench.hpp"

namespace knurl::drivers::usb_emulator {

#if defined(__SANITIZE_THREAD__)
inline constexpr const char* not_here =
    "under ThreadSanitizer the servo does not keep the bus's milliseconds, and what umockdev's preload "
    "closes "
    "is not seen to be closed";
#else
inline constexpr const char* not_here = nullptr;
#endif

using namespace std::chrono_literals;

/// For one report: resets a fault, arms. Returns the reported state, if any.
inline std::optional<DeviceState> try_to_arm(Claim& hand) {
    try {
        const auto report = hand.next_report(100ms);
        hand.commit();
        if (!report) return {};
        if (report->state == DeviceState::fault) hand.reset_fault();
        if (report->state == DeviceState::idle) hand.arm();
        return report->state;
    } catch (const Error&) {
        return {};  // not back yet, or the device's state forbids it still: the next report shows
    }
}

/// The rigid hand rests 2 mm within it: 0.2 N.
inline const Plane felt_floor = {.normal = {0, 0, 1}, .offset = 0.002, .stiffness = 100};

}  // namespace knurl::drivers::usb_emulator
