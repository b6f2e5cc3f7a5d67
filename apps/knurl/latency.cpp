// knurl latency: how late a touch is, both ways, beside the floors of this machine, in one interleaved run.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "doctor_machine.hpp"
#include "latency_compare.hpp"
#include "latency_echo.hpp"
#include "latency_floors.hpp"
#include "latency_load.hpp"
#include "latency_network.hpp"
#include "latency_output.hpp"
#include "latency_paths.hpp"
#include "latency_record.hpp"
#include "measure.hpp"
#include "private_servo.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

constexpr Nanoseconds long_block = 50'000'000, short_block = 25'000'000, ping_pong_length = 5'000'000;  // ns
constexpr int udp_calls = 4;                 // there is time for so many, however far the bridge is
constexpr std::uint64_t commands_every = 4;  // updates: so many commands at least
constexpr int witness_priority = 95;         // above everybody: late only when the machine stands still
constexpr int waker_priority = 60;           // of the thread in knurld that wakes sleepers; the servo's is 80

struct Arguments {
    std::string connect;     // empty: a private servo
    std::string echo;        // of the servo's host, "host:port"; empty: our own, if that is this host
    std::string serve_echo;  // be that echo, and nothing else
    std::string device;      // empty: the only one
    std::uint64_t updates = 10'000;
    double seconds = 0;  // to measure for; 0: until there are so many updates
    double rate = 1000;  // Hz, of the private servo
    int servo_cpu = -1;  // -1: the last one that we may use
    int priority = 0;    // SCHED_FIFO of the client's thread; 0: ordinary
    std::uint64_t seed = 1;
    double wait = 2;  // s
    std::string load = "none";
    double percentile = 0;  // one more than the table has; 0: none
    std::string compare;    // with this earlier run; empty: with none
    std::string measured;   // which is compared, instead of measuring
    bool json = false;
    std::string json_file;  // empty: standard output
};

constexpr const char* network_scheme = "knurl://";

/// "host:port"; empty: it is on this box.
std::string bridge_of(const Arguments& arguments) {
    if (!arguments.connect.starts_with(network_scheme)) return "";
    return arguments.connect.substr(std::strlen(network_scheme));
}

Way way_of(const Arguments& arguments) {
    const std::string bridge = bridge_of(arguments);
    if (bridge.empty()) return Way::shared_memory;
    return bridge::resolve(bridge).loopback() ? Way::loopback : Way::network;
}

Placement placement_for(const Arguments& arguments) {
    const auto cpus = measure::allowed_cpus();
    if (cpus.empty()) throw std::runtime_error("the CPUs that this process may use cannot be read");
    Placement placement{.client_cpu = cpus.front(), .servo_cpu = cpus.back(), .priority = waker_priority};
    if (arguments.servo_cpu >= 0) {
        placement.servo_cpu = static_cast<unsigned>(arguments.servo_cpu);
        if (placement.servo_cpu == placement.client_cpu && cpus.size() > 1) placement.client_cpu = cpus[1];
    }
    return placement;
}

std::unique_ptr<PrivateServo> start_private(const Arguments& arguments, const Placement& placement) {
    return std::make_unique<PrivateServo>(std::vector<std::string>{
        "--device", "sim:cartesian3", "--rate", fmt::format("{:.17g}", arguments.rate), "--cpu",
        std::to_string(placement.servo_cpu)});
}

Client connect(const Arguments& arguments, PrivateServo* servo) {
    ConnectOptions options;
    options.name = "knurl latency";
    options.wait = std::chrono::milliseconds(std::llround((servo != nullptr ? 10 : arguments.wait) * 1e3));
    options.reattach = false;
    try {
        return Client::connect(servo != nullptr ? servo->address() : arguments.connect, options);
    } catch (const Error&) {
        if (servo != nullptr) servo->require_running();  // says why it is not
        throw;
    }
}

std::atomic<bool> interrupted = false;  // by Ctrl-C: what was measured so far is still worth having

/// What was to be measured, or as much of it as there was.
struct Measurement {
    LatencyRecord record;
    std::string ended;  // why there is no more of it; empty: it is complete
};

bool enough(const Arguments& arguments, const LatencyRecord& record, Nanoseconds end, bool remote) {
    if (arguments.seconds > 0) return now_ns() >= end;
    return record.updates() >= arguments.updates && record.commands() >= arguments.updates / commands_every &&
           (!remote || record.remote_updates() >= arguments.updates);
}

