#include "latency_floors.hpp"

#include <algorithm>
#include <atomic>
#include <semaphore>
#include <thread>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <knurl/shm/fd.hpp>

namespace knurl::cli {

namespace {

constexpr std::size_t cold_samples = 2;

/// Collects samples without the cold ones. Where a sample is due every `interval`, one that took longer
/// delayed others; these are added, each with its wait from its own due time.
struct Collector {
    std::vector<double>& samples;
    Nanoseconds interval = 0;  // 0: each begins when the previous one ends
    std::size_t seen = 0;
    void take(Nanoseconds value) {
        if (seen++ < cold_samples) return;
        samples.push_back(static_cast<double>(value));
        if (interval == 0) return;
        for (value -= interval; value > 0; value -= interval) samples.push_back(static_cast<double>(value));
    }
};

}  // namespace

bool ready(int fd, short events, Nanoseconds until) {
    pollfd wait{.fd = fd, .events = events, .revents = 0};
    const Nanoseconds left = std::max<Nanoseconds>(0, until - now_ns());
    return ::poll(&wait, 1, static_cast<int>((left + 999'999) / 1'000'000)) > 0;
}

void ping_pong_block(const Placement& placement, Nanoseconds length, std::vector<double>& samples) {
    if (placement.client_cpu == placement.servo_cpu) return;
    constexpr std::uint64_t rounds = 500, stop = ~std::uint64_t{0};
    constexpr Nanoseconds patience = 100'000'000;
    // ping: release, pairs with the partner's acquire; pong likewise the other way. Each line has one writer.
    struct alignas(128) Line {
        std::atomic<std::uint64_t> word = 0;
    };
    Line ping, pong;
    // The partner starts on its maker's CPU, and a maker that spins in real time would never let it leave.
    std::binary_semaphore ready(0);
    // An ordinary thread, since a real-time thread that spins would keep the servo from its CPU.
    std::thread partner([&] {
        settle_on(placement.servo_cpu, 0);
        ready.release();
        std::uint64_t seen = 0;
        while (seen != stop) {
            const std::uint64_t now = ping.word.load(std::memory_order_acquire);
            if (now == seen) continue;
            seen = now;
            pong.word.store(seen, std::memory_order_release);
        }
    });
    ready.acquire();
    Collector collector{samples};
    const Nanoseconds end = now_ns() + length;
    bool answered = true;
    for (std::uint64_t i = 1; i <= rounds && answered && now_ns() < end; ++i) {
        const Nanoseconds begin = now_ns();
        ping.word.store(i, std::memory_order_release);
        // Limits the wait for a partner that gets no time on its CPU.
        for (std::uint32_t looks = 1; pong.word.load(std::memory_order_acquire) != i; ++looks) {
            if (looks % 1024 != 0 || now_ns() < end + patience) continue;
            answered = false;
            break;
        }
        if (answered) collector.take((now_ns() - begin) / 2);
    }
    ping.word.store(stop, std::memory_order_release);
    partner.join();
}

void eventfd_block(const Placement& placement, Nanoseconds length, std::vector<double>& samples) {
    constexpr Nanoseconds pace = 1'000'000;  // of the writer, as a servo's
    const shm::UniqueFd event(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
    std::atomic<Nanoseconds> written = 0;  // release before the write, acquire after the wake: carries its
                                           // stamp
    // the sleeper is about to sleep: a write that finds it awake measures nothing
    std::atomic<bool> asleep = false;
    std::atomic<bool> done = false;
    std::thread writer([&] {
        settle_on(placement.servo_cpu, placement.priority);
        const Nanoseconds begin = now_ns(), end = begin + length;
        for (Nanoseconds at = begin + pace; at < end; at += pace) {
            sleep_until(at);
            if (!asleep.exchange(false, std::memory_order_acq_rel)) continue;
            written.store(now_ns(), std::memory_order_release);
            const std::uint64_t one = 1;
            [[maybe_unused]] const auto bytes = ::write(event.get(), &one, sizeof one);
        }
        done.store(true, std::memory_order_release);
    });
    Collector collector{samples, pace};
    constexpr int look_again_ms = 20;
    while (!done.load(std::memory_order_acquire)) {
        asleep.store(true, std::memory_order_release);
        pollfd wait{.fd = event.get(), .events = POLLIN, .revents = 0};
        if (::poll(&wait, 1, look_again_ms) <= 0) continue;
        const Nanoseconds awake = now_ns();
        std::uint64_t count = 0;
        [[maybe_unused]] const auto bytes = ::read(event.get(), &count, sizeof count);
        collector.take(awake - written.load(std::memory_order_acquire));
    }
    writer.join();
}

void bare_loop_block(const Placement& placement, Nanoseconds period, Nanoseconds phase, Nanoseconds length,
                     std::vector<double>& samples) {
    const Nanoseconds begin = now_ns();
    const Nanoseconds first = phase + ((begin - phase) / period + 2) * period + period / 2;
    Collector collector{samples, period};
    for (const Nanoseconds late : measure::bare_loop({.cpu = placement.servo_cpu,
                                  .priority = placement.priority,
                                  .first = first,
                                  .period = period,
                                  .length = begin + length - first})
                                      .late)
        collector.take(late);
}

}  // namespace knurl::cli
