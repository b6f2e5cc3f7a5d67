#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include <boost/math/distributions/students_t.hpp>

#include <knurl/measure/compare.hpp>

namespace knurl::measure {

namespace {

/// Blocks for fast resampling: buckets are numbered, and the counts of a sample of blocks are added up in one
/// array.
class Drawable {
  public:
    explicit Drawable(const std::vector<Histogram>& blocks) {
        const Histogram all = merged(blocks);
        for (const auto& [lower, count] : all.buckets()) lower_.push_back(lower);
        for (const Histogram& block : blocks) {
            auto& counts = counts_.emplace_back();
            for (const auto& [lower, count] : block.buckets()) {
                const auto place = std::ranges::lower_bound(lower_, lower);
                counts.emplace_back(static_cast<std::size_t>(place - lower_.begin()), count);
            }
        }
    }

    std::optional<double> percentile(std::span<const std::size_t> drawn, double q, std::size_t least) {
        sums_.assign(lower_.size(), 0);
        std::uint64_t n = 0;
        for (const std::size_t block : drawn)
            for (const auto& [bucket, count] : counts_[block]) {
                sums_[bucket] += count;
                n += count;
            }
        const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(n)));
        if (rank == 0 || n - rank < least) return std::nullopt;
        std::uint64_t below = 0;
        std::size_t bucket = 0;
        while (below + sums_[bucket] < rank) below += sums_[bucket++];
        const double lower = lower_[bucket];
        const double share = (static_cast<double>(rank - below) - 0.5) / static_cast<double>(sums_[bucket]);
        return lower == 0 ? 0 : lower + share * (Histogram::upper_edge(lower) - lower);
    }

  private:
    std::vector<double> lower_;
    std::vector<std::vector<std::pair<std::size_t, std::uint64_t>>> counts_;
    std::vector<std::uint64_t> sums_;
};

/// A run's percentile as a logarithm: as a multiple of the reference if there is one.
class Level {
  public:
    explicit Level(const Measured& run)
        : blocks_(run.blocks), reference_(run.reference), alone_(run.reference.empty()) {}
    /// `least`: samples above a percentile.
    std::optional<double> operator()(std::span<const std::size_t> drawn, double q,
                                     std::size_t least = least_above) {
        const auto value = blocks_.percentile(drawn, q, least);
        const auto beside = alone_ ? std::optional<double>(1) : reference_.percentile(drawn, 0.5, least);
        // The histogram counts smaller values as 0, which have no logarithm.
        constexpr double nothing = 0x1p-11;
        if (!value || !beside) return std::nullopt;
        return std::log(std::max(*value, nothing) / std::max(*beside, nothing));
    }

  private:
    Drawable blocks_, reference_;
    bool alone_;
};

std::vector<std::size_t> numbers(std::size_t n) {
    std::vector<std::size_t> all(n);
    for (std::size_t i = 0; i < n; ++i) all[i] = i;
    return all;
}

std::string too_few(const char* run, std::size_t has, std::size_t needs, const char* what) {
    return std::string(run) + " has " + std::to_string(has) + " " + what + ", " + std::to_string(needs) +
           " are needed";
}

double student(double confidence, double freedom) {
    return boost::math::quantile(boost::math::students_t(freedom), 1 - (1 - confidence) / 2);
}

/// For one run: its level, and that level's two variances.
struct Scatter {
    double level = 0, blocks = 0, stretches = 0;
};

/// Half width of an interval from a variance between so many items.
double reach_of(double variance, double things, double confidence) {
    const double deviations = student(confidence, things - 1);
    return deviations * deviations * variance;
}

std::optional<Scatter> scatter(const Measured& run, double q, const Bootstrap& how) {
    if (run.blocks.size() < least_blocks) return std::nullopt;
    Level level(run);
    const auto of_one = [&](std::span<const std::size_t> a, std::span<const std::size_t>) {
        return level(a, q);
    };
    // With Student's t = 1 half the interval is the standard deviation.
    const double n = static_cast<double>(run.blocks.size());
    const auto interval = bootstrap(run.blocks.size(), least_blocks, of_one, how);
    const auto whole = level(numbers(run.blocks.size()), q);
    if (!interval || !whole) return std::nullopt;
    const double deviation =
        (interval->high - interval->low) / 2 / student(how.confidence, std::min(n, double{least_blocks}) - 1);
    std::array<double, stretches> levels{};
    for (std::size_t i = 0; i < stretches; ++i) {
        std::vector<std::size_t> stretch;
        for (std::size_t b = i * run.blocks.size() / stretches; b < (i + 1) * run.blocks.size() / stretches;
             ++b)
            stretch.push_back(b);
        const auto one = level(stretch, q, 0);
        if (!one) return std::nullopt;
        levels[i] = *one;
    }
    double mean = 0, squares = 0;
    for (const double one : levels) mean += one / stretches;
    for (const double one : levels) squares += (one - mean) * (one - mean);
    return Scatter{.level = *whole, .blocks = deviation * deviation, .stretches = squares / (stretches - 1)};
}

double drift_of(const Scatter& run) {
    return run.stretches - run.blocks * stretches;
}

std::string two_digits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", value);
    return text;
}

