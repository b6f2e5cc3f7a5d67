#pragma once
// Where a simulated hand wants to be: somewhere else about once a second. Reproducible by its seed.

#include <string>

namespace dock {

struct HandPath {
    double seconds = 60;
    double reach = 0.05;  // m from the middle
    unsigned seed = 1;
};

/// A motion for `knurld --hand`: t,x,y,z in s and m, every 10 ms, from the middle and back to it.
void write_path(const std::string& file, const HandPath& path);

}  // namespace dock
