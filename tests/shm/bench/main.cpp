#include <cstdio>
#include <cstring>
#include <iostream>
#include <string_view>

#include "bench.hpp"

namespace {

using namespace knurl;

struct Part {
    std::string_view name;
    std::vector<measure::Result> (*run)(const shm::bench::Place&, const measure::Stopwatch&);
};
constexpr Part parts[] = {{"hand-over", shm::bench::hand_over},
                          {"publishing", shm::bench::publishing},
                          {"clients", shm::bench::clients},
                          {"waking", shm::bench::waking}};

}  // namespace

int main(int argc, char** argv) {
    bool json = false;
    std::string_view only;
    shm::bench::Place place;
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == "--json") {
            json = true;
        } else if (word == "--real-time") {
            place.real_time = true;
        } else if (word == "--long") {
            place.effort = 5;
        } else if (word == "--only" && i + 1 < argc) {
            only = argv[++i];
        } else {
            std::fprintf(
                stderr,
                "knurl_bench_rings [--json] [--real-time] [--long] [--only PART]\n"
                "  --real-time  spin under SCHED_FIFO: steadier, and unkind to all else on this machine\n"
                "  --long       five times the samples\n"
                "  --only       hand-over, publishing, clients or waking\n");
            return 2;
        }
    }
    const std::vector<unsigned> cpus = measure::allowed_cpus();
    if (cpus.size() < 2) {
        std::fprintf(stderr, "knurl_bench_rings: needs two CPUs; this process may use %zu\n", cpus.size());
        return 1;
    }
    place.servo_cpu = cpus[0];
    place.client_cpu = cpus[1];
    measure::pin_this_thread(place.servo_cpu);
    if (place.real_time && !measure::run_real_time(20)) {
        std::fprintf(stderr,
                     "knurl_bench_rings: no right to SCHED_FIFO; run as root or raise RLIMIT_RTPRIO\n");
        return 1;
    }

    measure::Run run{.machine = measure::this_machine(), .results = {}};
    const measure::Stopwatch clock;
    measure::Result timer;
    timer.name = "the timer itself (inside every figure marked t)";
    timer.unit = "ns";
    timer.n = 1001;
    timer.p50 = timer.max = clock.empty_interval();
    run.results.push_back(timer);
    for (const Part& part : parts) {
        if (!only.empty() && only != part.name) continue;
        for (measure::Result& result : part.run(place, clock)) run.results.push_back(std::move(result));
    }
    if (json)
        std::cout << measure::to_json(run) << "\n";
    else
        measure::print(std::cout, run);
    return 0;
}
