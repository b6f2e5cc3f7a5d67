// The cost of a report for the servo: 256 bytes into 4096 report_slots.

#include <cstring>
#include <utility>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/waiter.hpp>

#include "bench.hpp"

namespace knurl::shm::bench {

namespace {

constexpr std::uint32_t report_slots = 4096;
constexpr int paced_in_block = 1000;  // one per 2 us: 2 ms
constexpr double pace = 2000;         // ns
constexpr int batch = 500;            // back to back, for differences below the timer's

struct Ring {
    Segment segment = [] {
        Segment made = Segment::create("knurl-bench", broadcast_bytes(report_slots, sizeof(Message)));
        broadcast_init(made.data());
        return made;
    }();
    BroadcastWriter writer{segment.data(), report_slots, sizeof(Message)};
};

/// Single calls, and means of 100: some time-stamp counters only count in steps of 10 ns.
struct Paced {
    Series each, means;
};

template <class Action>
void paced(Paced& series, const Stopwatch& clock, const Action& action) {
    Message message;
    series.each.begin_block();
    series.means.begin_block();
    double sum = 0;
    std::uint64_t begin = Stopwatch::begin();
    for (int i = 0; i < paced_in_block; ++i) {
        while (clock.nanoseconds(begin, Stopwatch::begin()) < pace) {
        }
        message.word[0] = static_cast<std::uint64_t>(i);
        begin = Stopwatch::begin();
        action(message);
        const double took = clock.nanoseconds(begin, Stopwatch::end());
        series.each.add(took);
        sum += took;
        if (i % 100 == 99) series.means.add(std::exchange(sum, 0) / 100);
    }
}

template <class Action>
void back_to_back(Series& series, const Stopwatch& clock, const Action& action) {
    Message message;
    series.begin_block();
    for (int k = 0; k < 52; ++k) {
        const std::uint64_t begin = Stopwatch::begin();
        for (int i = 0; i < batch; ++i) {
            message.word[0] = static_cast<std::uint64_t>(i);
            action(message);
        }
        series.add(clock.nanoseconds(begin, Stopwatch::end()) / batch);
    }
}

}  // namespace

std::vector<Result> publishing(const Place& place, const Stopwatch& clock) {
    Helper helper(place.client_cpu, place.real_time);
    Ring ring;
    std::vector<std::byte> plain(report_slots * sizeof(Message));
    std::uint64_t at = 0;
    const auto copy = [&](const Message& message) {
        std::memcpy(plain.data() + (at++ % report_slots) * sizeof message, &message, sizeof message);
        keep(plain);
    };
    const auto publish = [&](const Message& message) { ring.writer.publish(&message); };
    WaiterFlag flag;
    const WakeTarget sleepers[] = {{.flag = &flag}};
    bool waited_for = false;
    const auto publish_and_look = [&](const Message& message) {
        ring.writer.publish(&message);
        waited_for |= who_waits(sleepers).count > 0;
    };

    Paced paced_copy, paced_publish, paced_look, read_publish, read_look;
    Series fast_copy, fast_publish, fast_look;
    for (unsigned block = 0; block < 30 * place.effort; ++block) {
        paced(paced_copy, clock, copy);
        paced(paced_publish, clock, publish);
        paced(paced_look, clock, publish_and_look);
        back_to_back(fast_copy, clock, copy);
        back_to_back(fast_publish, clock, publish);
        back_to_back(fast_look, clock, publish_and_look);
        std::atomic<bool> stop = false;
        helper.start([&] {
            BroadcastReader reader(ring.segment.data(), report_slots, sizeof(Message));
            Message message;
            while (!stop.load(std::memory_order::relaxed)) reader.next(&message);
        });
        paced(read_publish, clock, publish);
        paced(read_look, clock, publish_and_look);
        stop = true;
        helper.finish();
    }
    keep(waited_for);
    std::vector<Result> results = {
        paced_copy.each.result("memcpy 256 B, paced t"),
        paced_publish.each.result("publish a report, paced t"),
        paced_look.each.result("publish and look for waiters, paced t"),
        read_publish.each.result("publish under a full-speed reader, paced t"),
        read_look.each.result("the same, drained by the look for waiters t"),
        paced_copy.means.result("memcpy 256 B, paced, means of 100 t"),
        paced_publish.means.result("publish a report, paced, means of 100 t"),
        fast_copy.result("memcpy 256 B, back to back"),
        fast_publish.result("publish a report, back to back"),
        fast_look.result("publish, nobody waits, back to back"),
    };
    for (const std::size_t i : {1u, 2u, 3u, 4u}) measure::relate(results[i], results[0]);
    measure::relate(results[6], results[5]);
    measure::relate(results[8], results[7]);
    measure::relate(results[9], results[8]);
    return results;
}

}  // namespace knurl::shm::bench
