#pragma once
// knurl_bench_rings: the cost of the rings. Each figure stands beside a reference that ran interleaved with
// it, in blocks of far less than 50 ms, so that the machine's other activity affected both.

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include <knurl/measure/measure.hpp>

namespace knurl::shm::bench {

using measure::Result;
using measure::Stopwatch;

struct Place {
    unsigned servo_cpu = 0;
    unsigned client_cpu = 0;
    bool real_time = false;  // SCHED_FIFO where the kernel allows it
    unsigned effort = 1;     // multiplies the sample counts
};

inline constexpr std::size_t message_words = 32;  // 256 bytes, the usual report or batch
struct Message {
    std::uint64_t word[message_words] = {};
};

/// Samples of one quantity, ns. The first two of each block warm up and are dropped.
class Series {
  public:
    static constexpr int warm_up = 2;
    void begin_block() {
        end_block();
        skip_ = warm_up;
    }
    void add(double value) {
        if (skip_ > 0)
            --skip_;
        else
            samples_.push_back(value);
    }
    Result result(const char* name, const char* unit = "ns") {
        end_block();
        return measure::summarise_blocks(name, unit, blocks_);
    }

  private:
    void end_block() {
        if (!samples_.empty()) blocks_.add(samples_);
        samples_.clear();
    }

    measure::Blocks blocks_;
    std::vector<double> samples_;  // of this block
    int skip_ = 0;
};

/// A thread on the other CPU that does one thing at a time on request.
class Helper {
  public:
    Helper(unsigned cpu, bool real_time) : thread_([this, cpu, real_time] { run(cpu, real_time); }) {}
    ~Helper() {
        start(nullptr);
        thread_.join();
    }
    Helper(const Helper&) = delete;
    Helper& operator=(const Helper&) = delete;

    void start(std::function<void()> work) {
        finish();
        work_ = std::move(work);
        // pairs with run
        asked_.store(asked_.load(std::memory_order::relaxed) + 1, std::memory_order::release);
    }
    void finish() {
        while (done_.load(std::memory_order::acquire) != asked_.load(std::memory_order::relaxed)) {
        }
    }

  private:
    void run(unsigned cpu, bool real_time) {
        measure::pin_this_thread(cpu);
        if (real_time) measure::run_real_time(20);
        for (std::uint64_t n = 1;; ++n) {
            while (asked_.load(std::memory_order::acquire) != n) {
                if (!real_time) std::this_thread::yield();
            }
            const bool last = !work_;
            if (!last) work_();
            done_.store(n, std::memory_order::release);  // pairs with finish
            if (last) return;
        }
    }

    std::function<void()> work_;
    alignas(128) std::atomic<std::uint64_t> asked_ = 0;
    alignas(128) std::atomic<std::uint64_t> done_ = 0;
    std::thread thread_;
};

/// Keeps the compiler from removing the computation of `value`.
template <class T>
void keep(const T& value) {
    asm volatile("" : : "g"(&value) : "memory");
}

std::vector<Result> hand_over(const Place& place, const Stopwatch& clock);  // round trips between two CPUs
std::vector<Result> publishing(const Place& place, const Stopwatch& clock);
std::vector<Result> clients(const Place& place, const Stopwatch& clock);  // 128 of them, idle and fresh
std::vector<Result> waking(const Place& place, const Stopwatch& clock);

}  // namespace knurl::shm::bench
