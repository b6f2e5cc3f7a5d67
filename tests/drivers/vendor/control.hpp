#pragma once
// What a test and the counterfeit libraries share: one mapped file, named by KNURL_COUNTERFEIT. It stands for the
// hardware: it outlives the process that has loaded the library, and what it says of a force is by its own clock. Each
// word has one meaning and fits one atomic.
//
//   test ── plug, target, fault ──> file <── calls of the library ── knurl-device
//   test <── force(now), log ────── file

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <new>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace knurl::counterfeit {

inline constexpr std::size_t most_devices = 2, axes = 7, log_size = 1 << 15;

inline std::int64_t now_ns() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

/// What the library does wrong, from the next call on.
enum class Fault : std::uint32_t {
    none,
    hang_in_position,  // the call never returns
    hang_in_force,
    hang_in_open,
    hang_in_close,
    crash_in_position,  // a signal in the library's own code
    crash_in_open,
    nan,           // positions that are no numbers
    no_rotation,   // a matrix that is none
    refuse_force,  // error codes, the device stays
    refuse_once,   // the next five calls for a position fail
    time_guard,    // nothing is exchanged, the old position again
    com_error,     // the bus
    device_error,  // the device's own state
    warm,          // the motors
};

/// One force that was given to the device.
struct Record {
    std::int64_t t = 0;  // ns
    std::array<double, axes> force = {};
};

struct Device {
    // By the test.
    std::atomic<std::uint32_t> plugged = 1, homed = 1, buttons = 0, forces_allowed = 1, no_watchdog = 0;
    std::atomic<std::uint32_t> type = 33, serial = 12345;
    std::atomic<std::uint32_t> wrist = 0, active_wrist = 0, gripper = 0, active_gripper = 0;
    std::array<std::atomic<double>, axes> target = {};  // m, rad, m: where the hand wants to be
    std::atomic<double> count = 1e-5;                   // m, of its encoders
    std::atomic<std::uint32_t> rigid = 1;  // 1: the tip is where the hand wants; 0: a mass at a spring
    // By the library.
    std::array<std::atomic<double>, axes> position = {};
    std::array<std::atomic<double>, 3> velocity = {};
    std::atomic<std::int64_t> moved = 0;  // when
    std::array<std::atomic<double>, axes> force = {};
    std::atomic<std::int64_t> forced = 0;  // when
    std::atomic<double> watchdog = 0;      // s; 0: none
    std::atomic<std::uint32_t> enabled = 0, braked = 0, gravity = 0, opened_by = 0;
    std::atomic<std::uint32_t> off_cause = 0;
    std::atomic<double> base_x = 0, base_z = 0, tool = 0;
    std::atomic<std::uint64_t> forces = 0;  // calls that set one
    std::atomic<std::uint64_t> positions = 0;
    std::atomic<std::uint64_t> records = 0;  // release after the record
    std::array<Record, log_size> log = {};

    /// What its motors give: nothing after its watchdog, unplugged, or switched off.
    double share_of(std::size_t axis, std::int64_t t) const {
        const double alive = watchdog.load();
        const bool lapsed = alive > 0 && static_cast<double>(t - forced.load()) * 1e-9 > alive;
        return plugged.load() == 0 || enabled.load() == 0 || lapsed ? 0 : force[axis].load();
    }
    double largest_now() const {
        double largest = 0;
        for (std::size_t i = 0; i < axes; ++i) largest = std::max(largest, std::abs(share_of(i, now_ns())));
        return largest;
    }
};

struct Control {
    std::atomic<std::uint32_t> major = 3, minor = 17, devices = 1;
    std::atomic<std::uint32_t> fault = 0;
    std::atomic<std::uint32_t> call_us = 50;  // a call that exchanges with the device takes so long
    std::atomic<std::uint32_t> left = 0;      // of Fault::refuse_once
    std::array<Device, most_devices> device;
    void set(Fault which) {
        if (which == Fault::refuse_once) left = 5;
        fault = static_cast<std::uint32_t>(which);
    }
    bool has(Fault which) const { return fault.load() == static_cast<std::uint32_t>(which); }
};
static_assert(std::atomic<double>::is_always_lock_free);

/// The file, made anew or as it is.
class Mapping {
  public:
    Mapping(const std::string& path, bool make) {
        const int fd = open(path.c_str(), O_RDWR | O_CLOEXEC | (make ? O_CREAT | O_TRUNC : 0), 0600);
        if (fd < 0 || (make && ftruncate(fd, sizeof(Control)) != 0)) throw std::runtime_error(path);
        void* memory =
            mmap(nullptr, sizeof(Control), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, 0);
        close(fd);
        if (memory == MAP_FAILED) throw std::runtime_error(path);
        control_ = make ? new (memory) Control : static_cast<Control*>(memory);
    }
    ~Mapping() { munmap(control_, sizeof(Control)); }
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    Control* operator->() const { return control_; }
    Control& operator*() const { return *control_; }

  private:
    Control* control_;
};

/// For the libraries: the file that the environment names. Without one there is no hardware.
inline Control* hardware() {
    static Mapping* const mapping = []() -> Mapping* {
        const char* path = std::getenv("KNURL_COUNTERFEIT");
        if (path == nullptr || access(path, R_OK | W_OK) != 0) return nullptr;
        return new Mapping(path, false);
    }();
    return mapping == nullptr ? nullptr : &**mapping;
}

/// A call that exchanges something with the device takes its time.
inline void exchange_takes(const Control& control) {
    const std::uint32_t us = control.call_us.load();
    if (us == 0) return;
    const timespec t{.tv_sec = us / 1'000'000, .tv_nsec = (us % 1'000'000) * 1000L};
    clock_nanosleep(CLOCK_MONOTONIC, 0, &t, nullptr);
}
[[noreturn]] inline void hang() {
    for (;;) pause();
}

/// As a fault in a library does it. Sanitizers would answer the signal in their own way.
inline void crash() {
    std::signal(SIGSEGV, SIG_DFL);
    std::raise(SIGSEGV);
}

/// The tip: where the hand holds it, or a mass at the hand's spring, moved by the motors.
inline void move(Device& device) {
    constexpr double mass = 0.2, stiffness = 200, damping = 8;
    const std::int64_t t = now_ns(), before = device.moved.exchange(t);
    if (device.rigid.load() != 0) {
        for (std::size_t i = 0; i < axes; ++i) device.position[i] = device.target[i].load();
        for (auto& v : device.velocity) v = 0;
        return;
    }
    for (std::size_t i = 3; i < axes; ++i) device.position[i] = device.target[i].load();
    double left = std::min(static_cast<double>(t - before) * 1e-9, 0.05);
    while (left > 0) {
        const double step = std::min(left, 1e-4);
        left -= step;
        for (std::size_t i = 0; i < 3; ++i) {
            const double x = device.position[i], v = device.velocity[i];
            const double f = device.share_of(i, t) + stiffness * (device.target[i].load() - x) - damping * v;
            device.velocity[i] = v + f / mass * step;
            device.position[i] = x + device.velocity[i].load() * step;
        }
    }
}
/// As its encoders have it.
inline double counted(const Device& device, std::size_t axis) {
    return std::round(device.position[axis].load() / device.count.load()) * device.count.load();
}

inline void give(Device& device, const std::array<double, axes>& force) {
    for (std::size_t i = 0; i < axes; ++i) device.force[i] = force[i];
    device.forced = now_ns();
    device.forces.fetch_add(1);
    const std::uint64_t number = device.records.load(std::memory_order_relaxed);
    device.log[number % log_size] = {device.forced.load(), force};
    device.records.store(number + 1, std::memory_order_release);
}

}  // namespace knurl::counterfeit
