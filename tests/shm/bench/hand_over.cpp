// Round trips of 256 bytes between two CPUs, both sides spinning.

#include <boost/lockfree/spsc_queue.hpp>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/spsc_ring.hpp>

#include "bench.hpp"

namespace knurl::shm::bench {

namespace {

constexpr int trips = 500;  // in a block, 0.1 to 0.4 ms
constexpr std::uint32_t ring_cells = 64;
constexpr std::uint32_t ring_slots = 64;

/// The floor: one word on one line each way.
struct CacheLine {
    alignas(line_bytes) std::atomic<std::uint64_t> word = 0;
    alignas(line_bytes) std::uint64_t sent = 0;
    alignas(line_bytes) std::uint64_t got = 0;

    void send(const Message&) { word.store(++sent, std::memory_order::release); }
    bool receive(Message&) {
        if (word.load(std::memory_order::acquire) == got) return false;
        ++got;
        return true;
    }
};

struct CommandRing {
    static constexpr std::size_t cells = sizeof(Message) / cell_bytes;
    Segment segment = [] {
        Segment made = Segment::create("knurl-bench", spsc_bytes(ring_cells));
        spsc_init(made.data());
        return made;
    }();
    alignas(line_bytes) SpscProducer producer{segment.data(), ring_cells};
    alignas(line_bytes) SpscConsumer consumer{segment.data(), ring_cells};

    void send(const Message& message) {
        while (!producer.try_push(&message, cells)) {
        }
    }
    bool receive(Message& message) {
        if (consumer.available() == 0) return false;
        consumer.peek(0, &message, cells);
        consumer.pop(cells);
        return true;
    }
};

struct ReportRing {
    Segment segment = [] {
        Segment made = Segment::create("knurl-bench", broadcast_bytes(ring_slots, sizeof(Message)));
        broadcast_init(made.data());
        return made;
    }();
    alignas(line_bytes) BroadcastWriter writer{segment.data(), ring_slots, sizeof(Message)};
    alignas(line_bytes) BroadcastReader reader{segment.data(), ring_slots, sizeof(Message), 0};

    void send(const Message& message) { writer.publish(&message); }
    bool receive(Message& message) { return reader.next(&message); }
};

struct BoostRing {
    boost::lockfree::spsc_queue<Message, boost::lockfree::capacity<64>> queue;

    void send(const Message& message) {
        while (!queue.push(message)) {
        }
    }
    bool receive(Message& message) { return queue.pop(message); }
};

template <class Channel>
class PingPong {
  public:
    void block(Helper& helper, const Stopwatch& clock) {
        helper.start([this] {
            Message message;
            for (int i = 0; i < trips; ++i) {
                while (!forth_.receive(message)) {
                }
                back_.send(message);
            }
        });
        Message message;
        series_.begin_block();
        for (int i = 0; i < trips; ++i) {
            message.word[0] = static_cast<std::uint64_t>(i);
            const std::uint64_t at = Stopwatch::begin();
            forth_.send(message);
            while (!back_.receive(message)) {
            }
            series_.add(clock.nanoseconds(at, Stopwatch::end()));
        }
        helper.finish();
    }
    Result result(const char* name) { return series_.result(name); }

  private:
    Channel forth_, back_;
    Series series_;
};

}  // namespace

std::vector<Result> hand_over(const Place& place, const Stopwatch& clock) {
    Helper helper(place.client_cpu, place.real_time);
    const auto line = std::make_unique<PingPong<CacheLine>>();
    const auto commands = std::make_unique<PingPong<CommandRing>>();
    const auto reports = std::make_unique<PingPong<ReportRing>>();
    const auto boost_ring = std::make_unique<PingPong<BoostRing>>();
    for (unsigned block = 0; block < 125 * place.effort; ++block) {
        line->block(helper, clock);
        commands->block(helper, clock);
        boost_ring->block(helper, clock);
        reports->block(helper, clock);
    }
    std::vector<Result> results = {line->result("cache line, round trip t"),
                                   boost_ring->result("boost::lockfree::spsc_queue, 256 B round trip t"),
                                   commands->result("command ring, 256 B round trip t"),
                                   commands->result("command ring, against Boost's"),
                                   reports->result("report ring, 256 B round trip t"),
                                   reports->result("report ring, against Boost's")};
    measure::relate(results[1], results[0]);
    measure::relate(results[2], results[0]);
    measure::relate(results[3], results[1]);
    measure::relate(results[4], results[0]);
    measure::relate(results[5], results[1]);
    return results;
}

}  // namespace knurl::shm::bench
