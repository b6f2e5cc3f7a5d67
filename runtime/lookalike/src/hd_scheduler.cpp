// The scheduler: a thread that runs the program's callbacks once a cycle of the servo, the urgent ones first.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <list>
#include <thread>
#include <vector>

#include "hd_state.hpp"

namespace knurl::lookalike::hd {

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

struct Entry {
    HDSchedulerHandle handle = 0;
    HDSchedulerCallback callback = nullptr;
    void* data = nullptr;
    HDushort priority = 0;
    bool gone = false;  // unscheduled, or done
};

thread_local bool is_scheduler = false;

class Scheduler {
  public:
    static constexpr std::size_t most_entries = 1024;

    void start() {
        std::unique_lock lock(mutex_);
        if (runs_) return;
        join(lock);
        runs_ = true;
        thread_ = std::thread([this] { run(); });
        static const int registered = std::atexit([] { the().stop_at_exit(); });
        static_cast<void>(registered);
    }
    void stop() {
        std::unique_lock lock(mutex_);
        runs_ = false;
        changed_.notify_all();
        if (!is_scheduler) join(lock);
    }
    bool runs() {
        const std::lock_guard lock(mutex_);
        return runs_;
    }

    HDSchedulerHandle add(HDSchedulerCallback callback, void* data, HDushort priority) {
        if (callback == nullptr) throw Refused{HD_INVALID_VALUE};
        const std::lock_guard lock(mutex_);
        if (entries_.size() >= most_entries) throw Refused{HD_SCHEDULER_FULL};
        const Entry made{++handles_, callback, data, priority, false};
        // Of equal priority: the order in which they came.
        const auto at = std::find_if(entries_.begin(), entries_.end(),
                                     [&](const Entry& e) { return e.priority < priority; });
        entries_.insert(at, made);
        return made.handle;
    }
    /// When it returns, the callback does not run any more, unless it is the caller.
    void remove(HDSchedulerHandle handle) {
        std::unique_lock lock(mutex_);
        const auto found = find(handle);
        if (found == entries_.end()) throw Refused{HD_INVALID_VALUE};
        found->gone = true;
        if (running_ != handle) entries_.erase(found);
        changed_.notify_all();
        if (!is_scheduler) changed_.wait(lock, [&] { return running_ != handle; });
    }
    bool scheduled(HDSchedulerHandle handle, bool wait) {
        std::unique_lock lock(mutex_);
        const auto gone = [&] {
            const auto found = find(handle);
            return found == entries_.end() || found->gone;
        };
        if (wait && !is_scheduler) changed_.wait(lock, [&] { return gone() || !runs_; });
        return !gone();
    }

    void set_rate(HDulong rate) {
        const auto clock = first();
        const double device = clock ? clock->hand.device().rate : 1000;
        const double every = rate == 0 ? 0 : std::round(device / static_cast<double>(rate));
        constexpr double near = 0.01;
        if (every < 1 ||
            std::abs(device / every - static_cast<double>(rate)) > near * static_cast<double>(rate)) {
            say_once("hdSetSchedulerRate(" + std::to_string(rate) + "): the device runs at " +
                     std::to_string(std::lround(device)) + " Hz; give that, or a whole part of it");
            throw Refused{HD_INVALID_VALUE};
        }
        every_ = static_cast<int>(every);
    }
    double since_turn() const {
        return std::chrono::duration<double>(Clock::now().time_since_epoch() - began_.load()).count();
    }
    std::uint64_t turn() const { return turn_; }

    static Scheduler& the() {
        static auto& all = *new Scheduler;  // never destroyed: its thread may run until the process ends
        return all;
    }

  private:
    std::list<Entry>::iterator find(HDSchedulerHandle handle) {
        return std::find_if(entries_.begin(), entries_.end(),
                            [=](const Entry& e) { return e.handle == handle; });
    }
    void join(std::unique_lock<std::mutex>& lock) {
        if (!thread_.joinable()) return;
        std::thread ending = std::move(thread_);
        lock.unlock();
        ending.join();
        lock.lock();
    }
    /// A callback of an interpreter that is gone may never return: it is not waited for.
    void stop_at_exit() {
        std::unique_lock lock(mutex_);
        runs_ = false;
        changed_.notify_all();
        changed_.wait_for(lock, 200ms, [this] { return running_ == 0; });
        if (thread_.joinable()) thread_.detach();
    }

