// knurl latency: the latency of touch in both directions, beside this machine's floors, in one interleaved
// run.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/measure/private_servo.hpp>
#include <knurl/measure/progress.hpp>
#include <knurl/servo/realtime.hpp>

#include "doctor_machine.hpp"
#include "latency_arguments.hpp"
#include "latency_compare.hpp"
#include "latency_echo.hpp"
#include "latency_floors.hpp"
#include "latency_load.hpp"
#include "latency_network.hpp"
#include "latency_output.hpp"
#include "latency_paths.hpp"
#include "latency_record.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

constexpr Nanoseconds long_block = 50'000'000, short_block = 25'000'000, ping_pong_length = 5'000'000;  // ns
constexpr int udp_calls = 4;                 // per round, so that even a distant bridge has time for them
constexpr std::uint64_t commands_every = 4;  // updates: so many commands at least
constexpr int witness_priority = 95;         // highest: it is late only when the machine stands still
constexpr int waker_priority = 60;           // of the thread in knurld that wakes sleepers; the servo's is 80

constexpr const char* network_scheme = "knurl://";

/// "host:port"; empty: it is on this box.
std::string bridge_of(const LatencyArguments& arguments) {
    if (!arguments.connect.starts_with(network_scheme)) return "";
    return arguments.connect.substr(std::strlen(network_scheme));
}

Way way_of(const LatencyArguments& arguments) {
    const std::string bridge = bridge_of(arguments);
    if (bridge.empty()) return Way::shared_memory;
    return bridge::resolve(bridge).loopback() ? Way::loopback : Way::network;
}

Placement placement_for(const LatencyArguments& arguments) {
    const auto cpus = measure::allowed_cpus();
    if (cpus.empty()) throw std::runtime_error("the CPUs that this process may use cannot be read");
    Placement placement{.client_cpu = cpus.front(), .servo_cpu = cpus.back(), .priority = waker_priority};
    if (arguments.servo_cpu >= 0) {
        placement.servo_cpu = static_cast<unsigned>(arguments.servo_cpu);
        if (placement.servo_cpu == placement.client_cpu && cpus.size() > 1) placement.client_cpu = cpus[1];
    }
    return placement;
}

std::unique_ptr<measure::PrivateServo> start_private(const LatencyArguments& arguments,
                                                     const Placement& placement) {
    return std::make_unique<measure::PrivateServo>(std::vector<std::string>{
        "--device", "sim:cartesian3", "--rate", fmt::format("{:.17g}", arguments.rate), "--cpu",
        std::to_string(placement.servo_cpu)});
}

Client connect(const LatencyArguments& arguments, measure::PrivateServo* servo) {
    ConnectOptions options;
    options.name = "knurl latency";
    options.wait = std::chrono::milliseconds(std::llround((servo != nullptr ? 10 : arguments.wait) * 1e3));
    options.reattach = false;
    try {
        return Client::connect(servo != nullptr ? servo->address() : arguments.connect, options);
    } catch (const Error&) {
        if (servo != nullptr) servo->require_running();  // says why it does not run
        throw;
    }
}

std::atomic<bool> interrupted = false;  // by Ctrl-C: the results so far are still useful

/// The measurement, complete or as far as it got.
struct Measurement {
    LatencyRecord record;
    std::string ended;  // why it is incomplete; empty: complete
};

bool enough(const LatencyArguments& arguments, const LatencyRecord& record, Nanoseconds end, bool remote) {
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
                       const LatencyArguments& arguments, Way way) {
    Measurement all{.record = LatencyRecord(paths.period(), way), .ended = {}};
    const bool remote = way != Way::shared_memory;
    measure::Progress progress("knurl latency");
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
        const double seconds = static_cast<double>(now_ns() - begin) * 1e-9;
        progress.show(arguments.seconds > 0
                          ? fmt::format("{}, {} updates", measure::seconds_of(seconds, arguments.seconds),
                                        all.record.updates())
                          : fmt::format("{} of {} updates in {:.0f} s", all.record.updates(),
                                        arguments.updates, seconds));
        if (nothing && all.ended.empty() && paths.samples().lost > 100)
            all.ended = "the forces of the updates do not arrive; does another claim share the device?";
    }
    if (all.record.updates() == 0 && !all.ended.empty()) throw std::runtime_error(all.ended);
    return all;
}

