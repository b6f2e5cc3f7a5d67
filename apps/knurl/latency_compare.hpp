#pragma once
// Compares two runs of `knurl latency`: what improved or got worse, and what may be noise.

#include <optional>
#include <string>
#include <vector>

#include <knurl/json/json.hpp>
#include <knurl/measure/compare.hpp>
#include <knurl/measure/measure.hpp>

namespace knurl::cli {

/// The content of a file from `knurl latency --json`.
struct LatencyFile {
    static constexpr const char* program = "knurl latency";
    static constexpr int version = 1;

    measure::Run run;
    knurl::Json setting;  // of the measurement: servo, rate, load, ...
};

/// Throws std::runtime_error with the remedy: unreadable, not such a file, or of another version.
LatencyFile read_latency_file(const std::string& path);
/// The same from its text; `path` begins its errors.
LatencyFile parse_latency_file(const std::string& text, const std::string& path);

/// One result in both runs at the percentile q. A result with a floor is compared as a multiple of it.
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
    // The factor by which the most changed floor moved, at the median and at 99 %.
    double moved = 1, moved_tail = 1;
    // other possible causes: another machine, another load, ...
    std::vector<std::string> warnings;
    std::vector<PathComparison> paths;
};

/// Compares medians and 99th percentiles of common results (measure::compare_apart). On a steady machine at
/// most one of twenty pairs of equal runs gets a wrong verdict; with drift as long as a run, more (one in
/// seven in a test's model): scripts/equal_runs counts. Floors get no verdict: they show how far the machine
/// moved, and a difference that is no larger gets none either.
LatencyComparison compare_runs(const LatencyFile& before, const LatencyFile& now);

std::string to_text(const LatencyComparison& comparison);
knurl::Json to_json(const LatencyComparison& comparison);

}  // namespace knurl::cli
