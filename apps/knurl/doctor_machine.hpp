#pragma once
// The settings of a machine that affect a servo, read from the kernel's files. Nothing is changed.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace knurl::cli {

enum class Grade { good, note, bad };  // note: it has a cost; bad: a servo should not run like this

struct Finding {
    std::string what;  // "idle states"
    Grade grade = Grade::good;
    std::string says;  // one line: the state and its cost
    std::string mend;  // the command that fixes it; empty: no fix is needed, or no command does it
};

/// Settings that do not change during the run: throttling, idle states, governor, preemption model,
/// isolation, hypervisor, clock. `root` is "/", or a folder with such files in a test; missing files are
/// skipped.
std::vector<Finding> look_at_settings(const std::filesystem::path& root, unsigned servo_cpu);

/// From a servo's messages at its start: the missing rights, each with the command that grants it.
std::vector<Finding> look_at_rights(const std::string& said);

/// Haptic devices on USB, and whether the kernel may suspend them. Also reports a machine without USB.
std::vector<Finding> look_at_usb(const std::filesystem::path& root);

/// Counts since boot.
struct Disturbance {
    // on one CPU, by "36 virtio1-req.0" or "RES Rescheduling interrupts"
    std::map<std::string, std::uint64_t> interrupts;
    std::uint64_t stolen = 0;  // ticks of 10 ms, of all CPUs, that a hypervisor took
};
Disturbance count_disturbances(const std::filesystem::path& root, unsigned cpu);

/// The events between two counts, `seconds` apart.
std::vector<Finding> look_at_disturbances(const Disturbance& before, const Disturbance& after, double seconds,
                                          unsigned servo_cpu);

}  // namespace knurl::cli
