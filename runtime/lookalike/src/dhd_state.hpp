#pragma once
// What all dhd* and drd* functions share: the devices that are open, the error of the calling thread, expert mode.

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include <knurl/client/error.hpp>

#include "hand.hpp"
#include "say.hpp"

namespace knurl::lookalike::dhd {

/// The error numbers of the interface, as documented.
enum class Code : int {
    none = 0,
    failed = 1,
    communication = 2,
    no_device = 5,
    not_available = 6,
    timeout = 7,
    expert_mode_disabled = 9,
    out_of_memory = 11,
    not_ready = 12,
    invalid_index = 15,
    null_argument = 17,
    device_in_use = 20,
    invalid = 21,
    no_regulation = 22,
};

/// What a function throws inside; no exception leaves the library.
struct Refused {
    Code code;
};

/// A device that the program has opened.
struct Opened {
    explicit Opened(const Place& place) : hand(place) {}

    Hand hand;
    // Largest force and torque that the program allows itself; below 0: no limit.
    std::atomic<double> most_force{-1}, most_torque{-1};
    std::atomic<int> watchdog{0};  // as it was set, in units of 125 us
    std::atomic<bool> brakes{false};
    std::atomic<double> mass{0};  // of what is at the tip, as the program says (kg)
};

inline constexpr int most_devices = 16;

/// Of this thread: as dhdErrorGetLast gives it.
int& last_error() noexcept;
const char* text_of(int error) noexcept;

/// Sets the thread's error; returns -1.
int fail(Code code) noexcept;
/// As fail, and says once on standard error that this function does nothing.
int not_available(const char* function) noexcept;
/// The error of what is being thrown, which is said once.
Code caught() noexcept;

/// That device; below 0: the default one. Throws Refused.
std::shared_ptr<Opened> opened(char id);
/// Its newest report. Throws Refused.
HandReport report(char id);
HandReport report(Opened& device);

/// Opens the device of that number, or finds it open; it becomes the default. Throws.
int open_number(int number);
/// The first that is not open yet and lets itself be opened. Throws.
int open_first();
/// Throws Refused.
void close_device(char id);
/// The default device; -1: none is open.
int default_device() noexcept;
/// Throws Refused.
void set_default(char id);

/// Their types have numbers; those of Knurl's devices are named after what they are like.
int type_of(const DeviceDescription& device);
/// A number from 0 to 65535.
unsigned short serial_of(const DeviceDescription& device, int number);

extern std::atomic<bool> expert;
/// Throws Refused.
void require_expert();

/// Throws Refused for a null pointer.
template <class... T>
void require(T*... pointers) {
    if (!(true && ... && (pointers != nullptr))) throw Refused{Code::null_argument};
}

/// Throws Refused for a null pointer.
inline void give(const Vec3& v, double* x, double* y, double* z, double scale = 1) {
    require(x, y, z);
    *x = scale * v.x;
    *y = scale * v.y;
    *z = scale * v.z;
}

/// Runs `body`, which returns what the function returns. What it throws is the thread's error; `otherwise` is returned
/// then.
template <class Body, class Result = int>
Result call(Body&& body, Result otherwise = static_cast<Result>(-1)) noexcept {
    try {
        return static_cast<Result>(std::forward<Body>(body)());
    } catch (...) {
        fail(caught());
        return otherwise;
    }
}

}  // namespace knurl::lookalike::dhd
