#pragma once
// No percentile without its machine: the output of every program that measures, and its --json form.

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <knurl/measure/histogram.hpp>

#if defined(__x86_64__)
#include <x86intrin.h>
#else
#include <chrono>
#endif

namespace knurl::measure {

struct Machine {
    std::string processor;
    unsigned cpus = 0;   // online
    std::string kernel;  // release
    std::string load;    // averages over 1, 5 and 15 minutes, when asked
    // cpuidle driver, and "cpu_dma_latency N us" where that may be read: 0 means that idle polls
    std::string idle;
    std::string build;  // compiler and whether it is optimised
    std::string date;   // UTC, ISO 8601
};
Machine this_machine();

/// A percentile with fewer than ten samples above it has no meaning, and is left out.
struct Result {
    std::string name;
    std::string unit;
    std::size_t n = 0;
    std::optional<double> p50, p99, p999;
    double max = 0;
    std::optional<std::string> reference;  // the name of the result with which it was interleaved
    std::optional<double> ratio;           // of the medians, to the reference
    std::vector<Histogram> blocks{};       // of the run, for comparison with another run; may be empty
};

/// `samples` in any order; may be empty (then only the name is there).
Result summarise(std::string name, std::string unit, std::vector<double> samples);

/// With the histograms' resolution; keeps the blocks.
Result summarise_blocks(std::string name, std::string unit, const Blocks& samples);

/// Gives `result` as a multiple of `reference`.
void relate(Result& result, const Result& reference);

/// How many of a result's samples met a limit that follows from the same run's references.
struct Bound {
    std::string name;  // the result's
    std::string unit;
    double limit = 0;
    std::size_t n = 0, within = 0;
    double references_within = 0;  // share of the references' own samples that would meet it
    std::size_t stalled = 0;       // samples that missed it while the machine stood still
};

struct Run {
    Machine machine;
    std::vector<Result> results;
    std::vector<Bound> bounds{};
};

/// The machine in a line or two, then a table.
void print(std::ostream& out, const Run& run);

/// {"machine": {...}, "results": [{"name", "unit", "n", "p50", "p99", "p999", "max", "reference", "ratio"}],
///  "bounds": [{"name", "unit", "limit", "n", "within", "references_within", "stalled"}]}
/// What is missing is null. A result that has blocks has "histogram": [[lower edge, count], ...], and the
/// same of each block in "blocks", each on one line.
std::string to_json(const Run& run);
/// Reads the output of to_json(), without the bounds. Throws std::runtime_error: the text is something else.
Run from_json(const std::string& text);

/// False: the process may not use this CPU.
bool pin_this_thread(unsigned cpu);
/// SCHED_FIFO; false without the right to it.
bool run_real_time(int priority);
/// The CPUs that this process may use.
std::vector<unsigned> allowed_cpus();

/// A stopwatch for nanoseconds: serialised reads of the time-stamp counter, if there is one. An empty begin()
/// to end() takes about 16 ns, which is not subtracted: see empty_interval().
class Stopwatch {
  public:
    Stopwatch();  // calibrates against CLOCK_MONOTONIC, 20 ms
    double nanoseconds(std::uint64_t begin, std::uint64_t end) const {
        return static_cast<double>(end - begin) * nanoseconds_per_tick_;
    }
    /// Median cost of the pair itself, ns.
    double empty_interval() const { return empty_interval_; }

#if defined(__x86_64__)
    static std::uint64_t begin() {
        _mm_lfence();
        const std::uint64_t now = __rdtsc();
        _mm_lfence();
        return now;
    }
    static std::uint64_t end() {
        unsigned cpu;
        const std::uint64_t now = __rdtscp(&cpu);
        _mm_lfence();
        return now;
    }
#else
    static std::uint64_t begin() {
        return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
    }
    static std::uint64_t end() {
        return begin();
    }
#endif

  private:
    double nanoseconds_per_tick_ = 1;
    double empty_interval_ = 0;
};

}  // namespace knurl::measure
