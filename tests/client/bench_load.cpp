// knurl_bench_load: the servo's cycle while a million triangles are sent and built, beside the same cycle in
// quiet, and beside other use of the caches. Thread CPU time of single cycles, in alternating blocks, at
// least 30 of each for a verdict.
//   knurl_bench_load [--blocks N] [--triangles N] [--json FILE]

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <thread>

#include <fcntl.h>
#include <generators.hpp>
#include <sched.h>

#include <knurl/json/json.hpp>
#include <knurl/measure/compare.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/measure/sleeper.hpp>

#include "cycle_reader.hpp"
#include "servo_process.hpp"

namespace {

using namespace client_test;
namespace fs = std::filesystem;
namespace measure = knurl::measure;

constexpr double most = 1.1;         // times the quiet servo's 99th percentile
constexpr auto block_time = 1100ms;  // the 99th percentile needs a thousand cycles; a load takes longer

/// Other work: at idle priority, like the builder, through 32 MiB back and forth.
class OtherWork {
  public:
    OtherWork()
        : thread_([this] {
              const sched_param none{};
              ::sched_setscheduler(0, SCHED_IDLE, &none);
              std::vector<char> memory(std::size_t{32} << 20);
              while (!stop_)
                  for (std::size_t i = 0; i < memory.size() && !stop_; i += 64) ++memory[i];
          }) {}
    ~OtherWork() {
        stop_ = true;
        thread_.join();
    }

  private:
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

struct Options {
    int blocks = 30;
    std::size_t triangles = 1'000'000;
    const char* file = nullptr;
};

class Bench {
  public:
    Bench(const Options& options, unsigned cpu)
        : client_(connect()), hand_(client_.claim()), reader_(servo_.pid(), cpu) {
        const auto cells = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(options.triangles) / 2)));
        shape_ = knurl::test::grid(cells, cells, 0.2 / cells, 0.2 / cells);
        for (auto& p : shape_.vertices) p[2] = 0.004 * std::sin(90 * p[0]) * std::cos(70 * p[1]);
        const knurl::Vec3 at = hand_.device().workspace_centre;
        hand_.add(knurl::Plane{.normal = {0, 0, 1}, .offset = at.z + 0.001, .stiffness = 200});
        hand_.arm();
        read_until(hand_, is_active);
    }
    std::size_t triangles() const { return shape_.triangles.size(); }

    std::vector<double> quiet() {
        return block([&] { wait(block_time); });
    }
    std::vector<double> beside_other_work() {
        const OtherWork work;
        return block([&] { wait(block_time); });
    }
    std::vector<double> loading() {
        std::optional<knurl::SentShape> sent;
        const auto cycles = block([&] {
            const auto begin = std::chrono::steady_clock::now();
            knurl::Sending sending = hand_.begin_sending(
                {.vertices = shape_.vertices, .triangles = shape_.triangles, .materials = {}});
            while (!(sent = sending.done())) wait(20ms);
            load_time_ = std::chrono::steady_clock::now() - begin;
        });
        hand_.forget(sent->asset);
        return cycles;
    }
    double load_seconds() const { return std::chrono::duration<double>(load_time_).count(); }

  private:
    template <class Do>
    std::vector<double> block(Do&& work) {
        wait(100ms);  // until the previous block has settled and its memory is returned
        reader_.keep_time(hand_.latest().value().deadline_ns);
        wait(5ms);
        reader_.begin();
        work();
        return reader_.collect();
    }
    /// As an application of 50 Hz.
    void wait(std::chrono::nanoseconds how_long) {
        const auto end = std::chrono::steady_clock::now() + how_long;
        do {
            hand_.commit();
            std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(how_long, 20ms));
        } while (std::chrono::steady_clock::now() < end);
    }

    ServoProcess servo_;
    knurl::Client client_;
    knurl::Claim hand_;
    CycleReader reader_;
    knurl::test::MadeMesh shape_;
    std::chrono::nanoseconds load_time_{};
};

/// Prints and returns the ratio of a percentile to the one before.
measure::Comparison compared(const char* what, double q, const measure::Blocks& before,
                             const measure::Blocks& now) {
    const auto result = measure::compare({.blocks = before.all(), .reference = {}},
                                         {.blocks = now.all(), .reference = {}}, q);
    if (result.problem.empty())
        std::printf("%s, %g %%: %.3f times (%.3f to %.3f)\n", what, 100 * q, result.ratio,
                    result.interval.low, result.interval.high);
    else
        std::printf("%s, %g %%: nothing to say: %s\n", what, 100 * q, result.problem.c_str());
    return result;
}

int run(const Options& options) {
    if (options.file) measure::require_writable(options.file);
    measure::Run run{.machine = measure::this_machine(), .results = {}};
    const auto cpus = measure::allowed_cpus();
    if (cpus.size() < 2) throw std::runtime_error("it needs a CPU beside the servo's; this process has one");
    Bench bench(options, cpus.front());
    measure::pin_this_thread(cpus.front());  // only now, since the servo would have inherited it
    bench.loading();                         // measures its duration, and touches all memory once
    measure::Blocks quiet, other, loading;
    for (int i = 0; i < options.blocks; ++i) {
        quiet.add(bench.quiet());
        loading.add(bench.loading());
        other.add(bench.beside_other_work());
    }
    std::printf("%zu triangles in %.2f s, %d blocks of each\n", bench.triangles(), bench.load_seconds(),
                options.blocks);
    run.results = {measure::summarise_blocks("servo's cycle, nobody else works", "us", quiet),
                   measure::summarise_blocks("servo's cycle, a mesh is loaded", "us", loading),
                   measure::summarise_blocks("servo's cycle, others use the caches", "us", other)};
    for (std::size_t i = 1; i < run.results.size(); ++i) measure::relate(run.results[i], run.results[0]);
    measure::print(std::cout, run);
    for (const double q : {0.5, 0.99}) {
        compared("others use the caches, to nobody else works", q, quiet, other);
        compared("a mesh is loaded, to others use the caches", q, other, loading);
    }
    compared("a mesh is loaded, to nobody else works", 0.5, quiet, loading);
    const auto goal = compared("a mesh is loaded, to nobody else works", 0.99, quiet, loading);
    const bool said = goal.problem.empty();
    const char* verdict = !said                        ? "undecided"
                          : goal.interval.high <= most ? "kept"
                          : goal.interval.low > most   ? "not kept"
                                                       : "undecided";
    std::printf("at most %g times: %s\n", most, verdict);
    knurl::Json json = knurl::Json::parse(measure::to_json(run));
    json["goals"] = knurl::Json::array();
    if (said)
        json["goals"].push_back({{"what", "servo's cycle while a mesh is loaded, 99 %, to nobody else works"},
                                 {"bound", most},
                                 {"low", goal.interval.low},
                                 {"high", goal.interval.high},
                                 {"verdict", verdict}});
    if (options.file) measure::write_file(options.file, json.dump(1) + '\n');
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; i += 2) {
        const std::string word = argv[i];
        const bool known = word == "--blocks" || word == "--triangles" || word == "--json";
        if (!known || i + 1 == argc) {
            std::fprintf(stderr, "knurl_bench_load: '%s': use [--blocks N] [--triangles N] [--json FILE]\n",
                         argv[i]);
            return 2;
        }
        if (word == "--json") options.file = argv[i + 1];
        if (word == "--blocks") options.blocks = std::max(1, std::atoi(argv[i + 1]));
        if (word == "--triangles") options.triangles = std::strtoull(argv[i + 1], nullptr, 10);
    }
    try {
        return run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl_bench_load: %s\n", error.what());
        return 1;
    }
}
