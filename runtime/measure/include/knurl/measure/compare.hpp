#pragma once
// Is a difference noise? For two things measured in turns, a bootstrap over the blocks of both decides. For
// two runs, one after the other, that is not enough: no block shows what the machine does between them. So
// their intervals have the width
//
//   sqrt((t scatter)^2 + (t' drift)^2, of both runs)      and begin beyond the machine's own change
//
// The drift is how much more a run's stretches (eight, one after another) differ than its blocks explain:
// what changes between the stretches of a run also changes between two runs. The floors show the machine's
// own change: how far they moved, or moved apart.

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

/// The statistic of some blocks, given by number; a block may occur twice. None: too few samples.
using Statistic = std::function<std::optional<double>(std::span<const std::size_t> of_a,
                                                      std::span<const std::size_t> of_b)>;

/// The interval of the statistic of two runs: its value over all blocks, plus or minus Student's t times its
/// scatter when each run's blocks are resampled with replacement. None: fewer than 30 blocks in a run, or too
/// few samples in a resampling.
std::optional<Interval> bootstrap(std::size_t blocks_a, std::size_t blocks_b, const Statistic& statistic,
                                  const Bootstrap& how);

enum class Verdict { better, worse, undecided };
const char* name_of(Verdict verdict);

/// One run's result. With a reference from the same moments the result is a multiple of it, so that what the
/// machine does to both alike is no difference.
struct Measured {
    std::vector<Histogram> blocks;
    std::vector<Histogram> reference;  // empty: none; else as many as blocks
};

struct Comparison {
    Verdict verdict = Verdict::undecided;
    double ratio = 1;     // of the percentile, new to old
    Interval interval;    // of that ratio
    std::string problem;  // why there is no verdict: too few blocks, too few samples; else empty
};

inline constexpr std::size_t stretches = 8;

/// The variance between a run's stretches that its blocks do not explain, of the logarithm; below 0: they
/// explain more than there is. None: too few samples.
std::optional<double> drift(const Measured& run, double q, const Bootstrap& how = {});

/// What two runs as a whole show about their machine.
struct MachineShift {
    double drift = 0;  // as drift(), of a typical result; one result alone can show less by chance
    double moved = 0;  // of the logarithm: a difference up to this is the machine's
};

/// Where floors moved farther, the machine was different, and its other effects on a path are unknown.
inline constexpr double most_moved = 1.3;  // times

/// As compare(), for two runs one after the other. The interval is of the ratio. There is a verdict if all of
/// it exceeds the machine's move.
Comparison compare_apart(const Measured& before, const Measured& now, double q, const MachineShift& machine,
                         const Bootstrap& how = {});

/// For two things measured in turns: has the percentile q become smaller (better) or larger (worse)? The
/// whole interval must lie on that side of 1. References count by their medians.
Comparison compare(const Measured& before, const Measured& now, double q, const Bootstrap& how = {});

}  // namespace knurl::measure
