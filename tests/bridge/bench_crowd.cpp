// knurl_bench_crowd [--clients 64] [--seconds 4] [--rounds 3] [--keys 0|1] [--bridge-priority N] [--json
// FILE]: that many applications on one device, each with a claim, a force, 100 updates a second and every
// report. By turns all are local, all use one bridge, and all use it while one more application floods it.
// Measures the processor time of the bridge and, per cycle, of the servo's thread, and whether each update
// was applied.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <latch>
#include <thread>

#include <sched.h>
#include <sys/socket.h>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/bridge/keys.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/shm/fd.hpp>

#include "../client/servo_process.hpp"

namespace {

using namespace client_test;
namespace fs = std::filesystem;

constexpr double window = 0.1;  // s; the result for the servo's cycle is the median of such windows

/// ns that a thread has run (proc(5), schedstat).
double ran(const fs::path& task) {
    std::ifstream file(task / "schedstat");
    double ns = 0;
    file >> ns;
    return ns;
}

/// The same for all threads of a process.
double ran_in_all(pid_t pid) {
    double sum = 0;
    for (const auto& task : fs::directory_iterator("/proc/" + std::to_string(pid) + "/task"))
        sum += ran(task.path());
    return sum;
}

fs::path servo_thread(pid_t pid) {
    for (const auto& task : fs::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
        std::ifstream file(task.path() / "comm");
        std::string name;
        std::getline(file, name);
        if (name == "knurl-servo") return task.path();
    }
    throw std::runtime_error("knurld has no servo thread");
}

struct Cost {
    std::vector<double> bridge;             // cores, one per window
    std::vector<double> cycles;             // us of the servo's thread, one per window
    std::vector<double> in_time;            // per client, % of its updates acknowledged by its next one
    std::uint64_t reports = 0, missed = 0;  // of all clients together
    std::uint64_t updates = 0;
    int last_lost = 0;  // clients whose last update was not acknowledged within 10 s
    double seconds = 0;
};

/// The applications' connection.
struct Way {
    std::string address, key;
    const BridgeProcess* bridge = nullptr;  // none: they are local
    bool flooded = false;
};

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

knurl::Client connect_by(const Way& way) {
    return knurl::Client::connect(way.address, {.name = "crowd", .wait = 60s, .key_file = way.key});
}

/// An admitted application that commits 20 times a millisecond, and also sends 50 invalid datagrams: the
/// load from another machine, at a rate that leaves this machine's processors free.
void flood(const Way& way, const std::atomic<bool>& done) {
    knurl::Client client = connect_by(way);
    knurl::Claim hand = client.claim("", {.shared = true, .representations = 4});
    auto force = hand.add(knurl::ConstantForce{});
    const knurl::bridge::Endpoint to = knurl::bridge::resolve(way.bridge->host_and_port());
    const knurl::shm::UniqueFd socket(::socket(to.family(), SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const std::vector<char> junk(600, '?');
    auto next = std::chrono::steady_clock::now();
    for (int n = 0; !done; next = std::max(next + 1ms, std::chrono::steady_clock::now())) {
        for (int i = 0; i < 20; ++i) {
            force.set({.force = {1e-6 * (++n % 10), 0, 0}});
            hand.commit();
        }
        for (int i = 0; i < 50; ++i)
            ::sendto(socket.get(), junk.data(), junk.size(), MSG_NOSIGNAL, to.get(), to.length);
        std::this_thread::sleep_until(next);
    }
}

struct Outcome {
    std::uint64_t reports = 0, missed = 0, updates = 0, in_time = 0;
    bool last_applied = false;
};

Outcome take_part(const Way& way, std::uint64_t phase, std::latch& ready, const std::atomic<bool>& done) {
    knurl::Client client = connect_by(way);
    knurl::Claim hand = client.claim("", {.shared = true, .update_interval = 10ms, .representations = 4});
    auto force = hand.add(knurl::ConstantForce{.force = {1e-4, 0, 0}});
    ready.count_down();
    Outcome mine;
    std::uint64_t batch = 0;
    for (std::uint64_t n = phase; !done; ++n) {
        if (hand.next_report(100ms)) ++mine.reports;
        if (n % 10 != 0) continue;
        if (batch != 0 && hand.wait_applied(batch, 0ns)) ++mine.in_time;
        force.set({.force = {1e-4 * static_cast<double>(n / 10 % 10), 0, 0}});
        batch = hand.commit();
        ++mine.updates;
    }
    mine.last_applied = hand.wait_applied(batch, 10s);
    if (mine.last_applied) ++mine.in_time;
    mine.missed = hand.missed();
    return mine;
}

void run(const fs::path& thread, const Way& way, int clients, double seconds, Cost& cost) {
    std::atomic<bool> done = false;
    std::latch ready(clients);
    std::vector<std::thread> crowd;
    std::vector<Outcome> outcomes(static_cast<std::size_t>(clients));
    for (std::size_t i = 0; i < outcomes.size(); ++i)
        crowd.emplace_back([&, i] {
            try {
                outcomes[i] = take_part(way, i, ready, done);
            } catch (const std::exception& error) {  // the others would wait for this one without end
                std::fprintf(stderr, "knurl_bench_crowd: %s\n", error.what());
                std::_Exit(1);
            }
        });
    ready.wait();
    if (way.flooded) crowd.emplace_back([&] { flood(way, done); });
    std::this_thread::sleep_for(300ms);  // the cost of connecting is not counted
    knurl::Client watcher = knurl::Client::connect("knurl:default", {.wait = 20s});
    knurl::Observer observer = watcher.observe();
    const auto begun = std::chrono::steady_clock::now();
    const auto bridge_ran = [&] { return way.bridge != nullptr ? ran_in_all(way.bridge->pid()) : 0; };
    double elapsed = 0, servo_before = ran(thread), bridge_before = bridge_ran();
    std::uint64_t cycle_before = observer.latest() ? observer.latest()->cycle : 0;
    while (elapsed < seconds) {
        std::this_thread::sleep_for(std::chrono::duration<double>(window));
        const auto report = observer.latest();
        const double servo_now = ran(thread), bridge_now = bridge_ran();
        const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        if (report && cycle_before != 0 && report->cycle > cycle_before)
            cost.cycles.push_back((servo_now - servo_before) * 1e-3 /
                                  static_cast<double>(report->cycle - cycle_before));
        cost.bridge.push_back((bridge_now - bridge_before) * 1e-9 / (now - elapsed));
        cycle_before = report ? report->cycle : 0;
        servo_before = servo_now;
        bridge_before = bridge_now;
        elapsed = now;
    }
    cost.seconds += elapsed;
    done = true;
    for (std::thread& one : crowd) one.join();
    for (const Outcome& each : outcomes) {
        cost.reports += each.reports;
        cost.missed += each.missed;
        cost.updates += each.updates;
        cost.last_lost += each.last_applied ? 0 : 1;
        if (each.updates > 0)
            cost.in_time.push_back(100 * static_cast<double>(each.in_time) /
                                   static_cast<double>(each.updates));
    }
}

void print(const char* name, const Cost& cost, int clients) {
    std::printf(
        "%-22s servo's cycle %6.2f us   bridge %5.2f cores   reports read %5.0f Hz each, %.2f %% missed   "
        "updates %4.0f Hz each, %5.1f %% applied before the next, %d of %zu last ones never\n",
        name, median(cost.cycles), median(cost.bridge),
        static_cast<double>(cost.reports) / cost.seconds / clients,
        100 * static_cast<double>(cost.missed) /
            static_cast<double>(std::max<std::uint64_t>(1, cost.reports + cost.missed)),
        static_cast<double>(cost.updates) / cost.seconds / clients, median(cost.in_time), cost.last_lost,
        cost.in_time.size());
}

}  // namespace

int main(int argc, char** argv) try {
    int clients = 64, rounds = 3, priority = 0;
    double seconds = 4;
    bool keys = false;
    std::string json;
    for (int i = 1; i < argc; i += 2) {
        const std::string word = argv[i];
        if (i + 1 == argc) throw std::runtime_error(word + " is unknown, or its value is missing");
        if (word == "--clients")
            clients = std::stoi(argv[i + 1]);
        else if (word == "--seconds")
            seconds = std::stod(argv[i + 1]);
        else if (word == "--bridge-priority")
            priority = std::stoi(argv[i + 1]);
        else if (word == "--rounds")
            rounds = std::stoi(argv[i + 1]);
        else if (word == "--keys")
            keys = std::stoi(argv[i + 1]) != 0;
        else if (word == "--json")
            json = argv[i + 1];
        else
            throw std::runtime_error(word +
                                     " is unknown; known are --clients, --seconds, --rounds, --keys, "
                                     "--bridge-priority, each with a number, and --json FILE");
    }
    if (!json.empty()) knurl::measure::require_writable(json);
    const ServoProcess servo;
    knurl::Client::connect("knurl:default", {.wait = 20s});  // returns once the servo listens
    // A file with one key serves both the bridge and the key's owner.
    const std::string key = keys ? (servo.socket().parent_path() / "bridge.keys").string() : "";
    if (keys) knurl::bridge::add_key(key, knurl::bridge::make_key("crowd", knurl::bridge::Role::control));
    const BridgeProcess bridge(keys ? std::vector<std::string>{"--keys", key}
                                    : std::vector<std::string>{"--anyone"});
    if (priority > 0) {  // on a crowded machine: as if the bridge had a CPU whenever it needs one
        const sched_param real_time{.sched_priority = priority};
        if (::sched_setscheduler(bridge.pid(), SCHED_FIFO, &real_time) != 0)
            throw std::runtime_error("--bridge-priority takes the right to SCHED_FIFO");
    }
    const fs::path thread = servo_thread(servo.pid());
    Cost local, remote, flooded;
    const Way here{.address = "knurl:default", .key = ""},
        there{.address = bridge.address(), .key = key, .bridge = &bridge},
        under{.address = bridge.address(), .key = key, .bridge = &bridge, .flooded = true};
    for (int round = 0; round < rounds; ++round) {
        run(thread, here, clients, seconds, local);
        run(thread, there, clients, seconds, remote);
        run(thread, under, clients, seconds, flooded);
    }
    std::printf("%d applications, 100 updates/s and every report each, %d x %.0f s by turns, %s\n", clients,
                rounds, seconds, keys ? "with keys" : "without keys");
    print("all local", local, clients);
    print("all through a bridge", remote, clients);
    print("and one that floods it", flooded, clients);
    std::printf("servo's cycle, bridge against local: x%.3f; flooded against calm: x%.3f\n",
                median(remote.cycles) / median(local.cycles), median(flooded.cycles) / median(remote.cycles));
    const int status = local.last_lost + remote.last_lost + flooded.last_lost > 0 ? 1 : 0;
    if (json.empty()) return status;
    using knurl::measure::summarise;
    const auto calm = summarise("crowd.local.servo_cycle", "us", local.cycles);
    auto bridged = summarise("crowd.bridge.servo_cycle", "us", remote.cycles);
    auto beside = summarise("crowd.flooded.servo_cycle", "us", flooded.cycles);
    knurl::measure::relate(beside, bridged);
    knurl::measure::relate(bridged, calm);
    const knurl::measure::Run all{
        .machine = knurl::measure::this_machine(),
        .results = {calm, bridged, beside, summarise("crowd.bridge.processor", "cores", remote.bridge),
                    summarise("crowd.flooded.processor", "cores", flooded.bridge),
                    summarise("crowd.local.applied_in_time", "%", local.in_time),
                    summarise("crowd.bridge.applied_in_time", "%", remote.in_time),
                    summarise("crowd.flooded.applied_in_time", "%", flooded.in_time)}};
    knurl::measure::write_file(json, knurl::measure::to_json(all) + "\n");
    return status;
} catch (const std::exception& error) {
    std::fprintf(stderr, "knurl_bench_crowd: %s\n", error.what());
    return 1;
}
