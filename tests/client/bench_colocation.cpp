// knurl_bench_colocation: what a simulation and a renderer cost the servo and each other on one machine, by
// their placement. The placements alternate in blocks, in an order that changes from round to round.
//   knurl_bench_colocation --one PID HOST:PORT --all PID HOST:PORT [--blocks N] [--json FILE]
// For two running simulations that speak IMD: one with a single thread, one with any number. scripts/dock
// --placement starts them and states the other conditions.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <random>

#include <fmt/format.h>
#include <sched.h>

#include <knurl/json/json.hpp>
#include <knurl/measure/compare.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>

#include "cycle_reader.hpp"
#include "imd.hpp"
#include "servo_process.hpp"

namespace {

using namespace client_test;
namespace fs = std::filesystem;
namespace measure = knurl::measure;

constexpr auto block_time = 1100ms;  // the 99th percentile needs a thousand cycles
constexpr auto settle_time = 150ms;  // left out of the figures
constexpr double same = 1.05;        // times the median without a simulation

/// A simulation that computes only in its blocks.
class Engine {
  public:
    Engine(pid_t pid, const std::string& address) : pid_(pid), imd_(address, 20s) {
        imd_.set_rate(steps_per_frame);
        while (!imd_.next())
            if (imd_.ended() || !imd_.wait(20s)) throw std::runtime_error(address + ": no frame comes");
        rest();
    }
    ~Engine() { work(); }
    void rest() { ::kill(pid_, SIGSTOP); }
    void work() { ::kill(pid_, SIGCONT); }
    void run_on(unsigned cpu) {
        cpu_set_t set;
        CPU_ZERO(&set);
        CPU_SET(cpu, &set);
        for (const auto& task : fs::directory_iterator("/proc/" + std::to_string(pid_) + "/task"))
            ::sched_setaffinity(std::stoi(task.path().filename()), sizeof set, &set);
    }
    std::size_t threads() const {
        const fs::directory_iterator tasks("/proc/" + std::to_string(pid_) + "/task");
        return static_cast<std::size_t>(std::distance(tasks, fs::directory_iterator()));
    }
    /// Number of steps computed since its start, by the frames received.
    std::int64_t step() {
        while (const auto frame = imd_.next())
            if (frame->energies) step_ = frame->energies->step;
        if (imd_.ended()) throw std::runtime_error("the simulation has ended");
        return step_;
    }

  private:
    static constexpr int steps_per_frame = 10;
    pid_t pid_;
    dock::Imd imd_;
    std::int64_t step_ = 0;
};

double cpu_seconds() {
    timespec now;
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Like a renderer of 60 Hz: 8 ms of a processor for each picture, through 16 MiB.
class Renderer {
  public:
    explicit Renderer(unsigned cpu)
        : thread_([this, cpu] {
              measure::settle_on(cpu, 0);
              run();
          }) {}
    ~Renderer() { end(); }
    /// ms from a picture's due time until it was ready.
    std::vector<double> end() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
        return pictures_;
    }

  private:
    static constexpr measure::Nanoseconds period = 16'666'667;
    static constexpr double work = 8e-3;  // s
    void run() {
        std::vector<char> memory(std::size_t{16} << 20);
        std::size_t at = 0;
        for (measure::Nanoseconds due = measure::now_ns(); !stop_;) {
            const double begin = cpu_seconds();
            while (cpu_seconds() - begin < work)
                for (int i = 0; i < 1000; ++i, at = (at + 64) % memory.size()) ++memory[at];
            const measure::Nanoseconds now = measure::now_ns();
            pictures_.push_back(1e-6 * static_cast<double>(now - due));
            due = std::max(due + period, now - period);  // skipped pictures are not drawn later
            measure::sleep_until(due);
        }
    }
    std::atomic<bool> stop_ = false;
    std::vector<double> pictures_;
    std::thread thread_;
};

/// An application that sleeps until a report comes, beside others that do too, so that the waker wakes it.
class Sleeper {
  public:
    Sleeper(knurl::Client& client, unsigned cpu) : watch_(client.observe()) {
        thread_ = std::thread([this, cpu] {
            measure::settle_on(cpu, 0);
            while (!stop_) see(watch_.next_report(100ms));
        });
    }
    ~Sleeper() {
        stop_ = true;
        thread_.join();
    }
    struct Seen {
        std::vector<double> late, age;  // us: the servo's own lateness, and the report's age at arrival
    };
    Seen take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(seen_, {});
    }

