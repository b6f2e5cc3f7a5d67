// What K sleeping clients cost a servo that publishes a report each millisecond, and how soon they have it.
// The waker is a thread on the servo's CPU, with lower priority; the clients sleep on the other CPU.

#include <chrono>

#include <knurl/shm/segment.hpp>
#include <knurl/shm/waiter.hpp>

#include "bench.hpp"

namespace knurl::shm::bench {

namespace {

using SteadyClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::uint32_t slots = 64;

double now() {
    return std::chrono::duration<double, std::nano>(SteadyClock::now().time_since_epoch()).count();
}

struct Sleepers {
    std::vector<WaiterFlag> flags;
    std::vector<WakePair> pairs;
    std::vector<WakeTarget> views;

    Sleepers(std::size_t n, Waker& waker) : flags(n) {
        for (WaiterFlag& flag : flags) {
            pairs.push_back(make_wake_pair());
            views.push_back({.flag = &flag, .wake_fd = pairs.back().servo.get(), .trusted = true});
            waker.add(views.back());
        }
    }
    std::size_t asleep() const { return who_waits(views).count; }
};

struct Cell {
    Series servo, client;
};

void measure_cell(std::size_t k, int cycles, const Place& place, const Stopwatch& clock, Cell& cell) {
    Segment segment = Segment::create("knurl-bench", broadcast_bytes(slots, sizeof(Message)));
    broadcast_init(segment.data());
    BroadcastWriter writer(segment.data(), slots, sizeof(Message));
    Waker waker;
    Sleepers sleepers(k, waker);
    std::thread waker_thread([&] {
        measure::pin_this_thread(place.servo_cpu);
        if (place.real_time) measure::run_real_time(10);
        waker.run();
    });
    std::atomic<bool> stop = false;
    std::vector<std::thread> threads;
    std::vector<std::vector<double>> latencies(k);
    for (std::size_t i = 0; i < k; ++i)
        threads.emplace_back([&, i] {
            measure::pin_this_thread(place.client_cpu);
            if (place.real_time) measure::run_real_time(15);
            BroadcastReader reader(segment.data(), slots, sizeof(Message), 0);
            Waiter waiter(&sleepers.flags[i], sleepers.pairs[i].client.get(), reader);
            while (!stop.load(std::memory_order::relaxed)) {
                if (!waiter.wait(20ms)) continue;
                Message message;
                if (!reader.latest(&message)) continue;
                const double sent = static_cast<double>(message.word[0]);
                latencies[i].push_back(now() - sent);
            }
        });
    cell.servo.begin_block();
    cell.client.begin_block();
    for (int i = 0; i < cycles; ++i) {
        std::this_thread::sleep_for(1ms);
        for (int tries = 0; tries < 20 && sleepers.asleep() < k; ++tries) std::this_thread::sleep_for(100us);
        Message message;
        message.word[0] = static_cast<std::uint64_t>(now());
        const std::uint64_t begin = Stopwatch::begin();
        writer.publish(&message);
        waker.wake(sleepers.views);
        cell.servo.add(clock.nanoseconds(begin, Stopwatch::end()));
    }
    stop = true;
    for (std::thread& thread : threads) thread.join();
    waker.stop();
    waker_thread.join();
    for (const auto& client : latencies)
        for (const double latency : client) cell.client.add(latency);
}

}  // namespace

std::vector<Result> waking(const Place& place, const Stopwatch& clock) {
    constexpr std::size_t counts[] = {0, 1, 8, 64};
    constexpr int cycles = 25;  // in a block
    Cell cells[std::size(counts)];
    for (unsigned block = 0; block < 45 * place.effort; ++block)
        for (std::size_t i = 0; i < std::size(counts); ++i)
            measure_cell(counts[i], cycles, place, clock, cells[i]);
    std::vector<Result> results;
    for (std::size_t i = 0; i < std::size(counts); ++i) {
        const std::string sleeping = std::to_string(counts[i]) + " sleeping";
        results.push_back(cells[i].servo.result(("servo publishes to " + sleeping + " t").c_str()));
        if (i > 1)
            measure::relate(results.back(), results[1]);  // the cost of the poke, whatever their number
    }
    for (std::size_t i = 1; i < std::size(counts); ++i)
        results.push_back(
            cells[i].client.result(("one of " + std::to_string(counts[i]) + " sleeping has it").c_str()));
    return results;
}

}  // namespace knurl::shm::bench
