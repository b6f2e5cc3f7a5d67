#pragma once
// What makes a process real-time: priorities, locked memory, a CPU of its own, idle CPUs that poll. Each may
// be missing a right; then it runs on without, and says exactly what is missing and which command grants it.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pthread.h>

#include <knurl/servo/clock.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::servo {

/// SCHED_FIFO priorities relative to the servo's (80): everything that a cycle does not need waits for it.
inline constexpr int waker_below_servo = 20;
inline constexpr int broker_below_servo = 30;
inline constexpr int io_above_servo = 1;        // short bursts, whose bytes the next cycle waits for
inline constexpr int guardian_above_servo = 5;  // mostly asleep; it must run when the servo hangs

/// All memory is locked, so stacks are set explicitly. Sanitizers need more, and lock nothing.
inline constexpr std::size_t thread_stack_bytes = 256 * 1024;

/// What could not be had.
struct Shortfalls {
    std::vector<std::string> lines;     // each with the command that grants it
    std::vector<std::string> ordinary;  // who runs without real-time priority: "knurl-servo 80"
    int priority_error = 0;             // errno of the last of them
    int highest_priority = 0;

    /// One line per right that is missing.
    std::vector<std::string> report() const;
};

/// Of a SCHED_FIFO priority that was refused: the true reason, and "; run: COMMAND" that mends it.
std::string why_no_priority(int priority);

/// malloc with one arena that gives memory back: call first, before any thread.
void tame_malloc() noexcept;
/// No page fault after this.
void lock_memory(Shortfalls& missing);
/// The calling thread; priority 0 leaves it as it is.
void become_real_time(int priority, const char* who, Shortfalls& missing);
/// CPUs that this process may use, ascending.
std::vector<int> allowed_cpus();
/// The calling thread runs on any allowed CPU but this one, if there is another.
void keep_off_cpu(int cpu) noexcept;
/// Idle CPUs poll while this is open. Empty: not allowed.
shm::UniqueFd hold_idle_polling(Shortfalls& missing);

struct ThreadOptions {
    const char* name = "";  // at most 15 characters
    int priority = 0;       // SCHED_FIFO; 0: ordinary
    int cpu = -1;           // -1: any
};

/// A thread with an explicit small stack. Where the priority is not allowed it runs without. Joins when
/// destroyed.
class Thread {
  public:
    Thread(const ThreadOptions& options, std::function<void()> body, Shortfalls& missing);
    ~Thread() { join(); }
    Thread(const Thread&) = delete;
    Thread& operator=(const Thread&) = delete;
    void join() noexcept;

  private:
    std::unique_ptr<std::function<void()>> body_;
    pthread_t thread_{};
    bool running_ = false;
};

/// How late such a thread wakes from absolute sleeps of 1 ms, in ns.
struct WakeLateness {
    int samples = 0;
    Nanoseconds p50 = 0, max = 0;
};
WakeLateness measure_wake_lateness(int priority, int cpu, int samples);

}  // namespace knurl::servo
