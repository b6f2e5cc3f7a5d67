#pragma once
// How a time grows with a number: the law that fits the measurements best, and its certainty.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl/measure/compare.hpp>

namespace knurl::measure {

/// In order of growth.
enum class Growth { constant, logarithmic, linear, linearithmic, power };

/// "O(n log n)"; a power without its exponent.
const char* name_of(Growth growth);

/// The measurements at one value: a figure for each block. Block i of all points covers the same moments.
struct Point {
    double n = 1;  // > 0
    std::vector<double> blocks;
};

/// base + factor * g(n), where g is 1, log2 n, n, n log2 n or n^exponent.
struct Law {
    Growth growth = Growth::constant;
    double base = 0, factor = 0, exponent = 0;
    double operator()(double n) const;
};

inline constexpr std::size_t least_points = 5;
inline constexpr double material = 0.05;  // a time that rises by no more over all points counts as constant

struct Fitted {
    Law law;
    double off = 0;  // largest relative distance of a median from the law
    // from the first point to the last, relative to the first, by the growing law that fits best
    double rise = 0;
    double exponent = 0;  // of base + factor * n^exponent, whichever law was chosen
    double agreed = 0;    // share of the resamplings that choose the same law; 0: none were made
    // At 95 %; none: fewer than 30 blocks.
    std::optional<Interval> base_interval, factor_interval, rise_interval, exponent_interval;
};

/// The law of the points' medians, by least squares on relative errors; base and factor are not negative.
/// Chooses the growing law with the smallest BIC. It chooses constant, unless that law rises by more than
/// `material` (with certainty, if there are 30 blocks or more) and has a smaller BIC. Intervals by bootstrap
/// over the blocks. Throws std::invalid_argument: fewer than 5 points, values that do not ascend, times that
/// are not positive, points with different numbers of blocks or none.
Fitted fit(std::span<const Point> points, const Bootstrap& how = {.confidence = 0.95, .resamples = 1000});

enum class Design { as_designed, worse, undecided };
const char* name_of(Design design);

/// Compares with the design: `constant`, `logarithmic` or `linear`. Worse: it rises by more than `material`
/// where it should be constant; else the whole interval of the exponent is above 0.3 or 1.1. Undecided also
/// without intervals.
Design judge(const Fitted& fitted, Growth design);

/// "O(n): 431 + 38.1 n [37.5, 38.8]", in the points' unit.
std::string text_of(const Fitted& fitted);

}  // namespace knurl::measure
