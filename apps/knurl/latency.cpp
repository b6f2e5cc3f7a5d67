// knurl latency: how late a touch is, both ways, beside the floors of this machine, in one interleaved run.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "latency_bound.hpp"
#include "latency_echo.hpp"
#include "latency_floors.hpp"
#include "latency_network.hpp"
#include "latency_paths.hpp"
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
    double rate = 1000;  // Hz, of the private servo
    int servo_cpu = -1;  // -1: the last one that we may use
    int priority = 0;    // SCHED_FIFO of the client's thread; 0: ordinary
    std::uint64_t seed = 1;
    double wait = 2;  // s
    bool json = false;
    std::string json_file;  // empty: standard output
};

constexpr const char* network_scheme = "knurl://";
struct FloorSamples {
    std::vector<double> ping_pong, eventfd, bare_loop;  // ns
};

/// Where a report comes from: a floor that is measured here says nothing about another host.
enum class Way { shared_memory, loopback, network };

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

FloorSamples run_blocks(LatencyPaths& paths, const Placement& placement, NetworkFloors& network,
                        std::uint64_t updates, bool remote) {
    FloorSamples floors;
    const bool terminal = ::isatty(2) != 0;
    const PathSamples& seen = paths.samples();
    while (seen.commit_to_write.size() < updates || seen.command.size() < updates / commands_every ||
           (remote && seen.to_use.size() < updates)) {
        const std::size_t before = seen.commit_to_write.size();
        paths.updates_and_spinning_block(long_block);
        paths.blocking_block(short_block);
        ping_pong_block(placement, ping_pong_length, floors.ping_pong);
        paths.descriptor_block(short_block);
        eventfd_block(placement, short_block, floors.eventfd);
        network.udp_block(std::max(short_block, udp_calls * paths.round_trip()));
        if (remote) paths.updates_and_blocking_block(long_block);
        paths.commands_block(long_block, [&](bool counts) { network.tcp_ping_pong(counts); });
        bare_loop_block(placement, paths.period(), paths.deadline(), short_block, floors.bare_loop);
        const std::size_t done = seen.commit_to_write.size();
        if (terminal)
            fmt::print(stderr, "\r{} of {} updates ", std::min<std::size_t>(done, updates), updates);
        if (done == before && seen.lost > 100) {
            throw std::runtime_error(
                "the forces of the updates do not arrive; does another claim share the device?");
        }
    }
    if (terminal) fmt::print(stderr, "\r{:40}\r", "");
    return floors;
}

std::vector<double> in_microseconds(std::vector<double> samples) {
    for (double& sample : samples) sample *= 1e-3;
    return samples;
}

/// Two things that happen one after the other and know nothing of each other.
std::vector<double> one_after_another(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> sums(std::min(a.size(), b.size()));
    std::transform(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(sums.size()), b.begin(), sums.begin(),
                   std::plus<>());
    return sums;
}

measure::Run summary(const PathSamples& paths, const FloorSamples& floors, const NetworkFloors& network,
                     Nanoseconds period, Way way, const std::optional<RemoteBound>& bound) {
    const auto result = [](const char* name, const std::vector<double>& samples) {
        return measure::summarise(name, "us", in_microseconds(samples));
    };
    const auto related = [&](const char* name, const std::vector<double>& samples,
                             const measure::Result& floor, bool fits) {
        auto r = result(name, samples);
        if (fits) measure::relate(r, floor);
        return r;
    };
    const bool local = way == Way::shared_memory;
    const auto ping_pong = result("floor.cache_line", floors.ping_pong);
    const auto eventfd = result("floor.eventfd_wake", floors.eventfd);
    const auto bare_loop = result("floor.bare_loop_lateness", floors.bare_loop);
    std::vector<double> cycles = paths.wait_for_use;
    for (double& wait : cycles) wait /= static_cast<double>(period);
    measure::Run run{
        .machine = measure::this_machine(),
        .results = {result("update.commit_to_write", paths.commit_to_write),
                    result("update.age_at_use", paths.wait_for_use),
                    measure::summarise("update.age_at_use_cycles", "cyc", std::move(cycles)),
                    measure::summarise("update.cycles_overlooked", "cyc", paths.overlooked),
                    result("update.report_age_at_use", paths.report_age),
                    related("report.spinning", paths.spinning, ping_pong, local),
                    related("report.blocking", paths.blocking, eventfd, local),
                    related("report.descriptor", paths.descriptor, eventfd, local),
                    result("report.spinning_from_deadline", paths.spinning_deadline),
                    result("report.blocking_from_deadline", paths.blocking_deadline),
                    result("report.descriptor_from_deadline", paths.descriptor_deadline),
                    related("servo.lateness", paths.servo_lateness, bare_loop, way != Way::network),
                    ping_pong, eventfd, bare_loop}};
    if (local) {
        run.results.push_back(result("command.round_trip", paths.command));
        run.results.push_back(related("command.less_cycle_wait", paths.command_less_wait, eventfd, true));
        return run;
    }
    // Over a network a report wakes the bridge, goes one way, and wakes the reader; an answer likewise.
    const auto& udp = network.udp_one_way();
    const auto& tcp = network.tcp_round_trip();
    const auto wake_and_udp = result("floor.wake_and_udp", one_after_another(floors.eventfd, udp));
    const auto round_trip = result("floor.tcp_round_trip", tcp);
    const auto wake_and_tcp = result("floor.wake_and_tcp", one_after_another(floors.eventfd, tcp));
    for (measure::Result& more : std::vector<measure::Result>{
             result("update.remote_to_use", paths.to_use), result("update.remote_to_write", paths.to_write),
             related("report.blocking_after_write", paths.after_write, wake_and_udp, true),
             result("floor.udp_one_way", udp), wake_and_udp,
             related("command.round_trip", paths.command, round_trip, true),
             related("command.less_cycle_wait", paths.command_less_wait, wake_and_tcp, true), round_trip,
             wake_and_tcp})
        run.results.push_back(std::move(more));
    if (bound) run.bounds.push_back(bound->use);
    return run;
}

