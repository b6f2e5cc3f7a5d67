#pragma once
// What all hd* functions share: the devices that are open, which of them is meant, frames, the errors of a thread.

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "hand.hpp"
#include "hd.h"
#include "say.hpp"

namespace knurl::lookalike::hd {

inline constexpr HHD most_devices = 16;

/// What a frame began with.
struct Frame {
    HandReport report;
    Vec3 force;   // on the hand, as the program has set it since the turn began: N, their axes
    Vec3 torque;  // mN m
    bool commanded = false;
};

/// A device that the program has initialised. Its frames belong to one thread at a time, by their interface's own rule;
/// the mutex keeps a program that breaks it from reading halves.
struct Device {
    explicit Device(const Place& place) : hand(place) {}

    Hand hand;

    std::mutex mutex;  // for all below
    Frame now, last;
    bool any_frame = false;
    // As it was commanded last: a frame that commands nothing leaves it as it is.
    Vec3 held_force, held_torque;
    int open_frames = 0;
    std::uint64_t tick = 0;  // of the newest frame
    std::uint32_t enabled = 0;
    // What a program sets to read it again: the servo's supervisor has limits of its own.
    double velocity_limit = 0, impulse_limit = 0, ramping_rate = 0;
};

/// Puts an error on this thread's stack.
void fail(HDerror code) noexcept;
/// Takes the newest off.
HDErrorInfo take_error() noexcept;
/// As fail, and says once on standard error that this is not available.
void not_available(const char* what) noexcept;
/// The error of what is being thrown, which is said once.
HDerror caught() noexcept;

/// What a function throws inside; no exception leaves the library.
struct Refused {
    HDerror code;
};

/// Initialises the device of that name, null for the first. Throws.
HHD open(const char* name);
/// Throws Refused.
void close_device(HHD handle);
/// Throws Refused.
std::shared_ptr<Device> device_of(HHD handle);
/// The current one. Throws Refused.
std::shared_ptr<Device> current();
/// The first that is open, or null: the scheduler's clock.
std::shared_ptr<Device> first() noexcept;
HHD current_handle() noexcept;
void make_current(HHD handle);

/// Number of the scheduler's turn; in each other thread a number of its own for each call.
std::uint64_t turn() noexcept;

/// Runs `body`. What it throws becomes the thread's error; `otherwise` is returned then.
template <class Body, class Result>
Result call(Body&& body, Result otherwise) noexcept {
    try {
        return std::forward<Body>(body)();
    } catch (...) {
        fail(caught());
        return otherwise;
    }
}
template <class Body>
void call(Body&& body) noexcept {
    try {
        std::forward<Body>(body)();
    } catch (...) {
        fail(caught());
    }
}

}  // namespace knurl::lookalike::hd
