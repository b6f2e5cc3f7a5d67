#pragma once

/// @file
/// What makes a process real-time: priorities, locked memory, a CPU of its own, idle CPUs that poll. Each may
/// be missing a right; then it runs on without, and says exactly what is missing and which command grants it.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pthread.h>

#include <knurl/servo/clock.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::servo {

/// SCHED_FIFO priority of the waker below the servo's (80): everything that a cycle does not need waits for
/// it.
inline constexpr int waker_below_servo = 20;
/// Priority of the thread that sees clients die below the servo's: what it says ends a force.
inline constexpr int deaths_below_servo = 25;
/// Priority of the broker below the servo's.
inline constexpr int broker_below_servo = 30;
/// Priority of drivers' threads above the servo's: short bursts, whose bytes the next cycle waits for.
inline constexpr int io_above_servo = 1;
/// Priority of the guardian above the servo's: mostly asleep, it must run when the servo hangs.
inline constexpr int guardian_above_servo = 5;

/// Stack of a thread (bytes). All memory is locked, so stacks are set explicitly. Sanitizers need more, and
/// lock nothing.
inline constexpr std::size_t thread_stack_bytes = 256 * 1024;
/// The same for a thread that calls nothing deep, such as a waker's (bytes).
inline constexpr std::size_t small_stack_bytes = 32 * 1024;

/// Rights that are missing.
struct Shortfalls {
    /// What is missing, each with the command that grants it.
    std::vector<std::string> lines;
    /// Threads that run without real-time priority: "knurl-servo 80".
    std::vector<std::string> ordinary;
    /// errno of the last of them.
    int priority_error = 0;
    /// Highest priority that was refused.
    int highest_priority = 0;

    /// One line per right that is missing.
    std::vector<std::string> report() const;
};

/// Why a SCHED_FIFO priority was refused, and "; run: COMMAND" that grants it.
std::string why_no_priority(int priority);

/// malloc with one arena that gives memory back: call first, before any thread.
void tame_malloc() noexcept;
/// Locks all memory: no page fault after this.
void lock_memory(Shortfalls& missing);
/// Gives the calling thread this SCHED_FIFO priority; 0 leaves it as it is.
void become_real_time(int priority, const char* who, Shortfalls& missing);
/// CPUs that this process may use, ascending.
std::vector<int> allowed_cpus();
/// The calling thread runs on any allowed CPU but this one, if there is another.
void keep_off_cpu(int cpu) noexcept;
/// Idle CPUs poll while the result is open. Empty: not allowed.
shm::UniqueFd hold_idle_polling(Shortfalls& missing);

/// How a thread runs.
struct ThreadOptions {
    /// Its name, at most 15 characters.
    const char* name = "";
    /// SCHED_FIFO priority; 0: ordinary.
    int priority = 0;
    /// CPU; -1: any.
    int cpu = -1;
    /// Stack (bytes).
    std::size_t stack_bytes = thread_stack_bytes;
};

/// A thread with an explicit small stack. Where the priority is not allowed it runs without. Joins when
/// destroyed.
class Thread {
  public:
    /// Starts a thread. Throws std::runtime_error.
    Thread(const ThreadOptions& options, std::function<void()> body, Shortfalls& missing);
    ~Thread() { join(); }
    Thread(const Thread&) = delete;
    Thread& operator=(const Thread&) = delete;
    /// Waits until it has ended.
    void join() noexcept;

  private:
    std::unique_ptr<std::function<void()>> body_;
    pthread_t thread_{};
    bool running_ = false;
};

/// How late such a thread wakes from absolute sleeps of 1 ms, in ns.
struct WakeLateness {
    /// How many sleeps were measured.
    int samples = 0;
    /// Median (ns).
    Nanoseconds p50 = 0;
    /// Maximum (ns).
    Nanoseconds max = 0;
};
/// Measures so many sleeps in such a thread.
WakeLateness measure_wake_lateness(int priority, int cpu, int samples);

}  // namespace knurl::servo
