#include "doctor_machine.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include <knurl/drivers/usb_list.hpp>

namespace knurl::cli {

namespace {

namespace fs = std::filesystem;

std::optional<std::string> first_line(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    if (!std::getline(file, line)) return std::nullopt;
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.pop_back();
    return line;
}

std::optional<long> number_in(const fs::path& path) {
    const auto line = first_line(path);
    if (!line) return std::nullopt;
    try {
        return std::stol(*line);
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

/// The processes that have the file open, as far as permissions allow.
std::vector<std::string> holders_of(const fs::path& root, const std::string& file) {
    std::vector<std::string> pids;
    std::error_code ignored;
    for (const auto& process : fs::directory_iterator(root / "proc", ignored)) {
        const std::string pid = process.path().filename().string();
        if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
        std::error_code denied;
        for (const auto& fd : fs::directory_iterator(process.path() / "fd", denied)) {
            std::error_code gone;
            if (fs::read_symlink(fd.path(), gone) != file) continue;
            const auto name = first_line(process.path() / "comm");
            pids.push_back(pid + (name ? " (" + *name + ")" : ""));
            break;
        }
    }
    return pids;
}

Finding throttling(const fs::path& root) {
    const auto runtime = number_in(root / "proc/sys/kernel/sched_rt_runtime_us");
    const auto period = number_in(root / "proc/sys/kernel/sched_rt_period_us");
    if (!runtime || !period) return {};
    if (*runtime < 0) return {"throttling", Grade::good, "real-time threads are never held back", ""};
    return {"throttling", Grade::note,
            fmt::format(
                "real-time threads that never sleep are held for {} ms of every {} ms: no matter to a servo "
                "that sleeps, but it must not share its CPU with one that spins",
                (*period - *runtime) / 1000, *period / 1000),
            "sudo sysctl kernel.sched_rt_runtime_us=-1"};
}

Finding idle_states(const fs::path& root, unsigned cpu) {
    const fs::path cpus = root / "sys/devices/system/cpu";
    const auto driver = first_line(cpus / "cpuidle/current_driver");
    const auto holders = holders_of(root, "/dev/cpu_dma_latency");
    if (!holders.empty())
        return {"idle states", Grade::good,
                fmt::format("held shallow through /dev/cpu_dma_latency by pid {}", fmt::join(holders, ", ")),
                ""};
    if (!driver || *driver == "none") return {"idle states", Grade::good, "the kernel chooses none", ""};
    long deepest = 0;  // us to leave it
    std::string name;
    std::error_code ignored;
    for (const auto& state : fs::directory_iterator(cpus / fmt::format("cpu{}/cpuidle", cpu), ignored)) {
        const auto disabled = number_in(state.path() / "disable");
        const auto latency = number_in(state.path() / "latency");
        if (!latency || (disabled && *disabled != 0) || *latency < deepest) continue;
        deepest = *latency;
        name = first_line(state.path() / "name").value_or("?");
    }
    return {"idle states", Grade::note,
            fmt::format("{} lets CPU {} sleep as deep as {} ({} us to wake, and a virtual machine's wake-up "
                        "costs more); nobody "
                        "holds /dev/cpu_dma_latency",
                        *driver, cpu, name, deepest),
            "idle = \"poll\" in the servo's configuration (knurld --idle poll)"};
}

Finding governor(const fs::path& root, unsigned cpu) {
    const auto name =
        first_line(root / fmt::format("sys/devices/system/cpu/cpu{}/cpufreq/scaling_governor", cpu));
    if (!name) return {};
    if (*name == "performance") return {"governor", Grade::good, "performance", ""};
    return {"governor", Grade::note, fmt::format("\"{}\" lets CPU {} slow down between cycles", *name, cpu),
            "sudo cpupower frequency-set --governor performance"};
}

Finding isolation(const fs::path& root, unsigned cpu) {
    const auto isolated = first_line(root / "sys/devices/system/cpu/isolated");
    if (!isolated) return {};
    // "2-3,6"
    std::stringstream ranges(*isolated);
    for (std::string range; std::getline(ranges, range, ',');) {
        unsigned first = 0, last = 0;
        const int numbers = std::sscanf(range.c_str(), "%u-%u", &first, &last);
        if (numbers < 1) continue;
        if (numbers == 1) last = first;
        if (cpu >= first && cpu <= last)
            return {"isolation", Grade::good, fmt::format("CPU {} is kept free of other programs", cpu), ""};
    }
    return {
        "isolation", Grade::note,
        fmt::format("CPU {} also runs other programs: the servo goes before them, but they cool its caches",
                    cpu),
        fmt::format("add isolcpus={0} irqaffinity=0 to the kernel's command line, and keep --cpu {0}", cpu)};
}

Finding preemption(const fs::path& root) {
    const auto realtime = number_in(root / "sys/kernel/realtime");
    const auto version = first_line(root / "proc/version").value_or("");
    if ((realtime && *realtime == 1) || version.find("PREEMPT_RT") != std::string::npos)
        return {"preemption", Grade::good, "PREEMPT_RT", ""};
    const bool dynamic = version.find("PREEMPT_DYNAMIC") != std::string::npos;
    const auto mode = first_line(root / "sys/kernel/debug/sched/preempt");  // "none voluntary (full) lazy"
    if (mode && mode->find("(full)") != std::string::npos)
        return {"preemption", Grade::good, "full (not PREEMPT_RT)", ""};
    if (!dynamic && version.find("PREEMPT") != std::string::npos)
        return {"preemption", Grade::good, "full (not PREEMPT_RT)", ""};
    const std::string says =
        fmt::format("{}: a system call of any program on the servo's CPU may hold it up",
                    dynamic ? (mode ? "PREEMPT_DYNAMIC, " + *mode : "PREEMPT_DYNAMIC, mode not to be read")
                            : "not preemptible");
    return {"preemption", Grade::note, says,
            dynamic ? "echo full | sudo tee /sys/kernel/debug/sched/preempt (preempt=full on the kernel's "
                      "command line)"
                    : "sudo apt install linux-image-rt-amd64"};
}

Finding hypervisor(const fs::path& root) {
    std::ifstream file(root / "proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with("flags")) continue;
        if ((line + " ").find(" hypervisor ") == std::string::npos)
            return {"hardware", Grade::good, "no hypervisor below", ""};
        return {"hardware", Grade::note,
                "a virtual machine: it may be stopped as a whole for milliseconds, whatever its priorities; "
                "no setting here "
                "changes that",
                ""};
    }
    return {};
}

Finding clock(const fs::path& root) {
    const auto source = first_line(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
    if (!source) return {};
    const bool quick = *source == "tsc" || *source == "kvm-clock" || *source == "arch_sys_counter";
    return {
        "clock", quick ? Grade::good : Grade::note,
        *source + (quick ? "" : ": each look at the time is a system call or worse"),
        quick ? "" : "echo tsc | sudo tee /sys/devices/system/clocksource/clocksource0/current_clocksource"};
}

}  // namespace

std::vector<Finding> look_at_settings(const fs::path& root, unsigned servo_cpu) {
    std::vector<Finding> found{throttling(root),
                               idle_states(root, servo_cpu),
                               governor(root, servo_cpu),
                               isolation(root, servo_cpu),
                               preemption(root),
                               hypervisor(root),
                               clock(root)};
    std::erase_if(found, [](const Finding& finding) { return finding.what.empty(); });
    return found;
}

std::vector<Finding> look_at_rights(const std::string& said) {
    Finding priority{"real-time priority", Grade::good, "knurld's threads have it", ""};
    Finding memory{"memory", Grade::good, "knurld's is locked", ""};
    std::stringstream lines(said);
    for (std::string line; std::getline(lines, line);) {
        constexpr std::string_view by = "knurld: ", run = "run: ";
        if (!line.starts_with(by)) continue;
        Finding* about = line.find("no real-time priority") != std::string::npos ? &priority
                         : line.find("memory is") != std::string::npos           ? &memory
                                                                                 : nullptr;
        const std::size_t command = line.rfind(run);
        if (about == nullptr || command == std::string::npos) continue;
        about->grade = Grade::bad;
        about->says = line.substr(by.size(), line.find_last_not_of("; ", command - 1) + 1 - by.size());
        about->mend = line.substr(command + run.size());
    }
    return {priority, memory};
}

std::vector<Finding> look_at_usb(const fs::path& root) {
    std::vector<drivers::UsbDevice> devices;
    try {
        devices = drivers::usb_devices();
    } catch (const std::runtime_error& error) {
        return {{"USB", Grade::note, error.what(), ""}};
    }
    if (devices.empty())
        return {{"USB", Grade::good, "no haptic device is plugged in (see knurl devices)", ""}};
    std::vector<Finding> found;
    for (const drivers::UsbDevice& device : devices) {
        const fs::path control = root / "sys/bus/usb/devices" / device.port / "power/control";
        const bool sleeps = first_line(control) == "auto";
        found.push_back(
            {"USB", sleeps ? Grade::note : Grade::good,
             fmt::format("{} at {}{}", device.name, device.port,
                         sleeps ? ": the kernel may suspend it when it is idle" : ""),
             sleeps ? fmt::format("echo on | sudo tee /sys/bus/usb/devices/{}/power/control", device.port)
                    : ""});
    }
    return found;
}

Disturbance count_disturbances(const fs::path& root, unsigned cpu) {
    Disturbance counted;
    std::ifstream interrupts(root / "proc/interrupts");
    std::string line;
    // The first line names the CPUs that are online: "  CPU0  CPU1".
    std::getline(interrupts, line);
    std::stringstream head(line);
    const std::vector<std::string> names{std::istream_iterator<std::string>(head), {}};
    const auto mine = std::find(names.begin(), names.end(), fmt::format("CPU{}", cpu)) - names.begin();
    while (std::getline(interrupts, line)) {
        std::stringstream words(line);
        std::string irq, word;
        words >> irq;
        if (!irq.ends_with(':')) continue;
        irq.pop_back();
        std::vector<std::uint64_t> counts;
        std::string rest;
        while (words >> word) {
            const bool count = counts.size() < names.size() && rest.empty() &&
                               word.find_first_not_of("0123456789") == std::string::npos;
            if (count)
                counts.push_back(std::stoull(word));
            else
                rest = irq.find_first_not_of("0123456789") == std::string::npos ? word : rest + " " + word;
        }
        if (static_cast<std::size_t>(mine) >= counts.size()) continue;
        // A numbered interrupt ends with its device's name; for the others all the text is a description.
        counted.interrupts[irq + (rest.starts_with(' ') ? "" : " ") + rest] =
            counts[static_cast<std::size_t>(mine)];
    }
    std::ifstream stat(root / "proc/stat");
    std::string cpu_word;
    std::uint64_t user = 0, nice = 0, system = 0, idle = 0, wait = 0, irq = 0, soft = 0;
    stat >> cpu_word >> user >> nice >> system >> idle >> wait >> irq >> soft >> counted.stolen;
    return counted;
}

std::vector<Finding> look_at_disturbances(const Disturbance& before, const Disturbance& after, double seconds,
                                          unsigned servo_cpu) {
    constexpr double worth_telling = 10;  // a second
    std::vector<Finding> found;
    std::vector<std::pair<double, std::string>> busy;
    for (const auto& [name, count] : after.interrupts) {
        const auto was = before.interrupts.find(name);
        const double rate =
            static_cast<double>(count - (was == before.interrupts.end() ? 0 : was->second)) / seconds;
        // Interrupts without a number are the kernel's own: timers and calls between CPUs, which a servo
        // needs.
        if (rate >= worth_telling && std::isdigit(static_cast<unsigned char>(name.front())) != 0)
            busy.emplace_back(rate, name);
    }
    std::sort(busy.rbegin(), busy.rend());
    for (const auto& [rate, name] : busy) {
        const std::string number = name.substr(0, name.find(' '));
        found.push_back({"interrupts", Grade::note,
                         fmt::format("{:.0f} a second of {} land on CPU {}", rate,
                                     name.substr(number.size() + 1), servo_cpu),
                         fmt::format("echo {} | sudo tee /proc/irq/{}/smp_affinity_list",
                                     servo_cpu == 0 ? 1 : 0, number)});
    }
    if (busy.empty())
        found.push_back(
            {"interrupts", Grade::good, fmt::format("no device's interrupts land on CPU {}", servo_cpu), ""});
    if (const auto stolen = after.stolen - before.stolen; stolen > 0) {
        found.push_back(
            {"stolen time", Grade::note,
             fmt::format("{:.1f} % of all CPUs' time went to other virtual machines",
                         static_cast<double>(stolen) / seconds),  // ticks of 1/100 s, so: percent of one CPU
             ""});
    }
    return found;
}

}  // namespace knurl::cli