/// The table, and what is true of all of it.
std::string to_json(const measure::Run& run, const PathSamples& samples,
                    const nlohmann::ordered_json& network) {
    auto all = nlohmann::ordered_json::parse(measure::to_json(run));
    all["updates"] = {{"merged", samples.merged}, {"lost", samples.lost}};
    all["network"] = network;
    return all.dump(2) + "\n";
}

void show(const Arguments& arguments, const measure::Run& run, const std::string& setting,
          const std::string& json) {
    if (!arguments.json) {
        measure::print(std::cout, run);
        std::cout << setting << "\n";
        return;
    }
    if (arguments.json_file.empty()) {
        std::cout << json;
        return;
    }
    std::ofstream file(arguments.json_file, std::ios::trunc);
    file << json;
    file.close();
    if (!file) throw std::runtime_error(arguments.json_file + ": cannot be written");
}

int run_latency(const Arguments& arguments) {
    if (arguments.updates < 1)
        throw UsageError("--updates is 0; give 1 or more (10000 for a 99.9th percentile)");
    if (!(arguments.rate >= 500 && arguments.rate <= 20'000)) {
        throw UsageError(fmt::format("--rate is {:g} Hz; give 500 to 20000 Hz", arguments.rate));
    }
    if (!(arguments.wait >= 0 && arguments.wait <= 3600)) {
        throw UsageError(fmt::format("--wait is {:g} s; give 0 to 3600 s", arguments.wait));
    }
    if (!arguments.serve_echo.empty()) serve_echo(arguments.serve_echo);
    const Placement placement = placement_for(arguments);
    const auto own = arguments.connect.empty() ? start_private(arguments, placement) : nullptr;
    Client client = connect(arguments, own.get());
    Claim hand = client.claim(arguments.device);
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
    const FloorSamples floors = run_blocks(paths, placement, network, arguments.updates, remote);
    const double rate = hand.device().rate;
    std::string about_network;
    nlohmann::ordered_json network_for_programs;  // null: there is none
    std::optional<RemoteBound> bound;
    if (remote) {
        bound = remote_bound(paths.samples(), network.udp_one_way(), floors.eventfd, paths.period(),
                             witness->gaps());
        const Network seen = hand.network();
        about_network = network_text(seen, sizes) + (bound ? to_text(*bound) : "");
        network_for_programs = network_json(seen, sizes);
    }
    hand.release();

    const PathSamples& samples = paths.samples();
    const measure::Run run = summary(samples, floors, network, paths.period(), way, bound);
    show(arguments, run,
         fmt::format(
             "\n{} at {:g} Hz on CPU {}, client on CPU {} ({}), seed {}; {} updates merged, {} "
             "lost.\nupdate.commit_to_write begins at the intended time, at random phase; report.* begin at "
             "the device's read;\nfloor.cache_line is one way, floor.bare_loop shares the servo's CPU.\n{}",
             own ? "private servo on sim:cartesian3" : arguments.connect, rate, placement.servo_cpu,
             placement.client_cpu,
             arguments.priority > 0 ? fmt::format("SCHED_FIFO {}", arguments.priority) : "ordinary priority",
             arguments.seed, samples.merged, samples.lost, about_network),
         to_json(run, samples, network_for_programs));
    return 0;
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
        "A percentile with fewer than ten samples above it is left out (null).");
    verb->callback([&run, arguments, json] {
        arguments->json = json->count() > 0;
        run = [arguments] { return run_latency(*arguments); };
    });
}

}  // namespace knurl::cli
