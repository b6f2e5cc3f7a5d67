#pragma once
// The CPU time of a servo's single cycles at 1 kHz, from outside. For a sleeping thread the kernel knows
// exactly how long it has run, and how often (proc(5), schedstat). Between two reads in the middle of two
// sleeps lies one cycle, wake-up included.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <knurl/measure/sleeper.hpp>

namespace client_test {

inline std::filesystem::path servo_thread(pid_t pid) {
    for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
        std::ifstream file(task.path() / "comm");
        std::string name;
        std::getline(file, name);
        if (name == "knurl-servo") return task.path();
    }
    throw std::runtime_error("knurld has no servo thread");
}

/// Reads the servo's thread once in each of its sleeps, from another CPU, with the highest priority.
class CycleReader {
  public:
    CycleReader(pid_t servo, unsigned cpu) : file_(servo_thread(servo) / "schedstat") {
        thread_ = std::thread([this, cpu] {
            knurl::measure::settle_on(cpu, priority);
            run();
        });
    }
    ~CycleReader() {
        stop_ = true;
        thread_.join();
    }
    /// The beginning (ns, CLOCK_MONOTONIC) of any cycle.
    void keep_time(knurl::measure::Nanoseconds deadline) { deadline_ = deadline; }
    /// The cycles' CPU time from now on, us, until collect().
    void begin() {
        const std::lock_guard lock(mutex_);
        cycles_.clear();
    }
    std::vector<double> collect() {
        const std::lock_guard lock(mutex_);
        return cycles_;
    }

  private:
    static constexpr knurl::measure::Nanoseconds period = 1'000'000;
    static constexpr int priority = 85;
    struct Look {
        std::uint64_t ran = 0, times = 0;
    };
    Look look() {
        Look now;
        std::uint64_t waited;
        std::ifstream file(file_);
        file >> now.ran >> waited >> now.times;
        return now;
    }
    void run() {
        Look last = look();
        while (!stop_) {
            const knurl::measure::Nanoseconds now = knurl::measure::now_ns(),
                                              phase = (now - deadline_) % period;
            knurl::measure::sleep_until(now - phase + period + period / 2);
            const Look here = look();
            // Else the read was late, or the thread was preempted within a cycle.
            if (here.times == last.times + 1) {
                const std::lock_guard lock(mutex_);
                cycles_.push_back(static_cast<double>(here.ran - last.ran) * 1e-3);
            }
            last = here;
        }
    }

    std::filesystem::path file_;
    std::atomic<bool> stop_ = false;
    std::atomic<knurl::measure::Nanoseconds> deadline_ = 0;
    std::mutex mutex_;
    std::vector<double> cycles_;
    std::thread thread_;
};

}  // namespace client_test
