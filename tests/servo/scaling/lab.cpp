#include "lab.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <stdexcept>

namespace knurl::servo::scaling {

namespace {

constexpr std::size_t other_bytes = 1 << 20;

unsigned first_cpu() {
    const auto cpus = measure::allowed_cpus();
    return cpus.empty() ? 0 : cpus.front();
}

double middle_of(std::vector<double>& samples, bool mean) {
    if (mean)
        return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
    const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
    std::nth_element(samples.begin(), middle, samples.end());
    return *middle;
}

}  // namespace

double thread_ns() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
}

std::vector<double> geometric(double from, double to, double ratio) {
    std::vector<double> values;
    for (double n = from; n < to * 1.001; n *= ratio)
        if (values.empty() || std::round(n) > values.back()) values.push_back(std::round(n));
    return values;
}

const Point& Series::at(double n) const {
    for (const Point& point : points)
        if (point.n == n) return point;
    throw std::logic_error(name + " was not measured at " + std::to_string(n));
}

Lab::Lab(const Options& options)
    : options_(options),
      random_(options.seed),
      other_work_(other_bytes / sizeof(std::uint64_t)),
      client_(first_cpu(), false) {
    const auto cpus = measure::allowed_cpus();
    if (!cpus.empty()) measure::pin_this_thread(cpus.back());
}

std::function<double()> Lab::in_a_row(std::function<void()> cycle, int count) {
    return [cycle = std::move(cycle), count] {
        const double begin = thread_ns();
        for (int i = 0; i < count; ++i) cycle();
        return (thread_ns() - begin) / count;
    };
}

std::function<double()> Lab::alone(std::function<void()> cycle, std::function<void()> before) {
    return [cycle = std::move(cycle), before = std::move(before)] {
        if (before) before();
        const double begin = thread_ns();
        cycle();
        return thread_ns() - begin;
    };
}

std::function<double()> Lab::alone_and_cold(std::function<void()> cycle, std::function<void()> before) {
    return alone(std::move(cycle), [this, before = std::move(before)] {
        if (before) before();
        constexpr std::size_t line = 64 / sizeof(std::uint64_t);
        for (std::size_t i = 0; i < other_work_.size(); i += line) ++other_work_[i];
        thread_ns();  // touches the kernel's own cache lines, which are no part of the servo
    });
}

std::function<void()> Lab::elsewhere(std::function<void()> work) {
    if (options_.quick) return work;
    return [this, work = std::move(work)] {
        client_.start(work);
        client_.finish();
    };
}

void Lab::measure(std::vector<Series>& axis) {
    constexpr int warm_up = 2;
    struct Turn {
        Point& point;
        bool mean;
    };
    std::vector<Turn> turns;
    for (Series& series : axis)
        for (Point& point : series.points) turns.push_back({point, series.mean});
    std::vector<std::size_t> order(turns.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<double> samples;
    for (int block = 0; block < options_.blocks; ++block) {
        std::shuffle(order.begin(), order.end(), random_);
        for (const std::size_t which : order) {
            auto& [point, mean] = turns[which];
            for (int i = 0; i < warm_up; ++i) point.sample();
            samples.clear();
            measure::Histogram& histogram = point.blocks.emplace_back();
            for (int i = 0; i < point.samples; ++i) {
                samples.push_back(point.sample());
                histogram.record(samples.back());
            }
            point.middles.push_back(middle_of(samples, mean));
        }
    }
}

double Lab::clock_pair() const {
    std::vector<double> pairs;
    for (int i = 0; i < 1001; ++i) {
        const double begin = thread_ns();
        pairs.push_back(thread_ns() - begin);
    }
    return middle_of(pairs, false);
}

}  // namespace knurl::servo::scaling