  private:
    void see(const std::optional<knurl::HandReport>& report) {
        if (!report) return;
        const measure::Nanoseconds now = measure::now_ns();
        const std::lock_guard lock(mutex_);
        seen_.late.push_back(1e-3 * static_cast<double>(report->read_ns - report->deadline_ns));
        seen_.age.push_back(1e-3 * static_cast<double>(now - report->read_ns));
    }
    knurl::Observer watch_;
    std::atomic<bool> stop_ = false;
    std::mutex mutex_;
    Seen seen_;
    std::thread thread_;
};

enum class Simulation { none, beside, under, everywhere };

struct Placement {
    const char* name;
    Simulation simulation;
    bool renders;  // a renderer runs beside the servo
    measure::Blocks cycle{}, late{}, age{}, pictures{};
    double steps = 0, seconds = 0;
    std::size_t drawn = 0;
};

class Bench {
  public:
    Bench(Engine& one, Engine& all, unsigned servo_cpu, unsigned other)
        : one_(one),
          all_(all),
          servo_cpu_(servo_cpu),
          other_(other),
          servo_({"--device", "sim:cartesian3", "--cpu", std::to_string(servo_cpu)}),
          client_(connect()),
          hand_(client_.claim()),
          reader_(servo_.pid(), other),
          first_(client_, other),
          second_(client_, other) {
        const knurl::Vec3 at = hand_.device().workspace_centre;
        hand_.add(knurl::Plane{.normal = {0, 0, 1}, .offset = at.z + 0.001, .stiffness = 200});
        hand_.arm();
        read_until(hand_, is_active);
    }

    void block(Placement& placement) {
        Engine* const engine = placement.simulation == Simulation::none         ? nullptr
                               : placement.simulation == Simulation::everywhere ? &all_
                                                                                : &one_;
        if (placement.simulation == Simulation::beside) one_.run_on(other_);
        if (placement.simulation == Simulation::under) one_.run_on(servo_cpu_);
        if (engine != nullptr) engine->work();
        std::optional<Renderer> renderer;
        if (placement.renders) renderer.emplace(other_);
        wait(settle_time, engine);
        reader_.keep_time(hand_.latest().value().deadline_ns);
        wait(5ms, engine);
        const std::int64_t step = engine != nullptr ? engine->step() : 0;
        const auto begin = std::chrono::steady_clock::now();
        first_.take();
        reader_.begin();
        wait(block_time, engine);
        placement.cycle.add(reader_.collect());
        const Sleeper::Seen seen = first_.take();
        placement.late.add(seen.late);
        placement.age.add(seen.age);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        placement.seconds += seconds;
        if (engine != nullptr) placement.steps += static_cast<double>(engine->step() - step);
        if (renderer) {
            const std::vector<double> pictures = renderer->end();
            placement.pictures.add(pictures);
            placement.drawn += pictures.size();
        }
        if (engine != nullptr) engine->rest();
    }

  private:
    /// As an application of 50 Hz.
    void wait(std::chrono::nanoseconds how_long, Engine* engine) {
        const auto end = std::chrono::steady_clock::now() + how_long;
        do {
            hand_.commit();
            if (engine != nullptr) engine->step();
            std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(how_long, 20ms));
        } while (std::chrono::steady_clock::now() < end);
    }

    Engine &one_, &all_;
    unsigned servo_cpu_, other_;
    ServoProcess servo_;
    knurl::Client client_;
    knurl::Claim hand_;
    CycleReader reader_;
    Sleeper first_, second_;
};

std::string number(const std::optional<double>& value) {
    return !value ? "?" : *value < 100 ? fmt::format("{:.3g}", *value) : fmt::format("{:.0f}", *value);
}

std::string percentiles(const measure::Blocks& blocks, bool with_most) {
    const measure::Histogram all = measure::merged(blocks.all());
    const std::string text = number(all.percentile(0.5)) + ", " + number(all.percentile(0.99));
    return with_most ? text + ", " + fmt::format("{:.0f}", all.max()) : text;
}

void print_table(const std::vector<Placement>& placements) {
    fmt::print(
        "\n| simulation | servo's cycle (processor time), us: median, 99 % | servo late, us: median, 99 %, "
        "most | "
        "report had by who sleeps, us after the read: median, 99 % | steps/s | pictures/s; ready after, ms: "
        "median, "
        "99 % |\n|---|---|---|---|---|---|\n");
    for (const Placement& p : placements)
        fmt::print("| {} | {} | {} | {} | {} | {} |\n", p.name, percentiles(p.cycle, false),
                   percentiles(p.late, true), percentiles(p.age, false),
                   p.simulation == Simulation::none ? "" : fmt::format("{:.0f}", p.steps / p.seconds),
                   p.renders
                       ? fmt::format("{:.0f}; {}",
                                     static_cast<double>(p.drawn) /
                                         (p.seconds * (1 + std::chrono::duration<double>(settle_time) /
                                                               std::chrono::duration<double>(block_time))),
                                     percentiles(p.pictures, false))
                       : "");
}

