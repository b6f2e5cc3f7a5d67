// What a process of its own costs a device: the time from the servo's write to the call of the maker's library (here a
// counterfeit that returns at once), at 1 kHz. Beside it, in the same run, a futex that wakes a thread of the same
// process: what any hand-over costs on this machine.

#include <algorithm>
#include <atomic>
#include <climits>
#include <cstdio>
#include <ctime>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <linux/futex.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <knurl/drivers/registry.hpp>

#include "vendor_bench.hpp"

namespace {

using knurl::counterfeit::now_ns;

constexpr int priority = 80;

void real_time(int level) {
    const sched_param parameters{.sched_priority = level};
    if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0)
        std::puts("no real-time priority: figures of an ordinary thread");
    prctl(PR_SET_TIMERSLACK, 1UL);
}
/// Idle CPUs poll, as knurld has it by default, where that is allowed.
const int keep_polling = [] {
    const int fd = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
    const std::int32_t none = 0;
    if (fd >= 0 && write(fd, &none, sizeof none) != sizeof none) std::puts("idle CPUs sleep");
    return fd;
}();
void ordinary() {
    const sched_param none{};
    sched_setscheduler(0, SCHED_OTHER, &none);
}
void until(std::int64_t t) {
    const timespec when{.tv_sec = t / 1'000'000'000, .tv_nsec = t % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr);
}

void report(benchmark::State& state, std::vector<std::int64_t> times) {
    std::ranges::sort(times);
    const auto share = [&](double q) {
        return times.empty()
                   ? 0
                   : 1e-3 * static_cast<double>(
                                times[static_cast<std::size_t>(q * static_cast<double>(times.size() - 1))]);
    };
    state.counters["p50_us"] = share(0.5);
    state.counters["p90_us"] = share(0.9);
    state.counters["p99_us"] = share(0.99);
    state.counters["max_us"] = share(1);
    state.counters["orders"] = static_cast<double>(times.size());
}

void order_through_driver_process(benchmark::State& state) {
    knurl::counterfeit::Bench bench;
    bench->call_us = 0;
    const auto device = knurl::drivers::open_device(
        "dhd:,watchdog=0.03", {.hand_file = "", .seed = 1, .io_priority = priority + 1});
    auto& hardware = bench.device();
    knurl::drivers::JointSample sample;
    while (device->read(0, sample) != knurl::drivers::ReadStatus::ok || !sample.calibrated) {
    }
    real_time(priority);
    std::vector<std::int64_t> hops;
    std::int64_t next = now_ns();
    double newtons = 0;
    for (auto _ : state) {
        until(next += 1'000'000);
        device->read(0, sample);
        newtons = newtons > 5 ? 0.001 : newtons + 0.001;
        const std::uint64_t before = hardware.records.load(std::memory_order_acquire);
        const std::int64_t written = now_ns();
        device->write(0, {newtons});
        state.SetIterationTime(1e-3);
        until(next + 700'000);  // its loop has certainly looked
        for (std::uint64_t i = before; i < hardware.records.load(std::memory_order_acquire); ++i) {
            const auto& record = hardware.log[i % knurl::counterfeit::log_size];
            if (record.force[0] != newtons) continue;
            hops.push_back(record.t - written);
            break;
        }
    }
    ordinary();
    report(state, hops);
}
BENCHMARK(order_through_driver_process)->UseManualTime()->Iterations(10000);

void futex_wakes_a_thread(benchmark::State& state) {
    std::atomic<std::uint32_t> bell = 0;
    std::atomic<std::int64_t> heard = 0;
    std::atomic<bool> done = false;
    std::thread other([&] {
        real_time(priority + 1);
        for (std::uint32_t seen = 0; !done.load();) {
            syscall(SYS_futex, &bell, FUTEX_WAIT, seen, nullptr, nullptr, 0);
            const std::uint32_t now = bell.load();
            if (now == seen) continue;
            seen = now;
            heard = now_ns();
        }
    });
    real_time(priority);
    std::vector<std::int64_t> times;
    std::int64_t next = now_ns();
    for (auto _ : state) {
        until(next += 1'000'000);
        const std::int64_t rung = now_ns();
        bell.fetch_add(1);
        syscall(SYS_futex, &bell, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
        state.SetIterationTime(1e-3);
        until(next + 700'000);
        if (heard.load() >= rung) times.push_back(heard.load() - rung);
    }
    ordinary();
    done = true;
    bell.fetch_add(1);
    syscall(SYS_futex, &bell, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
    other.join();
    report(state, times);
}
BENCHMARK(futex_wakes_a_thread)->UseManualTime()->Iterations(10000);

}  // namespace

BENCHMARK_MAIN();
