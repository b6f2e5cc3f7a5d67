#pragma once
// Where a simulated hand wants to be: somewhere else about once a second, or, a rough one, twice.
// Reproducible by its seed.

#include <random>
#include <string>

namespace dock {

struct HandPath {
    double seconds = 60;
    double reach = 0.05;  // m from the middle
    unsigned seed = 1;
    bool rough = false;  // up to 0.9 m/s at the usual reach, just below what a device brakes
};

/// A motion for `knurld --hand`: t,x,y,z in s and m, every 10 ms, from the middle and back to it.
void write_path(const std::string& file, const HandPath& path);

/// When a rough hand lets go and takes hold again, in s: holds for 1 to 6 s, is away for 0.2 to 1 s.
class Restless {
  public:
    explicit Restless(unsigned seed) : random_(seed) {}
    /// Once for each time that it does either, however late it is asked.
    bool changes_its_mind(double now);

  private:
    std::mt19937 random_;
    bool holds_ = true;
    double next_ = 0;
};

}  // namespace dock