void show(const LatencyArguments& arguments, const measure::Run& run, const Aside& aside) {
    if (arguments.json) measure::write_file(arguments.json_file, to_json(run, aside, arguments.percentile));
    if (arguments.json && arguments.json_file == "-") return;  // standard output is for programs then
    std::string text = aside.text;
    if (arguments.percentile > 0) text += percentile_text(run, arguments.percentile);
    measure::print(std::cout, run);
    std::cout << text << std::flush;
}

/// Compares two saved runs.
int compare_files(const LatencyArguments& arguments, const LatencyFile& before) {
    const LatencyComparison comparison = compare_runs(before, read_latency_file(arguments.measured));
    if (arguments.json) measure::write_file(arguments.json_file, to_json(comparison).dump(2) + "\n");
    if (!arguments.json || arguments.json_file != "-") std::cout << to_text(comparison).substr(1);
    return 0;
}

/// True if a helper thread gets its priority; prints what is lost, also for the private servo.
bool look_at_rights_here(const measure::PrivateServo* servo) {
    bool real_time = false;
    std::thread([&real_time] { real_time = measure::run_real_time(waker_priority); }).join();
    if (!real_time)
        fmt::print(stderr,
                   "knurl latency: no right to real-time priority: floor.* are those of ordinary threads, "
                   "and standstills of the machine are not told apart; the rest is measured; {}\n",
                   servo::why_no_priority(witness_priority));
    if (servo == nullptr) return real_time;
    for (const Finding& finding : look_at_rights(servo->said()))
        if (finding.grade != Grade::good)
            fmt::print(stderr, "knurl latency: the servo's {}: {}{}\n", finding.what, finding.says,
                       finding.mend.empty() ? "" : "; mend: " + finding.mend);
    return real_time;
}

int run_latency(const LatencyArguments& arguments) {
    check(arguments);
    if (!arguments.serve_echo.empty()) serve_echo(arguments.serve_echo);
    // Unreadable or unwritable files must show before the measurement.
    if (arguments.json) measure::require_writable(arguments.json_file);
    std::optional<LatencyFile> before;
    if (!arguments.compare.empty()) before = read_latency_file(arguments.compare);
    if (!arguments.measured.empty()) return compare_files(arguments, *before);
    const Placement placement = placement_for(arguments);
    const auto own = arguments.connect.empty() ? start_private(arguments, placement) : nullptr;
    Client client = connect(arguments, own.get());
    Claim hand = client.claim(arguments.device);
    const bool real_time = look_at_rights_here(own.get());
    const Load load(arguments.load);
    // The client's threads exist already, so only this measuring thread is bound to a CPU.
    if (!measure::pin_this_thread(placement.client_cpu)) {
        fmt::print(stderr, "knurl latency: cannot run on CPU {} alone; figures will be worse\n",
                   placement.client_cpu);
    }
    if (arguments.priority > 0 && !measure::run_real_time(arguments.priority)) {
        throw std::runtime_error(fmt::format("--priority {} is not allowed: {}; or leave it out",
                                             arguments.priority, servo::why_no_priority(arguments.priority)));
    }
    const bridge::WireSizes sizes = bridge::wire_sizes(hand.network().encrypted);
    NetworkFloors network(bridge_of(arguments), arguments.echo, sizes, placement);
    LatencyPaths paths(hand, arguments.seed);
    const Way way = way_of(arguments);
    const bool remote = way != Way::shared_memory;
    std::optional<measure::Witness> witness;
    if (remote) witness.emplace(measure::allowed_cpus(), witness_priority);
    const double rate = hand.device().rate;  // read before the servo may end
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

void add_latency(commandline::Command& program) {
    auto& verb = program.verb("latency", "How late updates and reports are, beside this machine's floors");
    auto arguments = std::make_shared<LatencyArguments>();
    const auto fill = add_latency_options(verb, *arguments);
    verb.action([arguments, fill] {
        fill();
        return run_latency(*arguments);
    });
}

}  // namespace knurl::cli
