#pragma once
// Run time against error: shared by the panels of this benchmark. A panel compares implementations of one
// task in several scenes. Each point has the error against a reference that shares no code with it, and the
// median time of one call over blocks interleaved with those of all others in that scene.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <knurl/measure/measure.hpp>

namespace knurl::error {

struct Point {
    std::string scene;           // the task: "6 planes", "gentle, 20 Hz"
    double size = 0;             // its value: planes, Hz
    std::string implementation;  // the method: "naive sum"
    double error = 0;            // in the panel's unit
    bool knurl = false;          // Knurl's default
    std::string flaw = {};       // the reason that rules it out, whatever its time and error
    double ns = 0;               // median time of one call
    std::size_t samples = 0;     // blocks in that median
};

struct Panel {
    std::string name;
    std::string error_unit;
    std::string error_meaning;
    double exact = 0;      // smaller errors count as none: two such points differ only in time
    double useless = 1e9;  // Knurl's points with a larger error are skipped
    std::vector<Point> points;
};

/// Prevents the compiler from removing or moving the computation of `value`.
template <class T>
void keep(const T& value) {
    asm volatile("" : : "g"(&value) : "memory");
}

/// One competitor: `run(n)` does n calls.
struct Contender {
    Point* point;
    std::function<void(int n)> run;
};

/// Fills in ns and samples.
inline void race(const measure::Stopwatch& watch, std::vector<Contender>& contenders) {
    constexpr int blocks = 61;
    constexpr double block = 40e3;  // ns, or one call
    struct Lane {
        int calls = 1;
        std::vector<double> ns;
    };
    std::vector<Lane> lanes(contenders.size());
    const auto time = [&](std::size_t i) {
        const std::uint64_t begin = measure::Stopwatch::begin();
        contenders[i].run(lanes[i].calls);
        return watch.nanoseconds(begin, measure::Stopwatch::end());
    };
    for (std::size_t i = 0; i < lanes.size(); ++i) {
        for (double took = time(i); took < block / 2; took = time(i))
            lanes[i].calls = std::max(lanes[i].calls + 1,
                                      static_cast<int>(lanes[i].calls * std::min(64.0, block / (took + 1))));
    }
    for (int b = 0; b < blocks; ++b) {
        for (std::size_t i = 0; i < lanes.size(); ++i) lanes[i].ns.push_back(time(i) / lanes[i].calls);
    }
    for (std::size_t i = 0; i < lanes.size(); ++i) {
        std::nth_element(lanes[i].ns.begin(), lanes[i].ns.begin() + blocks / 2, lanes[i].ns.end());
        contenders[i].point->ns = lanes[i].ns[blocks / 2];
        contenders[i].point->samples = blocks;
    }
}

Panel planes(const measure::Stopwatch&);
Panel curved(const measure::Stopwatch&);
Panel surfaces(const measure::Stopwatch&);
Panel friction(const measure::Stopwatch&);
Panel springs(const measure::Stopwatch&);

}  // namespace knurl::error
