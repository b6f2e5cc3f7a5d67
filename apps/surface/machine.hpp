#pragma once
// The machine that a figure was measured on: no percentile without it.

#include <string>

namespace surface {

struct Machine {
    std::string processor;
    int cpus = 0;
    std::string kernel;
    double load = 0;    // mean of the last minute
    double idle = 0;    // share of all CPU time since boot that was idle
    std::string build;  // "Release, GCC 12.2.0"
    std::string date;   // UTC, ISO 8601

    std::string sentence() const;
};

Machine this_machine();

}  // namespace surface