std::string shortage(const char* name, const Measured& run, double q) {
    if (run.blocks.size() < least_blocks) return too_few(name, run.blocks.size(), least_blocks, "blocks");
    const std::uint64_t n = merged(run.blocks).count();
    if (n < needed_for(q)) return too_few(name, n, needed_for(q), "samples");
    if (run.reference.empty()) return {};
    if (run.reference.size() != run.blocks.size())
        return std::string(name) + " has no reference for each block";
    const std::uint64_t beside = merged(run.reference).count();
    return beside < needed_for(0.5) ? too_few(name, beside, needed_for(0.5), "samples of its reference") : "";
}

}  // namespace

const char* name_of(Verdict verdict) {
    return verdict == Verdict::better ? "better" : verdict == Verdict::worse ? "worse" : "undecided";
}

std::optional<Interval> bootstrap(std::size_t blocks_a, std::size_t blocks_b, const Statistic& statistic,
                                  const Bootstrap& how) {
    if (std::min(blocks_a, blocks_b) < least_blocks) return std::nullopt;
    const auto middle = statistic(numbers(blocks_a), numbers(blocks_b));
    if (!middle) return std::nullopt;
    std::mt19937_64 random(how.seed);
    const auto draw = [&random](std::vector<std::size_t>& some) {
        std::uniform_int_distribution<std::size_t> any(0, some.size() - 1);
        for (std::size_t& one : some) one = any(random);
    };
    std::vector<std::size_t> a(blocks_a), b(blocks_b);
    double sum = 0, squares = 0;
    for (int i = 0; i < how.resamples; ++i) {
        draw(a);
        draw(b);
        const auto drawn = statistic(a, b);
        if (!drawn) return std::nullopt;
        sum += *drawn - *middle;
        squares += (*drawn - *middle) * (*drawn - *middle);
    }
    const double n = how.resamples, mean = sum / n;
    const auto blocks = static_cast<double>(std::min(blocks_a, blocks_b));
    // Resampling n blocks underestimates the scatter by sqrt((n - 1) / n).
    const double spread = std::sqrt(std::max(0.0, squares / n - mean * mean) * blocks / (blocks - 1));
    const double reach = student(how.confidence, blocks - 1) * spread;
    return Interval{.low = *middle - reach, .high = *middle + reach};
}

Comparison compare(const Measured& before, const Measured& now, double q, const Bootstrap& how) {
    Comparison result;
    for (const auto& [name, run] : {std::pair("the old run", &before), {"the new run", &now}})
        if (result.problem.empty()) result.problem = shortage(name, *run, q);
    if (!result.problem.empty()) return result;
    Level old_level(before), new_level(now);
    const auto change = [&](std::span<const std::size_t> a, std::span<const std::size_t> b) {
        const auto was = old_level(a, q), is = new_level(b, q);
        return was && is ? std::optional(*is - *was) : std::nullopt;
    };
    const auto interval = bootstrap(before.blocks.size(), now.blocks.size(), change, how);
    if (!interval) {
        result.problem = "too few samples in some blocks; measure longer";
        return result;
    }
    result.ratio = std::exp((interval->low + interval->high) / 2);
    result.interval = {.low = std::exp(interval->low), .high = std::exp(interval->high)};
    if (interval->high < 0) result.verdict = Verdict::better;
    if (interval->low > 0) result.verdict = Verdict::worse;
    return result;
}

std::optional<double> drift(const Measured& run, double q, const Bootstrap& how) {
    const auto found = scatter(run, q, how);
    return found ? std::optional(drift_of(*found)) : std::nullopt;
}

Comparison compare_apart(const Measured& before, const Measured& now, double q, const MachineShift& machine,
                         const Bootstrap& how) {
    Comparison result;
    for (const auto& [name, run] : {std::pair("the old run", &before), {"the new run", &now}})
        if (result.problem.empty()) result.problem = shortage(name, *run, q);
    if (result.problem.empty() && machine.moved > std::log(most_moved))
        result.problem = "the machine's floors moved " + two_digits(std::exp(machine.moved)) +
                         " times between the runs; measure again on a steadier one";
    if (!result.problem.empty()) return result;
    const auto was = scatter(before, q, how), is = scatter(now, q, how);
    if (!was || !is) {
        result.problem = "too few samples in some blocks; measure longer";
        return result;
    }
    const auto blocks = static_cast<double>(std::min(before.blocks.size(), now.blocks.size()));
    double squares = 0;
    for (const Scatter& run : {*was, *is})
        // There are few stretches, and neighbours are alike: no more degrees of freedom than one run has.
        squares += reach_of(run.blocks, blocks, how.confidence) +
                   reach_of(std::max({0.0, drift_of(run), machine.drift}), stretches, how.confidence);
    const double middle = is->level - was->level, reach = std::sqrt(squares);
    result.ratio = std::exp(middle);
    result.interval = {.low = std::exp(middle - reach), .high = std::exp(middle + reach)};
    if (middle + reach < -machine.moved) result.verdict = Verdict::better;
    if (middle - reach > machine.moved) result.verdict = Verdict::worse;
    return result;
}

}  // namespace knurl::measure
