#pragma once
// Whether the machine itself stood still: a virtual one is taken off its processors for tens of milliseconds
// at times, whatever the priorities on it, and then a promise that is kept within cycles is broken by nobody.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include <pthread.h>
#include <sched.h>

namespace knurl::chaos {

/// A thread on each CPU that only sleeps, above every priority that the fault's programs have. Without the
/// right to that it sees nothing, and nothing is excused.
class Witness {
  public:
    Witness() {
        cpu_set_t allowed;
        CPU_ZERO(&allowed);
        sched_getaffinity(0, sizeof allowed, &allowed);
        for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
            if (CPU_ISSET(cpu, &allowed)) threads_.emplace_back([this, cpu] { watch(cpu); });
    }
    ~Witness() {
        done_ = true;
        for (std::thread& thread : threads_) thread.join();
    }
    Witness(const Witness&) = delete;
    Witness& operator=(const Witness&) = delete;

    /// The longest standstill since the last call, ms.
    double longest() { return static_cast<double>(longest_.exchange(0)) * 1e-6; }

  private:
    void watch(int cpu) {
        cpu_set_t only;
        CPU_ZERO(&only);
        CPU_SET(static_cast<std::size_t>(cpu), &only);
        const sched_param above_all{.sched_priority = 95};
        if (pthread_setaffinity_np(pthread_self(), sizeof only, &only) != 0 ||
            pthread_setschedparam(pthread_self(), SCHED_FIFO, &above_all) != 0)
            return;
        using Clock = std::chrono::steady_clock;
        while (!done_) {
            const Clock::time_point due = Clock::now() + std::chrono::milliseconds(2);
            std::this_thread::sleep_until(due);
            const std::int64_t late = std::chrono::nanoseconds(Clock::now() - due).count();
            for (std::int64_t known = longest_;
                 late > known && !longest_.compare_exchange_weak(known, late);) {
            }
        }
    }

    std::atomic<bool> done_ = false;
    std::atomic<std::int64_t> longest_ = 0;  // ns
    std::vector<std::thread> threads_;
};

}  // namespace knurl::chaos
