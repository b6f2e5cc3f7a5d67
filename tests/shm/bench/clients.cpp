// The drain of a servo with 128 clients, a segment each.

#include <chrono>

#include <knurl/shm/segment.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>

#include "bench.hpp"

namespace knurl::shm::bench {

namespace {

constexpr std::size_t count = 128;
constexpr std::uint32_t cells = 64;
constexpr std::size_t message_cells = sizeof(Message) / cell_bytes;

constexpr std::size_t flag_at = 0;
constexpr std::size_t batches_at = flag_at + sizeof(WaiterFlag);
constexpr std::size_t ring_at = batches_at + triple_bytes(sizeof(Message));
constexpr std::size_t segment_bytes = segment_colour_bytes + ring_at + spsc_bytes(cells);

struct Client {
    explicit Client(std::size_t number) : base(segment.data() + segment_colour(number)) {
        triple_init(base + batches_at);
        spsc_init(base + ring_at);
    }
    Segment segment = Segment::create("knurl-bench", segment_bytes);
    std::byte* base;
    TripleWriter batches_out{base + batches_at, sizeof(Message)};
    SpscProducer ring_out{base + ring_at, cells};
};

/// The servo's ends, together as in its own tables.
struct Ends {
    std::vector<TripleReader> batches;
    std::vector<SpscConsumer> rings;
    std::vector<WakeTarget> sleepers;

    explicit Ends(std::vector<Client>& clients) {
        for (Client& client : clients) {
            batches.emplace_back(client.base + batches_at, sizeof(Message));
            rings.emplace_back(client.base + ring_at, cells);
            sleepers.push_back({.flag = reinterpret_cast<WaiterFlag*>(client.base + flag_at)});
        }
    }

    std::size_t take_batches(std::vector<Message>& out) {
        std::size_t n = 0;
        for (TripleReader& reader : batches)
            if (reader.take()) reader.copy(&out[n++], 0, sizeof(Message));
        return n;
    }
    void prefetch_batches() const {
        for (const TripleReader& reader : batches) reader.prefetch();
    }
    std::size_t take_rings(std::vector<Message>& out) {
        std::size_t n = 0;
        for (SpscConsumer& ring : rings) {
            const std::uint32_t available = ring.available();
            if (available < message_cells) continue;
            // the newest
            ring.peek(available - static_cast<std::uint32_t>(message_cells), &out[n++], message_cells);
            ring.pop(available);
        }
        return n;
    }
};

}  // namespace

std::vector<Result> clients(const Place& place, const Stopwatch& clock) {
    Helper helper(place.client_cpu, place.real_time);
    std::vector<Client> all;
    for (std::size_t i = 0; i < count; ++i) all.emplace_back(i);
    Ends ends(all);
    std::vector<Message> out(count);
    std::vector<std::byte> other_work(1 << 20);
    std::size_t taken = 0;
    const auto timed = [&](Series& series, const auto& action) {
        const std::uint64_t begin = Stopwatch::begin();
        taken += action();
        series.add(clock.nanoseconds(begin, Stopwatch::end()));
    };

    // Idle: nothing is fresh.
    const auto idle = [&] { return ends.take_batches(out); };
    const auto idle_with_flags = [&] { return ends.take_batches(out) + who_waits(ends.sleepers).count; };
    Series warm, warm_flags, cold;
    for (unsigned block = 0; block < 20 * place.effort; ++block) {
        warm.begin_block();
        warm_flags.begin_block();
        for (int i = 0; i < 100; ++i) timed(warm, idle);
        for (int i = 0; i < 100; ++i) timed(warm_flags, idle_with_flags);
        for (int i = 0; i < 25; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            for (std::size_t k = 0; k < other_work.size(); k += 64) other_work[k] ^= std::byte{1};
            timed(cold, idle);
        }
    }
    keep(other_work);

    // Fresh: one batch in each, filled from the other CPU.
    Series two_passes, one_pass, ring;
    const auto fill = [&](bool rings) {
        helper.start([&all, rings] {
            const Message message;
            for (Client& client : all) {
                if (rings)
                    client.ring_out.try_push(&message, message_cells);
                else
                    client.batches_out.publish(&message, sizeof message);
            }
        });
        helper.finish();
    };
    std::size_t fills = 0;
    taken = 0;
    for (unsigned block = 0; block < 350 * place.effort; ++block) {
        for (int i = 0; i < 3 + Series::warm_up; ++i) {
            if (i == 0)
                for (Series* series : {&two_passes, &one_pass, &ring}) series->begin_block();
            fill(false);
            timed(two_passes, [&] {
                ends.prefetch_batches();
                return ends.take_batches(out);
            });
            fill(false);
            timed(one_pass, [&] { return ends.take_batches(out); });
            fill(true);
            timed(ring, [&] { return ends.take_rings(out); });
            fills += 3;
        }
    }
    if (taken != fills * count) throw std::runtime_error("knurl_bench_rings: a batch went missing");
    keep(out);

    std::vector<Result> results = {
        warm.result("128 idle clients, warm t"),
        warm_flags.result("128 idle clients and their flags, warm t"),
        cold.result("128 idle clients, after 1 ms and 1 MiB of other work t"),
        ring.result("128 fresh batches, command rings, one pass t"),
        one_pass.result("128 fresh batches, triple buffers, one pass t"),
        two_passes.result("128 fresh batches, triple buffers, two passes t"),
    };
    for (std::size_t i : {1u, 2u}) measure::relate(results[i], results[0]);
    for (std::size_t i : {4u, 5u}) measure::relate(results[i], results[3]);
    return results;
}

}  // namespace knurl::shm::bench