    void wait_for_cycle() {
        if (const auto clock = first())
            for (int left = every_; left > 0; --left) clock->hand.pace();
        else
            std::this_thread::sleep_for(1ms);
    }

    // Not noexcept, and nothing is caught: a thread that enters an interpreter which has ended is unwound by it.
    void run() {
        is_scheduler = true;
        for (;;) {
            wait_for_cycle();
            std::unique_lock lock(mutex_);
            if (!runs_) return;
            began_ = Clock::now().time_since_epoch();
            ++turn_;
            std::vector<HDSchedulerHandle> due;
            for (const Entry& entry : entries_) due.push_back(entry.handle);
            for (const HDSchedulerHandle handle : due)
                if (!run_one(handle, lock)) return;
        }
    }
    /// False: the scheduler was stopped.
    bool run_one(HDSchedulerHandle handle, std::unique_lock<std::mutex>& lock) {
        const auto found = find(handle);
        if (found == entries_.end() || found->gone) return runs_;
        const Entry entry = *found;
        running_ = handle;
        lock.unlock();
        const HDCallbackCode code = entry.callback(entry.data);
        lock.lock();
        running_ = 0;
        const auto now = find(handle);
        if (now != entries_.end() && (now->gone || code == HD_CALLBACK_DONE)) entries_.erase(now);
        changed_.notify_all();
        return runs_;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::list<Entry> entries_;  // by priority, highest first
    HDSchedulerHandle handles_ = 0;
    HDSchedulerHandle running_ = 0;
    bool runs_ = false;
    std::thread thread_;
    std::atomic<int> every_{1};  // cycles
    std::atomic<std::uint64_t> turn_{0};
    std::atomic<Clock::duration> began_{};
};

void run_here(HDSchedulerCallback callback, void* data) {
    if (callback == nullptr) throw Refused{HD_INVALID_VALUE};
    while (callback(data) == HD_CALLBACK_CONTINUE && !is_scheduler)
        if (const auto clock = first()) clock->hand.pace();
}

}  // namespace

std::uint64_t turn() noexcept {
    static std::atomic<std::uint64_t> others{std::uint64_t{1} << 63};
    return is_scheduler ? Scheduler::the().turn() : others++;
}

}  // namespace knurl::lookalike::hd

using namespace knurl::lookalike::hd;

extern "C" {

void hdStartScheduler(void) {
    call([] { Scheduler::the().start(); });
}
void hdStopScheduler(void) {
    call([] { Scheduler::the().stop(); });
}
void hdSetSchedulerRate(HDulong rate) {
    call([=] { Scheduler::the().set_rate(rate); });
}
HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback callback, void* data, HDushort priority) {
    return call([=] { return Scheduler::the().add(callback, data, priority); },
                HDSchedulerHandle{HD_INVALID_HANDLE});
}
// Not through call(): a callback may unwind its thread.
void hdScheduleSynchronous(HDSchedulerCallback callback, void* data, HDushort priority) {
    if (callback == nullptr) return fail(HD_INVALID_VALUE);
    // Without a scheduler, and within it, it runs at once, where it is.
    if (is_scheduler || !Scheduler::the().runs()) return run_here(callback, data);
    call([=] {
        const HDSchedulerHandle handle = Scheduler::the().add(callback, data, priority);
        Scheduler::the().scheduled(handle, true);
    });
}
void hdUnschedule(HDSchedulerHandle handle) {
    call([=] { Scheduler::the().remove(handle); });
}
HDboolean hdWaitForCompletion(HDSchedulerHandle handle, HDenum code) {
    return call(
        [=] {
            if (code > HD_WAIT_INFINITE) throw Refused{HD_INVALID_ENUM};
            return static_cast<HDboolean>(Scheduler::the().scheduled(handle, code == HD_WAIT_INFINITE) ? 1
                                                                                                       : 0);
        },
        HDboolean{0});
}
HDdouble hdGetSchedulerTimeStamp(void) {
    return Scheduler::the().since_turn();
}

}  // extern "C"
