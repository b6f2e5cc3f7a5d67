#include "machine.hpp"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <sys/utsname.h>

namespace surface {

Machine this_machine() {
    Machine machine;
    machine.cpus = static_cast<int>(std::thread::hardware_concurrency());

    std::ifstream cpuinfo("/proc/cpuinfo");
    for (std::string line; machine.processor.empty() && std::getline(cpuinfo, line);)
        if (line.starts_with("model name") && line.find(": ") != std::string::npos)
            machine.processor = line.substr(line.find(": ") + 2);
    if (machine.processor.empty()) machine.processor = "unknown processor";

    utsname name{};
    if (uname(&name) == 0) machine.kernel = fmt::format("{} {}", name.sysname, name.release);

    double loads[1] = {};
    if (getloadavg(loads, 1) == 1) machine.load = loads[0];

    std::ifstream stat("/proc/stat");
    std::string word;
    double user = 0, nice = 0, system = 0, idle = 0, rest = 0;
    if (stat >> word >> user >> nice >> system >> idle) {
        double sum = user + nice + system + idle;
        for (int i = 0; i < 4 && stat >> rest; ++i) sum += rest;
        machine.idle = sum > 0 ? idle / sum : 0;
    }

#ifdef NDEBUG
    const char* build = "Release";
#else
    const char* build = "Debug";
#endif
#ifdef __clang__
    machine.build = fmt::format("{}, Clang {}.{}", build, __clang_major__, __clang_minor__);
#else
    machine.build = fmt::format("{}, GCC {}.{}", build, __GNUC__, __GNUC_MINOR__);
#endif

    char date[32];
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    machine.date = date;
    return machine;
}

std::string Machine::sentence() const {
    return fmt::format("{}, {} CPUs, {}, load {:.2f}, {}", processor, cpus, kernel, load, build);
}

}  // namespace surface