struct Options {
    pid_t one = 0, all = 0;
    std::string one_address, all_address;
    int blocks = 30;
    const char* file = nullptr;
};

int run(const Options& options) {
    if (options.file != nullptr) measure::require_writable(options.file);
    const auto cpus = measure::allowed_cpus();
    if (cpus.size() < 2) throw std::runtime_error("it needs a CPU beside the servo's; this process has one");
    const unsigned servo_cpu = cpus.back(), other = cpus.front();
    measure::Run run{.machine = measure::this_machine(), .results = {}};
    Engine one(options.one, options.one_address), all(options.all, options.all_address);  // first: they fork
    Bench bench(one, all, servo_cpu, other);
    measure::pin_this_thread(other);  // only now, since the servo would have inherited it
    std::vector<Placement> placements{
        {"none", Simulation::none, false},
        {"one thread on the other core", Simulation::beside, false},
        {"one thread on the servo's core", Simulation::under, false},
        {"a thread on every core", Simulation::everywhere, false},
        {"one thread on the servo's core, a renderer on the other", Simulation::under, true},
        {"one thread on the other core, a renderer there too", Simulation::beside, true},
    };
    std::mt19937 random(1);
    std::vector<std::size_t> order(placements.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (int i = 0; i < options.blocks; ++i) {
        std::shuffle(order.begin(), order.end(), random);
        for (const std::size_t which : order) bench.block(placements[which]);
    }
    const measure::Machine& m = run.machine;
    fmt::print(
        "{}, {} CPUs, Linux {}, load {}, {}; servo on CPU {}, the other is {}; {} blocks of {} ms each\n",
        m.processor, m.cpus, m.kernel, m.load, m.date, servo_cpu, other, options.blocks, block_time.count());
    print_table(placements);
    fmt::print("\n");
    knurl::Json goals = knurl::Json::array();
    for (const Placement& p : placements) {
        run.results.push_back(
            measure::summarise_blocks(fmt::format("servo's cycle, simulation: {}", p.name), "us", p.cycle));
        run.results.push_back(
            measure::summarise_blocks(fmt::format("servo late, simulation: {}", p.name), "us", p.late));
        if (&p == &placements.front()) continue;
        const auto found = measure::compare({.blocks = placements.front().cycle.all(), .reference = {}},
                                            {.blocks = p.cycle.all(), .reference = {}}, 0.5);
        if (!found.problem.empty()) {
            fmt::print("{}: nothing to say: {}\n", p.name, found.problem);
            continue;
        }
        const char* verdict = found.interval.high <= same ? "kept"
                              : found.interval.low > same ? "not kept"
                                                          : "undecided";
        fmt::print(
            "{}: the median cycle is {:.3f} times that without a simulation ({:.3f} to {:.3f}); at most "
            "{:g}: {}\n",
            p.name, found.ratio, found.interval.low, found.interval.high, same, verdict);
        goals.push_back({{"what", fmt::format("servo's median cycle to that alone, simulation: {}", p.name)},
                         {"bound", same},
                         {"low", found.interval.low},
                         {"high", found.interval.high},
                         {"verdict", verdict}});
    }
    if (options.file == nullptr) return 0;
    knurl::Json json = knurl::Json::parse(measure::to_json(run));
    json["goals"] = goals;
    measure::write_file(options.file, json.dump(1) + '\n');
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    const std::vector<std::string> words(argv + 1, argv + argc);
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string& word = words[i];
        const std::size_t left = words.size() - i - 1;
        if (word == "--one" && left >= 2) {
            options.one = std::atoi(words[++i].c_str());
            options.one_address = words[++i];
        } else if (word == "--all" && left >= 2) {
            options.all = std::atoi(words[++i].c_str());
            options.all_address = words[++i];
        } else if (word == "--blocks" && left >= 1) {
            options.blocks = std::max(1, std::atoi(words[++i].c_str()));
        } else if (word == "--json" && left >= 1) {
            options.file = argv[++i + 1];
        } else {
            options.one = 0;
            break;
        }
    }
    if (options.one <= 0 || options.all <= 0) {
        std::fprintf(
            stderr,
            "knurl_bench_colocation --one PID HOST:PORT --all PID HOST:PORT [--blocks N] [--json FILE]: two "
            "simulations that run; scripts/dock --placement starts them\n");
        return 2;
    }
    try {
        return run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl_bench_colocation: %s\n", error.what());
        return 1;
    }
}
