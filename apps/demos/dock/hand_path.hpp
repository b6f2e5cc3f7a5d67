#pragma once
// A random path of a simulated hand: to another place about once a second or, if rough, twice. Reproducible
// by its seed.

#include <random>
#include <string>

namespace dock {

struct HandPath {
    double seconds = 60;
    double reach = 0.05;  // m from the middle
    unsigned seed = 1;
    bool rough = false;  // up to 0.9 m/s at the default reach, just below the speed that the device brakes
};

/// A motion for `knurld --hand`: t,x,y,z in s and m, every 10 ms, from the middle and back to it.
void write_path(const std::string& file, const HandPath& path);

/// When a rough hand releases and takes again, in s: holds for 1 to 6 s, pauses for 0.2 to 1 s.
class Restless {
  public:
    explicit Restless(unsigned seed) : random_(seed) {}
    /// True once for each change, however late it is called.
    bool changes_its_mind(double now);

  private:
    std::mt19937 random_;
    bool holds_ = true;
    double next_ = 0;
};

}  // namespace dock
