#pragma once
// What of a machine's settings a servo meets, read from the kernel's files. Nothing is changed.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace knurl::cli {

enum class Grade { good, note, bad };  // note: it costs something; bad: a servo should not run like this

struct Finding {
    std::string what;  // "idle states"
    Grade grade = Grade::good;
    std::string says;  // one line: what is so, and what it costs
    std::string mend;  // the command that changes it; empty: there is nothing to mend, or no command does
};

/// Settings that stay as they are while we look: throttling, idle states, governor, preemption model,
/// isolation, hypervisor, clock. `root` is "/", or a folder with such files in a test; what is missing there
/// is left out.
std::vector<Finding> look_at_settings(const std::filesystem::path& root, unsigned servo_cpu);

/// What a servo said when it was started: the rights that it lacks, each with the command that gives it.
std::vector<Finding> look_at_rights(const std::string& said);

/// Haptic devices on USB, and whether the kernel may put them to sleep. Sentences on no USB at all, too.
std::vector<Finding> look_at_usb(const std::filesystem::path& root);

/// Counts since the machine was started.
struct Disturbance {
    // on one CPU, by "36 virtio1-req.0" or "RES Rescheduling interrupts"
    std::map<std::string, std::uint64_t> interrupts;
    std::uint64_t stolen = 0;  // ticks of 10 ms, of all CPUs, that a hypervisor gave to others
};
Disturbance count_disturbances(const std::filesystem::path& root, unsigned cpu);

/// What happened between two counts, `seconds` apart.
std::vector<Finding> look_at_disturbances(const Disturbance& before, const Disturbance& after, double seconds,
                                          unsigned servo_cpu);

}  // namespace knurl::cli