void run_round(LatencyPaths& paths, const Placement& placement, NetworkFloors& network, bool remote,
               FloorSamples& floors) {
    paths.updates_and_spinning_block(long_block);
    paths.blocking_block(short_block);
    ping_pong_block(placement, ping_pong_length, floors.ping_pong);
    paths.descriptor_block(short_block);
    eventfd_block(placement, short_block, floors.eventfd);
    network.udp_block(std::max(short_block, udp_calls * paths.round_trip()));
    if (remote) paths.updates_and_blocking_block(long_block);
    paths.commands_block(long_block, [&](bool counts) { network.tcp_ping_pong(counts); });
    bare_loop_block(placement, paths.period(), paths.deadline(), short_block, floors.bare_loop);
}

Measurement run_blocks(LatencyPaths& paths, const Placement& placement, NetworkFloors& network,
                       const Arguments& arguments, Way way) {
    Measurement all{.record = LatencyRecord(paths.period(), way), .ended = {}};
    const bool terminal = ::isatty(2) != 0, remote = way != Way::shared_memory;
    const Nanoseconds begin = now_ns(), end = begin + static_cast<Nanoseconds>(arguments.seconds * 1e9);
    while (all.ended.empty() && !enough(arguments, all.record, end, remote)) {
        FloorSamples floors;
        try {
            run_round(paths, placement, network, remote, floors);
        } catch (const std::exception& error) {
            all.ended = error.what();
        }
        floors.udp_one_way = network.udp_one_way();
        floors.tcp_round_trip = network.tcp_round_trip();
        const bool nothing = paths.samples().commit_to_write.empty();
        all.record.add(paths.samples(), floors);
        paths.forget();
        network.forget();
        if (interrupted && all.ended.empty()) all.ended = "interrupted";
        if (terminal)
            fmt::print(stderr, "\r{} updates in {:.0f} s ", all.record.updates(),
                       static_cast<double>(now_ns() - begin) * 1e-9);
        if (nothing && all.ended.empty() && paths.samples().lost > 100)
            all.ended = "the forces of the updates do not arrive; does another claim share the device?";
    }
    if (terminal) fmt::print(stderr, "\r{:40}\r", "");
    if (all.record.updates() == 0 && !all.ended.empty()) throw std::runtime_error(all.ended);
    return all;
}

void show(const Arguments& arguments, const measure::Run& run, const Aside& aside) {
    if (!arguments.json) {
        std::string text = aside.text;
        if (arguments.percentile > 0) text += percentile_text(run, arguments.percentile);
        measure::print(std::cout, run);
        std::cout << text << std::flush;
        return;
    }
    const std::string json = to_json(run, aside, arguments.percentile);
    if (arguments.json_file.empty()) {
        std::cout << json << std::flush;
        return;
    }
    std::ofstream file(arguments.json_file, std::ios::trunc);
    file << json;
    file.close();
    if (!file) throw std::runtime_error(arguments.json_file + ": cannot be written");
}

