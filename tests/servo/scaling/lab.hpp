#pragma once
// How knurl_bench_scaling measures: points of all series of an axis by turns, in an order drawn anew for
// every block; processor time of this thread alone.

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

/// One thing that is measured, for one value of what is varied.
struct Point {
    double n = 1;                    // 0: beside which the others are stated, not part of the law
    std::function<double()> sample;  // ns
    int samples = 1;                 // of a block
    std::vector<measure::Histogram> blocks{};
    std::vector<double> middles{};  // of each block: its median, or mean
};

/// A law to be found.
struct Series {
    std::string name, axis;  // "clients.idle.warm", "clients"
    measure::Growth design = measure::Growth::constant;
    std::string why;    // what makes it so by design
    bool mean = false;  // of a block: where a few of its cycles cost what is asked for
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

    // What a point's sample may be.
    /// Mean of so many cycles, one after the other.
    std::function<double()> in_a_row(std::function<void()> cycle, int count);
    /// One cycle by itself, after `before`, which is not timed. The clock's two readings are in it:
    /// clock_pair().
    std::function<double()> alone(std::function<void()> cycle, std::function<void()> before = {});
    /// The same, after this CPU has done a mebibyte of other work: caches of the first and second level are
    /// cold.
    std::function<double()> alone_and_cold(std::function<void()> cycle, std::function<void()> before = {});
    /// For `before`: done by a thread on another CPU, as a client would. The quick form does it here: on a
    /// busy machine the other one is long in coming.
    std::function<void()> elsewhere(std::function<void()> work);

    /// Fills in `blocks` and `middles` of all points.
    void measure(std::vector<Series>& axis);
    /// Median of what two readings of the clock with nothing between them take, ns.
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
