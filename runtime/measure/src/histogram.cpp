#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include <knurl/measure/histogram.hpp>

namespace knurl::measure {

namespace {

constexpr int kept_bits = 7, mantissa_bits = 52;
constexpr std::uint64_t one_bucket = std::uint64_t{1} << (mantissa_bits - kept_bits);
constexpr double smallest = 0x1p-10, largest = 0x1p40;

}  // namespace

std::size_t needed_for(double q) {
    if (!(q >= 0 && q < 1)) throw std::invalid_argument("a percentile lies between 0 and 100");
    const auto above = [q](std::size_t n) {
        return n - static_cast<std::size_t>(std::ceil(q * static_cast<double>(n)));
    };
    const double exactly = static_cast<double>(least_above) / (1 - q);
    auto n = static_cast<std::size_t>(std::max(1.0, exactly - 2));
    while (above(n) < least_above) ++n;
    return n;
}

double Histogram::lower_edge(double value) {
    if (value < smallest) return 0;
    const auto bits = std::bit_cast<std::uint64_t>(std::min(value, largest));
    return std::bit_cast<double>(bits & ~(one_bucket - 1));
}

double Histogram::upper_edge(double lower) {
    if (lower < smallest) return smallest;
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(lower) + one_bucket);
}

void Histogram::record(double value, std::uint64_t count) {
    if (!std::isfinite(value)) throw std::invalid_argument("a sample is not finite");
    if (count == 0) return;
    buckets_[lower_edge(value)] += count;
    min_ = count_ == 0 ? value : std::min(min_, value);
    max_ = count_ == 0 ? value : std::max(max_, value);
    count_ += count;
}

void Histogram::merge(const Histogram& other) {
    if (other.count_ == 0) return;
    for (const auto& [lower, count] : other.buckets_) buckets_[lower] += count;
    min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
    max_ = count_ == 0 ? other.max_ : std::max(max_, other.max_);
    count_ += other.count_;
}

std::optional<double> Histogram::percentile(double q) const {
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
    if (rank == 0 || count_ - rank < least_above) return std::nullopt;
    std::uint64_t below = 0;
    for (const auto& [lower, count] : buckets_) {
        if (below + count < rank) {
            below += count;
            continue;
        }
        if (lower == 0) return std::clamp(0.0, min_, max_);
        // Assumes that a bucket's samples are evenly distributed.
        const double share = (static_cast<double>(rank - below) - 0.5) / static_cast<double>(count);
        return std::clamp(lower + share * (upper_edge(lower) - lower), min_, max_);
    }
    return std::nullopt;
}

void Blocks::add(const std::vector<double>& samples, double unit) {
    if (blocks_.empty() || in_the_last_ == in_a_block_) {
        if (blocks_.size() == 2 * most) {
            for (std::size_t i = 0; i < most; ++i) {
                Histogram both = std::move(blocks_[2 * i]);
                both.merge(blocks_[2 * i + 1]);
                blocks_[i] = std::move(both);
            }
            blocks_.resize(most);
            in_a_block_ *= 2;
        }
        blocks_.emplace_back();
        in_the_last_ = 0;
    }
    ++in_the_last_;
    for (const double sample : samples) blocks_.back().record(sample * unit);
}

Histogram merged(const std::vector<Histogram>& blocks) {
    Histogram all;
    for (const Histogram& block : blocks) all.merge(block);
    return all;
}

}  // namespace knurl::measure
