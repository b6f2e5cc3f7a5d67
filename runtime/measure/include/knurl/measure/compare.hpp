#pragma once
// Is a difference noise? Of two things that were measured by turns: by bootstrap over the blocks of both. Of
// two runs, one after the other, that is not enough: what a machine does meanwhile no block of either shows.
// So their intervals are as wide as
//
//   sqrt((t scatter)^2 + (t' drift)^2, of both runs)      and begin beyond what the machine itself did
//
// where the drift is how much more the stretches of a run (eight, one after another) differ than its blocks
// explain: what a machine does between the stretches of a run it does between two runs as well. And what the
// machine itself did is known from floors: how far they went apart, or moved.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl/measure/histogram.hpp>

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

inline constexpr std::size_t stretches = 8;

/// The variance between a run's stretches that its blocks do not explain, of the logarithm; below 0: they
/// explain more. None: too few samples.
std::optional<double> drift(const Measured& run, double q, const Bootstrap& how = {});

/// What two runs as a whole show of the machine that they were on.
struct MachineShift {
    double drift = 0;  // as drift(): of a typical result; what one result shows can be less by chance
    double moved = 0;  // of the logarithm: a difference up to here is the machine's
};

/// Where floors moved farther, it was another machine: what else it did to a path, nobody knows.
inline constexpr double most_moved = 1.3;  // times

/// As compare(), of two runs that were made one after the other. The interval is of the ratio; a verdict is
/// given where all of it is beyond what the machine moved.
Comparison compare_apart(const Measured& before, const Measured& now, double q, const MachineShift& machine,
                         const Bootstrap& how = {});

/// Of two things that were measured by turns: whether the percentile q has become smaller (better) or larger
/// (worse): the whole interval lies on that side of 1. References are by their medians.
Comparison compare(const Measured& before, const Measured& now, double q, const Bootstrap& how = {});

}  // namespace knurl::measure
