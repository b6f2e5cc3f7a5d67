#pragma once
// Samples in bounded memory: a log-linear histogram, whose buckets all have the same relative width.

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace knurl::measure {

inline constexpr std::size_t least_above = 10;  // least number of samples above a stated percentile

/// The least number of samples for which the percentile q (0 to 1) may be stated.
std::size_t needed_for(double q);

/// 128 buckets per octave, from 2^-10 to 2^40 of any unit. A percentile's error is at most `resolution`, for
/// any number of samples; smallest, largest and count are exact. Smaller and negative values (two clocks may
/// disagree so far) count as 0.
class Histogram {
  public:
    static constexpr double resolution = 1.0 / 128;

    /// Throws std::invalid_argument if it is not finite.
    void record(double value, std::uint64_t count = 1);
    void merge(const Histogram& other);

    std::uint64_t count() const { return count_; }
    double max() const { return max_; }  // 0 if empty
    /// The value that the fraction q of all samples does not exceed. None: fewer than ten are above it.
    std::optional<double> percentile(double q) const;
    /// By lower edge. An edge has seven binary places after its first, so it is exact in JSON.
    const std::map<double, std::uint64_t>& buckets() const { return buckets_; }

    /// The bucket of a value is [lower_edge, upper_edge).
    static double lower_edge(double value);
    static double upper_edge(double lower);

  private:
    std::map<double, std::uint64_t> buckets_;
    std::uint64_t count_ = 0;
    double min_ = 0, max_ = 0;
};

/// The blocks of a run, in bounded memory: at twice `most` blocks, neighbours are merged. Several objects
/// with additions at the same times have the same moments in the same blocks.
class Blocks {
  public:
    static constexpr std::size_t most = 64;

    /// May be empty.
    void add(const std::vector<double>& samples, double unit = 1);
    const std::vector<Histogram>& all() const { return blocks_; }

  private:
    std::vector<Histogram> blocks_;
    std::size_t in_a_block_ = 1, in_the_last_ = 0;  // additions
};

Histogram merged(const std::vector<Histogram>& blocks);

}  // namespace knurl::measure
