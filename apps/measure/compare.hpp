#pragma once
// Is the difference between two runs noise? By bootstrap over the blocks of both.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "histogram.hpp"

namespace knurl::measure {

struct Interval {
    double low = 0, high = 0;
};

struct Bootstrap {
    double confidence = 0.99;
    int resamples = 1000;
    std::uint64_t seed = 1;  // the same blocks give the same verdict
};

inline constexpr std::size_t least_blocks = 30;  // of each run

/// The statistic of some blocks, each named by its number; a block may come twice. None: they have too few
/// samples.
using Statistic = std::function<std::optional<double>(std::span<const std::size_t> of_a,
                                                      std::span<const std::size_t> of_b)>;

/// Between which values the statistic of two runs lies: what it is of all their blocks, more or less
/// Student's t times how it scatters when each run's blocks are drawn anew, with replacement. None: it has
/// fewer than 30 blocks of one, or too few samples in some drawing.
std::optional<Interval> bootstrap(std::size_t blocks_a, std::size_t blocks_b, const Statistic& statistic,
                                  const Bootstrap& how);

enum class Verdict { better, worse, undecided };
const char* name_of(Verdict verdict);

/// What one run has of one thing. With a reference, that of the same moments, the thing is what multiple of
/// it it is: what the machine does to both alike is no difference.
struct Measured {
    std::vector<Histogram> blocks;
    std::vector<Histogram> reference;  // empty: none; else as many
};

struct Comparison {
    Verdict verdict = Verdict::undecided;
    double ratio = 1;     // of the percentile, new to old
    Interval interval;    // of that ratio
    std::string problem;  // why there is none: too few blocks, too few samples; empty otherwise
};

/// Whether the percentile q has become smaller (better) or larger (worse): the whole interval lies on that
/// side of 1. References are by their medians.
Comparison compare(const Measured& before, const Measured& now, double q, const Bootstrap& how = {});

}  // namespace knurl::measure
