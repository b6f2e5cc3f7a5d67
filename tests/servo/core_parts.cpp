// How a cycle's time divides, as `knurl top` shows it.

#include <atomic>
#include <thread>

#include <gtest/gtest.h>
#include <stage_clock.hpp>

#include <knurl/protocol/device_segment.hpp>
#include <knurl/shm/counters.hpp>

#include "core_support.hpp"

namespace knurl::servo::testing {
namespace {

using protocol::Count;

/// Each reading takes 100 ns.
class TickingClock final : public Clock {
  public:
    Nanoseconds now() noexcept override { return time += 100; }
    Nanoseconds time = 0;
};

TEST(Parts, OneCycleIn64IsStampedAndItsPartsAddUp) {
    TickingClock clock;
    StageClock stages(clock);
    for (std::uint64_t cycle = 1; cycle <= 640; ++cycle) {
        const Nanoseconds before = clock.time;
        stages.begin(cycle, clock.time);
        clock.time += 1000;  // the device was read
        stages.end(Stage::read);
        stages.end(Stage::kinematics);
        clock.time += 500;
        stages.end(Stage::scenes);
        EXPECT_EQ(clock.time - before, cycle % 64 == 0 ? 1800 : 1500)
            << "the others do not look at the clock";
    }
    EXPECT_EQ(stages.stamped(), 10u);
    EXPECT_EQ(stages.sum(Stage::read), 10 * 1100u);
    EXPECT_EQ(stages.sum(Stage::kinematics), 10 * 100u);
    EXPECT_EQ(stages.sum(Stage::scenes), 10 * 600u);
    EXPECT_EQ(stages.sum(Stage::publish), 0u);
}

TEST(Parts, AClockThatIsSetBackTakesNoTimeBack) {
    TickingClock clock;
    StageClock stages(clock);
    stages.begin(64, 5000);
    stages.end(Stage::read);
    EXPECT_EQ(stages.sum(Stage::read), 0u);
}

TEST(Parts, TheServoCountsThem) {
    PuppetDevice device;
    Offline servo(device, live_options());
    run(servo, 63);
    EXPECT_EQ(servo.count(Count::stamped_cycles), 0u);
    run(servo, 577);
    EXPECT_EQ(servo.count(Count::stamped_cycles), 10u);
    EXPECT_EQ(servo.count(Count::read_ns), 0u) << "its clock stands still within a cycle";
}

/// A servo with one client, and a view of its row in the device's table.
struct Watched {
    PuppetDevice device;
    TickingClock clock;
    OfflineMemory segment{protocol::device_layout().total};
    Servo servo{device, clock, segment.data(), live_options()};
    ClaimTerms terms;
    OfflineMemory memory;
    protocol::ClientRow row{};
    Claim claim;
    Nanoseconds now = 0;

    explicit Watched(const ClaimTerms& stated)
        : terms(stated),
          memory(protocol::claim_layout(stated.capacity).total),
          claim(stated, memory.data(), &row) {
        servo.adopt(&claim);
        run(1);
    }
    void run(int cycles) {
        for (int i = 0; i < cycles; ++i, now += 1'000'000) {
            clock.time = now;
            servo.step(now, now);
        }
    }
    shm::WaiterFlag& line() {
        return *reinterpret_cast<shm::WaiterFlag*>(memory.data() +
                                                   protocol::claim_layout(terms.capacity).waiter);
    }
};

TEST(Parts, AStampedCycleTellsOfAllItsPartsAtItsEnd) {
    Watched client(ClaimTerms{});
    const shm::CountersReader counters(client.segment.data() + protocol::device_layout().counters,
                                       protocol::count_names);
    const auto first = static_cast<std::size_t>(Count::read_ns),
               last = static_cast<std::size_t>(Count::publish_ns);
    client.run(62);
    for (std::size_t part = first; part <= last; ++part) EXPECT_EQ(counters.read(part), 0u);
    client.run(1);
    for (std::size_t part = first; part <= last; ++part)
        EXPECT_GE(counters.read(part), 100u) << counters.name(part);
}

TEST(ClientRows, SayWithin64CyclesWhatTheClientSaysThatItMissed) {
    for (const bool observer : {false, true}) {
        ClaimTerms terms;
        terms.observer = observer;
        if (observer) terms.capacity = {0, 0};
        Watched client(terms);
        EXPECT_EQ(client.row.missed, 0u);
        for (const std::uint64_t missed : {7ull, 9ull, ~0ull}) {  // any value of the client
            client.line().missed = missed;
            client.run(64);
            EXPECT_EQ(client.row.missed, missed) << (observer ? "observer" : "claim");
        }
    }
}

TEST(ClientRows, ACycleLooksAtFewClientsLines) {
    Watched first(ClaimTerms{});
    std::array<protocol::ClientRow, 4> rows{};
    std::vector<std::unique_ptr<OfflineClaim>> others;
    for (protocol::ClientRow& row : rows) {
        others.push_back(std::make_unique<OfflineClaim>(ClaimTerms{}, nullptr, &row));
        first.servo.adopt(&others.back()->servo_side());
        const std::size_t waiter = others.back()->layout().waiter;
        reinterpret_cast<shm::WaiterFlag*>(others.back()->memory() + waiter)->missed = 1;
    }
    std::uint64_t told = 0;
    for (int cycle = 0; cycle < 64; ++cycle) {
        first.run(1);
        std::uint64_t now = 0;
        for (const protocol::ClientRow& row : rows) now += row.missed;
        EXPECT_LE(now, told + 1) << "cycle " << cycle;
        told = now;
    }
    EXPECT_EQ(told, rows.size());
}

TEST(ClientRows, ClientAndLookersHaveThreadsOfTheirOwn) {
    Watched servo(ClaimTerms{});
    std::atomic<bool> done = false;
    std::thread client([&] {
        for (std::uint64_t missed = 1; !done; ++missed)
            shm::HardwareMemory::store(servo.line().missed, missed, std::memory_order::relaxed);
    });
    std::thread looker([&] {
        for (std::uint64_t seen = 0; !done;) {
            const std::uint64_t missed = servo.row.missed.load(std::memory_order::relaxed);
            EXPECT_GE(missed, seen);
            seen = missed;
        }
    });
    servo.run(10'000);
    done = true;
    client.join();
    looker.join();
    servo.run(64);
    EXPECT_EQ(servo.row.missed, servo.line().missed);
}

}  // namespace
}  // namespace knurl::servo::testing
