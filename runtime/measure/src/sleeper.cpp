#include <algorithm>
#include <atomic>
#include <cerrno>
#include <ctime>
#include <latch>
#include <mutex>
#include <thread>
#include <utility>

#include <pthread.h>
#include <sched.h>

#include <knurl/measure/measure.hpp>
#include <knurl/measure/sleeper.hpp>

namespace knurl::measure {

namespace {

constexpr Nanoseconds second = 1'000'000'000, witness_pace = 1'000'000;

}  // namespace

Nanoseconds now_ns() noexcept {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * second + t.tv_nsec;
}

void sleep_until(Nanoseconds t) noexcept {
    const timespec deadline{.tv_sec = t / second, .tv_nsec = t % second};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
    }
}

bool settle_on(unsigned cpu, int priority) {
    const bool bound = pin_this_thread(cpu);
    if (priority > 0) return run_real_time(priority) && bound;
    const sched_param ordinary{};  // a new thread inherits its maker's policy
    return ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &ordinary) == 0 && bound;
}

Beginnings bare_loop(const BareLoop& loop) {
    Beginnings seen;
    const auto cycles = static_cast<std::size_t>(loop.length / loop.period) + 1;
    seen.deadline.reserve(cycles);
    seen.late.reserve(cycles);
    std::thread([&] {
        settle_on(loop.cpu, loop.priority);
        const Nanoseconds end = loop.first + loop.length;
        const auto next = [&](Nanoseconds deadline, Nanoseconds late) {
            return deadline + loop.period * (std::max<Nanoseconds>(0, late) / loop.period + 1);
        };
        // The start of a thread takes time, which is no lateness of the loop.
        const Nanoseconds started = now_ns();
        Nanoseconds deadline = started < loop.first ? loop.first : next(loop.first, started - loop.first);
        while (deadline < end && (loop.stop == nullptr || !*loop.stop)) {
            sleep_until(deadline);
            const Nanoseconds late = now_ns() - deadline;
            seen.deadline.push_back(deadline);
            seen.late.push_back(late);
            deadline = next(deadline, late);
        }
    }).join();
    return seen;
}

Nanoseconds stood_still(std::vector<Gap> gaps, Nanoseconds window) {
    std::ranges::sort(gaps, {}, &Gap::begin);
    Nanoseconds worst = 0;
    // The worst window begins where a standstill begins: moving it further gains no more than it loses.
    for (auto first = gaps.begin(); first != gaps.end(); ++first) {
        Nanoseconds still = 0, counted = 0;  // the sum, and its end: from the window's beginning
        for (auto gap = first; gap != gaps.end() && gap->begin - first->begin < window; ++gap) {
            const Nanoseconds end = std::min(gap->end - first->begin, window);
            still += std::max<Nanoseconds>(0, end - std::max(gap->begin - first->begin, counted));
            counted = std::max(counted, end);
        }
        worst = std::max(worst, still);
    }
    return worst;
}

struct Witness::Impl {
    explicit Impl(std::size_t cpus) : settled(static_cast<std::ptrdiff_t>(cpus)) {}

    std::latch settled;
    std::atomic<std::size_t> watching = 0;
    std::atomic<bool> done = false;
    std::mutex mutex;
    std::vector<Gap> gaps;
    std::vector<std::thread> threads;

    void watch(unsigned cpu, int priority) {
        const bool allowed = settle_on(cpu, priority);
        if (allowed) ++watching;
        settled.count_down();
        if (!allowed) return;
        for (Nanoseconds due = now_ns() + witness_pace; !done; due = std::max(due + witness_pace, now_ns())) {
            sleep_until(due);
            const Nanoseconds now = now_ns();
            if (now - due < long_gap) continue;
            const std::scoped_lock lock(mutex);
            gaps.push_back({.begin = due, .end = now});
        }
    }
};

Witness::Witness(const std::vector<unsigned>& cpus, int priority)
    : impl_(std::make_unique<Impl>(cpus.size())) {
    for (const unsigned cpu : cpus)
        impl_->threads.emplace_back([impl = impl_.get(), cpu, priority] { impl->watch(cpu, priority); });
    impl_->settled.wait();
}

Witness::~Witness() {
    impl_->done = true;
    for (std::thread& thread : impl_->threads) thread.join();
}

std::size_t Witness::watching() const {
    return impl_->watching;
}

std::vector<Gap> Witness::gaps() {
    const std::scoped_lock lock(impl_->mutex);
    return std::exchange(impl_->gaps, {});
}

}  // namespace knurl::measure
