#pragma once
// Starts knurl-device, sees that it lives and that its library's calls return, and starts it again. A thread of its own,
// below the servo: the cycle never waits for it.
//
//   constructor: memfd ─> spawn ─> lane ready? ─> description
//   thread:      ended | silent for `hang` ─> session even (the cycle says unplugged) ─> pause ─> next lane, spawn, ready
//                ─> session odd
//
// A process ends by itself where its device is gone: what it has loaded begins anew with the next one, whatever state
// the maker's library had.

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include <pthread.h>
#include <sys/types.h>

#include <knurl/drivers/driver_process.hpp>

namespace knurl::drivers::process {

/// What to start.
struct Plan {
    std::string scheme;                  // for messages too
    std::string what;                    // the address after the scheme
    std::vector<std::string> arguments;  // of knurl-device, after the scheme
    int priority = 0;                    // SCHED_FIFO of its loop; 0: ordinary
    int patience_ms = 20'000;            // until the first one must be ready
    int hang_ms = 1000;                  // without a beat: killed
};

class Keeper {
  public:
    static constexpr int first_pause_ms = 50,
                         longest_pause_ms = 1000;  // before another start that follows soon
    static constexpr int calm_looks = 20;          // after a life so long it is started again at once
    static constexpr int look_ms = 50;             // between two looks at the beat
    static constexpr int farewell_ms = 2000;       // for the last one to zero and close; then it is killed

    /// Throws std::runtime_error: why there is no device, what to do.
    explicit Keeper(Plan plan);
    ~Keeper();
    Keeper(const Keeper&) = delete;
    Keeper& operator=(const Keeper&) = delete;

    Shared& shared() noexcept { return *shared_; }
    const Description& description() const noexcept { return description_; }
    /// Odd: a process is there, and lane(session) is its.
    std::uint64_t session() const noexcept { return session_.load(std::memory_order_acquire); }
    Lane& lane(std::uint64_t session) noexcept { return shared_->lane[(session / 2) % lanes]; }
    /// Of the present process; -1: none.
    pid_t pid() const noexcept { return pid_.load(std::memory_order_relaxed); }

  private:
    struct Fd {
        int number = -1;
        ~Fd();
        void reset(int other = -1) noexcept;
    };

    void start(Lane& lane, unsigned number);
    std::string wait_until_ready(Lane& lane);
    std::string ended();
    void live() noexcept;
    /// What was seen of this process.
    struct Looks {
        std::uint64_t beat = 0;
        int still = 0;     // looks without a beat
        int lives = 0;     // looks at which it lived
        int pause_ms = 0;  // before the next start; the first is at once: its device may hold the last force
    };
    void once();
    void look(Looks& looks);
    void say_why_it_ended();
    bool start_again(int& pause_ms);
    bool pause(int ms) noexcept;
    void end() noexcept;

    Plan plan_;
    std::string program_;
    Shared* shared_ = nullptr;
    Description description_ = {};
    Fd mapping_, servo_, child_, stop_;
    pthread_t thread_ = {};
    bool hung_ = false;
    std::atomic<pid_t> pid_ = -1;
    std::atomic<std::uint64_t> session_ = 0;
};

}  // namespace knurl::drivers::process
