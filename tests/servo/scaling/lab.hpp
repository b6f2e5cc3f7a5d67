#pragma once
// How knurl_bench_scaling measures: the points of all series of an axis alternate, in a random order for
// every block. Processor time of this thread only.

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <knurl/measure/law.hpp>

#include "../../shm/bench/bench.hpp"

namespace knurl::servo::scaling {

struct Options {
    std::uint64_t seed = 1;
    int blocks = 30;
    bool quick = false;
};

/// One measured quantity, at one value of the axis.
struct Point {
    double n = 1;                    // 0: the reference for the others, not part of the law
    std::function<double()> sample;  // ns
    int samples = 1;                 // of a block
    std::vector<measure::Histogram> blocks{};
    std::vector<double> middles{};  // of each block: its median, or mean
};

/// A law to be found.
struct Series {
    std::string name, axis;  // "clients.idle.warm", "clients"
    measure::Growth design = measure::Growth::constant;
    std::string why;    // the reason by design
    bool mean = false;  // of a block: where only few of its cycles have the cost in question
    std::vector<Point> points{};

    const Point& at(double n) const;
};

class Lab {
  public:
    explicit Lab(const Options& options);

    const Options& options() const { return options_; }
    int blocks() const { return options_.blocks; }
    std::mt19937_64& random() { return random_; }
    double settling() const { return options_.quick ? 0.5 : 4; }  // s, for Rig::settle

    // The possible samples of a point. Mean of so many consecutive cycles.
    std::function<double()> in_a_row(std::function<void()> cycle, int count);
    /// One single cycle, after `before`, which is not timed. Includes the clock's two readings: clock_pair().
    std::function<double()> alone(std::function<void()> cycle, std::function<void()> before = {});
    /// The same, after this CPU has done a mebibyte of other work: first- and second-level caches are cold.
    std::function<double()> alone_and_cold(std::function<void()> cycle, std::function<void()> before = {});
    /// For `before`: a thread on another CPU does the work, like a client. The quick form does it here, since
    /// on a busy machine the other thread responds late.
    std::function<void()> elsewhere(std::function<void()> work);

    /// Fills in `blocks` and `middles` of all points.
    void measure(std::vector<Series>& axis);
    /// Median time of an empty pair of clock readings, ns.
    double clock_pair() const;

  private:
    Options options_;
    std::mt19937_64 random_;
    std::vector<std::uint64_t> other_work_;
    shm::bench::Helper client_;
};

/// Processor time of this thread, ns.
double thread_ns();

/// from, from * ratio, ... to, whole numbers.
std::vector<double> geometric(double from, double to, double ratio);

// The axes, each measured when it returns.
std::vector<Series> clients(Lab& lab);
std::vector<Series> readers(Lab& lab);
std::vector<Series> representations(Lab& lab);  // through a claim
std::vector<Series> scenes(Lab& lab);           // of a scene in this process
std::vector<Series> devices(Lab& lab);
std::vector<Series> updates(Lab& lab);
std::vector<Series> servo_rates(Lab& lab);

}  // namespace knurl::servo::scaling