void check(const Arguments& arguments) {
    if (arguments.updates < 1)
        throw UsageError("--updates is 0; give 1 or more (10000 for a 99.9th percentile)");
    if (!(arguments.rate >= 500 && arguments.rate <= 20'000)) {
        throw UsageError(fmt::format("--rate is {:g} Hz; give 500 to 20000 Hz", arguments.rate));
    }
    if (!(arguments.wait >= 0 && arguments.wait <= 3600)) {
        throw UsageError(fmt::format("--wait is {:g} s; give 0 to 3600 s", arguments.wait));
    }
    if (!(arguments.seconds >= 0 && arguments.seconds <= 1e6))
        throw UsageError(fmt::format("--for is {:g} s; give up to 1000000 s", arguments.seconds));
    if (!(arguments.percentile >= 0 && arguments.percentile < 100))
        throw UsageError(
            fmt::format("--percentile is {:g}; give one between 0 and 100", arguments.percentile));
    const std::size_t needed = arguments.percentile > 0 ? measure::needed_for(arguments.percentile / 100) : 0;
    if (arguments.seconds == 0 && arguments.measured.empty() && needed > arguments.updates)
        throw UsageError(
            fmt::format("--percentile {:g} of {} updates would have fewer than ten of them above it; "
                        "give --updates {}",
                        arguments.percentile, arguments.updates, needed));
    if (!arguments.measured.empty() && arguments.compare.empty())
        throw UsageError("--measured is compared with an earlier run; name that by --compare OLD.json");
}

/// Two runs that lie in files.
int compare_files(const Arguments& arguments, const LatencyFile& before) {
    const LatencyComparison comparison = compare_runs(before, read_latency_file(arguments.measured));
    if (arguments.json && !arguments.json_file.empty()) {
        std::ofstream file(arguments.json_file, std::ios::trunc);
        file << to_json(comparison).dump(2) << "\n";
        file.close();
        if (!file) throw std::runtime_error(arguments.json_file + ": cannot be written");
    } else {
        std::cout << (arguments.json ? to_json(comparison).dump(2) + "\n" : to_text(comparison).substr(1));
    }
    return 0;
}

/// Whether a helper's thread gets the priority that it should have; says what is lost, of the private servo
/// too.
bool look_at_rights_here(const PrivateServo* servo) {
    bool real_time = false;
    std::thread([&real_time] { real_time = measure::run_real_time(waker_priority); }).join();
    if (!real_time)
        fmt::print(
            stderr,
            "knurl latency: no right to real-time priority (ulimit -r {}): floor.* are those of ordinary "
            "threads, and standstills of the machine are not told apart; the rest is measured\n",
            witness_priority);
    if (servo == nullptr) return real_time;
    for (const Finding& finding : look_at_rights(servo->said()))
        if (finding.grade != Grade::good)
            fmt::print(stderr, "knurl latency: the servo's {}: {}{}\n", finding.what, finding.says,
                       finding.mend.empty() ? "" : "; mend: " + finding.mend);
    return real_time;
}

int run_latency(const Arguments& arguments) {
    check(arguments);
    if (!arguments.serve_echo.empty()) serve_echo(arguments.serve_echo);
    // What cannot be read is found out before anything is measured.
    std::optional<LatencyFile> before;
    if (!arguments.compare.empty()) before = read_latency_file(arguments.compare);
    if (!arguments.measured.empty()) return compare_files(arguments, *before);
    const Placement placement = placement_for(arguments);
    const auto own = arguments.connect.empty() ? start_private(arguments, placement) : nullptr;
    Client client = connect(arguments, own.get());
    Claim hand = client.claim(arguments.device);
    const bool real_time = look_at_rights_here(own.get());
    const Load load(arguments.load);
    // The client's threads were made before: only this one, which measures, is bound to a CPU.
    if (!measure::pin_this_thread(placement.client_cpu)) {
        fmt::print(stderr, "knurl latency: cannot run on CPU {} alone; figures will be worse\n",
                   placement.client_cpu);
    }
    if (arguments.priority > 0 && !measure::run_real_time(arguments.priority)) {
        throw std::runtime_error(
            fmt::format("--priority {} is not allowed; raise the limit with ulimit -r {}, or leave "
                        "it out",
                        arguments.priority, arguments.priority));
    }
    const bridge::WireSizes sizes = bridge::wire_sizes(hand.network().encrypted);
    NetworkFloors network(bridge_of(arguments), arguments.echo, sizes, placement);
    LatencyPaths paths(hand, arguments.seed);
    const Way way = way_of(arguments);
    const bool remote = way != Way::shared_memory;
    std::optional<measure::Witness> witness;
    if (remote) witness.emplace(measure::allowed_cpus(), witness_priority);
    const double rate = hand.device().rate;  // as long as somebody is there to ask
    std::signal(SIGINT, [](int) { interrupted = true; });
    const Measurement seen = run_blocks(paths, placement, network, arguments, way);
    std::signal(SIGINT, SIG_DFL);

    LatencyFile now{.run = {.machine = measure::this_machine(), .results = seen.record.results()},
                    .setting = {}};
    now.setting = {{"servo", own ? "private" : arguments.connect},
                   {"rate", rate},
                   {"servo_cpu", placement.servo_cpu},
                   {"client_cpu", placement.client_cpu},
                   {"priority", arguments.priority},
                   {"real_time", real_time},
                   {"load", arguments.load},
                   {"load_threads", load.threads()},
                   {"seed", arguments.seed}};
    Aside aside{.setting = now.setting,
                .network = {},
                .comparison = {},
                .merged = paths.samples().merged,
                .lost = paths.samples().lost,
                .ended = seen.ended,
                .text = {}};
    std::string about_network;
    if (remote) {
        const auto bound = seen.record.bound(witness->gaps());
        if (bound) now.run.bounds.push_back(bound->use);
        about_network = network_text(hand.network(), sizes) + (bound ? to_text(*bound) : "");
        aside.network = network_json(hand.network(), sizes);
    }
    aside.text = fmt::format(
        "\n{} at {:g} Hz on CPU {}, client on CPU {} ({}), seed {}, load: {}; {} updates merged, {} "
        "lost.\nupdate.commit_to_write begins at the intended time, at random phase; report.* begin at "
        "the device's read;\nfloor.cache_line is one way, floor.bare_loop shares the servo's CPU.\n{}",
        own ? "private servo on sim:cartesian3" : arguments.connect, rate, placement.servo_cpu,
        placement.client_cpu,
        arguments.priority > 0 ? fmt::format("SCHED_FIFO {}", arguments.priority) : "ordinary priority",
        arguments.seed,
        load.threads() > 0
            ? fmt::format("{}, {} threads of ordinary priority", arguments.load, load.threads())
            : "none of ours",
        aside.merged, aside.lost, about_network);
    if (before) {
        const LatencyComparison comparison = compare_runs(*before, now);
        aside.comparison = to_json(comparison);
        aside.text += to_text(comparison);
    }
    show(arguments, now.run, aside);
    if (seen.ended.empty()) {
        hand.release();
        return 0;
    }
    throw std::runtime_error(
        fmt::format("{}; {} updates were measured until then", seen.ended, seen.record.updates()));
}

}  // namespace

