#pragma once
// Two runs of `knurl latency`: what became better or worse, and what may be noise.

#include <optional>
#include <string>
#include <vector>

#include <knurl/json/json.hpp>
#include <knurl/measure/compare.hpp>
#include <knurl/measure/measure.hpp>

namespace knurl::cli {

/// What `knurl latency --json` leaves behind.
struct LatencyFile {
    static constexpr const char* program = "knurl latency";
    static constexpr int version = 1;

    measure::Run run;
    knurl::Json setting;  // of the measurement: servo, rate, load, ...
};

/// Throws std::runtime_error, with what to do: it cannot be read, is none of ours, or of another version.
LatencyFile read_latency_file(const std::string& path);

/// Of one result in both runs, the percentile q. Where it has a floor it is compared as a multiple of it.
struct PathComparison {
    std::string name;
    double q = 0;
    std::optional<double> before, now;  // us
    std::optional<std::string> reference;
    measure::Comparison result;
};

struct LatencyComparison {
    std::string date;       // of the old run
    double confidence = 0;  // of each verdict
    // How many times, up or down, the floor that moved farthest is what it was, at the median and at 99 %.
    double moved = 1, moved_tail = 1;
    // another machine, another load, ...: what the difference may be as well
    std::vector<std::string> warnings;
    std::vector<PathComparison> paths;
};

/// Medians and 99th percentiles of what both have (measure::compare_apart). All verdicts together are wrong
/// for one in twenty pairs of equal runs at most on a steady machine, for more where it drifts for as long as
/// a run takes (one in seven in a test's model): scripts/equal_runs counts. Floors have none: they say how far
/// the machine moved, and what differs by no more than that has none either.
LatencyComparison compare_runs(const LatencyFile& before, const LatencyFile& now);

std::string to_text(const LatencyComparison& comparison);
knurl::Json to_json(const LatencyComparison& comparison);

}  // namespace knurl::cli
