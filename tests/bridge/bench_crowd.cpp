// knurl_bench_crowd [--clients 64] [--seconds 4] [--rounds 3] [--bridge-priority N]: that many applications
// on one device, each with a claim, a force, 100 updates a second and every report; by turns all local and
// all through one bridge. What it costs: processor time of the bridge, and of the servo's thread for a cycle.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <latch>
#include <thread>

#include <sched.h>

#include "../client/servo_process.hpp"

namespace {

using namespace client_test;
namespace fs = std::filesystem;

constexpr double window = 0.1;  // s, of which the servo's cycle is taken: the median of windows

/// ns that a thread has run (proc(5), schedstat).
double ran(const fs::path& task) {
    std::ifstream file(task / "schedstat");
    double ns = 0;
    file >> ns;
    return ns;
}

/// All threads of a process.
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
    double bridge = 0;                      // cores
    std::vector<double> cycles;             // us of the servo's thread, one per window
    std::uint64_t reports = 0, missed = 0;  // of all clients together
    double seconds = 0;
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

void run(const fs::path& thread, const BridgeProcess* bridge, int clients, double seconds, Cost& cost) {
    std::atomic<bool> done = false;
    std::latch ready(clients);
    std::atomic<std::uint64_t> reports = 0, missed = 0;
    std::vector<std::thread> crowd;
    const std::string address = bridge != nullptr ? bridge->address() : "knurl:default";
    for (int i = 0; i < clients; ++i)
        crowd.emplace_back([&, i] {
            knurl::Client client = knurl::Client::connect(address, {.name = "crowd", .wait = 20s});
            knurl::Claim hand =
                client.claim("", {.shared = true, .update_interval = 10ms, .representations = 4});
            auto force = hand.add(knurl::ConstantForce{.force = {1e-4, 0, 0}});
            ready.count_down();
            std::uint64_t read = 0;
            for (std::uint64_t n = static_cast<std::uint64_t>(i); !done; ++n) {
                if (hand.next_report(100ms)) ++read;
                if (n % 10 != 0) continue;
                force.set({.force = {1e-4 * static_cast<double>(n / 10 % 10), 0, 0}});
                hand.commit();
            }
            reports += read;
            missed += hand.missed();
        });
    ready.wait();
    std::this_thread::sleep_for(300ms);  // a benchmark's pace: what their coming cost is not counted
    knurl::Client watcher = knurl::Client::connect("knurl:default", {.wait = 20s});
    knurl::Observer observer = watcher.observe();
    const auto begun = std::chrono::steady_clock::now();
    const double bridge_before = bridge != nullptr ? ran_in_all(bridge->pid()) : 0;
    double elapsed = 0, servo_before = ran(thread);
    std::uint64_t cycle_before = observer.latest() ? observer.latest()->cycle : 0;
    while (elapsed < seconds) {
        std::this_thread::sleep_for(std::chrono::duration<double>(window));  // so long is one window
        const auto report = observer.latest();
        const double servo_now = ran(thread);
        if (report && cycle_before != 0 && report->cycle > cycle_before)
            cost.cycles.push_back((servo_now - servo_before) * 1e-3 /
                                  static_cast<double>(report->cycle - cycle_before));
        cycle_before = report ? report->cycle : 0;
        servo_before = servo_now;
        elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    }
    if (bridge != nullptr) cost.bridge += (ran_in_all(bridge->pid()) - bridge_before) * 1e-9;
    cost.seconds += elapsed;
    done = true;
    for (std::thread& one : crowd) one.join();
    cost.reports += reports;
    cost.missed += missed;
}

void print(const char* name, const Cost& cost, int clients) {
    std::printf(
        "%-22s servo's cycle %6.2f us   bridge %5.2f cores   reports read %5.0f Hz each, %.2f %% missed\n",
        name, median(cost.cycles), cost.bridge / cost.seconds,
        static_cast<double>(cost.reports) / cost.seconds / clients,
        100 * static_cast<double>(cost.missed) /
            static_cast<double>(std::max<std::uint64_t>(1, cost.reports + cost.missed)));
}

}  // namespace

int main(int argc, char** argv) try {
    int clients = 64, rounds = 3, priority = 0;
    double seconds = 4;
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
        else
            throw std::runtime_error(word +
                                     " is unknown; known are --clients, --seconds, --rounds and "
                                     "--bridge-priority, each with a number");
    }
    const ServoProcess servo;
    knurl::Client::connect("knurl:default", {.wait = 20s});  // it is there
    const BridgeProcess bridge;
    if (priority > 0) {  // on a crowded machine: as if the bridge had a CPU when it wants one
        const sched_param real_time{.sched_priority = priority};
        if (::sched_setscheduler(bridge.pid(), SCHED_FIFO, &real_time) != 0)
            throw std::runtime_error("--bridge-priority takes the right to SCHED_FIFO");
    }
    const fs::path thread = servo_thread(servo.pid());
    Cost local, remote;
    for (int round = 0; round < rounds; ++round) {
        run(thread, nullptr, clients, seconds, local);
        run(thread, &bridge, clients, seconds, remote);
    }
    std::printf("%d applications, 100 updates/s and every report each, %d x %.0f s by turns\n", clients,
                rounds, seconds);
    print("all local", local, clients);
    print("all through a bridge", remote, clients);
    std::printf("servo's cycle, bridge against local: x%.3f\n", median(remote.cycles) / median(local.cycles));
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "knurl_bench_crowd: %s\n", error.what());
    return 1;
}