void add_latency(CLI::App& program, Run& run) {
    auto* verb =
        program.add_subcommand("latency", "How late updates and reports are, beside this machine's floors");
    auto arguments = std::make_shared<Arguments>();
    verb->add_option("--connect", arguments->connect,
                     "measure this servo, whose device is armed and feels forces of 4 mN at most; "
                     "default: a private one on sim:cartesian3")
        ->type_name("knurl:NAME|knurl://HOST:PORT");
    verb->add_option("--echo", arguments->echo,
                     "a plain UDP and TCP echo on the servo's host: the floors of a measurement over a "
                     "network; default: an own one, where that is this host")
        ->type_name("HOST:PORT");
    verb->add_option("--serve-echo", arguments->serve_echo,
                     "be that echo, until interrupted, and measure nothing")
        ->type_name("HOST:PORT");
    verb->add_option("--device", arguments->device, "which of its devices; default: the only one")
        ->type_name("NAME");
    verb->add_option("--updates", arguments->updates,
                     "at random phase, and at least a quarter as many commands")
        ->capture_default_str()
        ->type_name("N");
    verb->add_option(
            "--for", arguments->seconds,
            "measure for that long, whatever the number of updates; hours take no more memory than minutes")
        ->type_name("SECONDS")
        ->excludes("--updates");
    verb->add_option(
            "--percentile", arguments->percentile,
            "one more than the table has; refused where it would have fewer than ten samples above it")
        ->type_name("P");
    verb->add_option("--load", arguments->load,
                     "a thread of ordinary priority on each CPU meanwhile: spin counts, memory moves 32 MiB "
                     "to and fro")
        ->capture_default_str()
        ->check(CLI::IsMember({"none", "spin", "memory"}));
    verb->add_option("--compare", arguments->compare,
                     "an earlier run's --json: what became better or worse since, and what may be noise")
        ->type_name("OLD.json");
    verb->add_option("--measured", arguments->measured, "compare this run of --json's, and measure nothing")
        ->type_name("NEW.json");
    verb->add_option("--rate", arguments->rate, "of the private servo")
        ->capture_default_str()
        ->type_name("HZ");
    verb->add_option("--servo-cpu", arguments->servo_cpu, "where the servo runs; default: the last CPU")
        ->check(CLI::Range(0, 1023))
        ->type_name("CPU");
    verb->add_option(
            "--priority", arguments->priority,
            "SCHED_FIFO, of the client's thread: what it would see on a CPU of its own; default: ordinary")
        ->check(CLI::Range(1, 79))
        ->type_name("N");
    verb->add_option("--seed", arguments->seed, "of the random phases")
        ->capture_default_str()
        ->type_name("N");
    verb->add_option("--wait", arguments->wait, "for a servo that is still starting")
        ->capture_default_str()
        ->type_name("SECONDS");
    auto* json =
        verb->add_option("--json", arguments->json_file, "for programs, into FILE or standard output")
            ->expected(0, 1)
            ->type_name("FILE");
    verb->footer(
        "A bridge that asks for keys: KNURL_KEY names the file with yours, as for every application "
        "(KNURL_KEY=~/anna.key knurl latency --connect knurl://lab:4096).\n"
        "A percentile with fewer than ten samples above it is left out (null).\n"
        "Coordinated omission: whoever waits for a late answer before asking again asks too seldom just when "
        "it is "
        "late. So updates count from the times at which they were meant to be sent, and where samples are "
        "due at a "
        "pace, one that took longer stands also for those that it kept from being taken.\n"
        "Ctrl-C ends a measurement: what it has seen is printed.");
    verb->callback([&run, arguments, json] {
        arguments->json = json->count() > 0;
        run = [arguments] { return run_latency(*arguments); };
    });
}

}  // namespace knurl::cli
