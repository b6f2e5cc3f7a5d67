// Sleeping and waking: a client that gives up once and waits again, a servo that publishes once, the waker
// between them.

#include "model.hpp"

namespace knurl::shm::model::waiter_model_tests {
namespace {

using Memory = SimulatedMemory<AtomicPayload>;

enum class WokenBy { thread, servo };

template <class Orders, WokenBy by = WokenBy::thread>
struct Sleep : rl::test_suite<Sleep<Orders, by>, 3> {
    Word flag, end, poked, event;
    bool sleeps;

    void before() {
        for (Word* word : {&flag, &end, &poked, &event}) Memory::store(*word, 0, std::memory_order::relaxed);
        if (by == WokenBy::servo) Memory::store(poked, 1, std::memory_order::relaxed);  // of the cycle before
        sleeps = false;
    }

    void thread(unsigned index) {
        switch (index) {
            case 0:
                return client();
            case 1:
                return servo();
            default:
                return waker();
        }
    }

    void client() {
        if (!announce_wait<Memory, Orders>(flag, end, 0)) return;
        Memory::store(flag, 0, std::memory_order::relaxed);  // the time-out came first
        sleeps = announce_wait<Memory, Orders>(flag, end, 0);
    }

    void servo() {
        Memory::store(end, 1, std::memory_order::release);
        fence_after_publish<Memory, Orders>();
        if (Memory::load(flag, std::memory_order::relaxed) == 0) return;
        if (by == WokenBy::thread)
            Memory::store(poked, 1, std::memory_order::release);
        else if (lower_flag<Memory>(flag))
            Memory::store(event, 1, std::memory_order::release);
    }

    void waker() {
        if (Memory::load(poked, std::memory_order::acquire) != 0 && lower_flag<Memory>(flag))
            Memory::store(event, 1, std::memory_order::release);
    }

    void after() {
        if (by == WokenBy::thread) waker();  // a poke is never lost: the waker has a next round
        if (sleeps) require(Memory::load(event, std::memory_order::acquire) != 0);
    }
};

struct WeakWaiterFence : WaiterOrders {
    static constexpr auto waiter_fence = std::memory_order::acq_rel;
};
struct WeakPublisherFence : WaiterOrders {
    static constexpr auto publisher_fence = std::memory_order::acq_rel;
};
struct NoPublisherFence : WaiterOrders {
    static constexpr auto publisher_fence = std::memory_order::relaxed;
};

TEST(WaiterModel, WhoeverSleepsIsWoken) {
    expect_holds<Sleep<WaiterOrders>>();
}
TEST(WaiterModel, WhoeverSleepsIsWokenByTheServoItselfWhileTheWakerSweeps) {
    expect_holds<Sleep<WaiterOrders, WokenBy::servo>>();
}
TEST(WaiterModel, WrongTwinNoPublisherFenceWokenByTheServo) {
    expect_found_wrong<Sleep<NoPublisherFence, WokenBy::servo>>();
}
TEST(WaiterModel, WrongTwinWeakWaiterFence) {
    expect_found_wrong<Sleep<WeakWaiterFence>>();
}
TEST(WaiterModel, WrongTwinWeakPublisherFence) {
    expect_found_wrong<Sleep<WeakPublisherFence>>();
}
TEST(WaiterModel, WrongTwinNoPublisherFence) {
    expect_found_wrong<Sleep<NoPublisherFence>>();
}

/// A client at rest sends twice; the servo looks at its ring only when its word has changed.
template <class Orders>
struct Asleep : rl::test_suite<Asleep<Orders>, 2> {
    static constexpr std::uint32_t cells = 2;

    Word tail, head, sent;
    Memory::Payload ring[cells * cell_words];
    std::uint64_t seen, taken;

    SpscPlaces<Memory> places() { return {.tail = &tail, .head = &head, .cells = ring}; }

    void before() {
        for (Word* word : {&tail, &head, &sent}) Memory::store(*word, 0, std::memory_order::relaxed);
        for (auto& word : ring) Memory::store(word, 0, std::memory_order::relaxed);
        seen = taken = 0;
    }

    void thread(unsigned index) { index == 0 ? client() : servo(); }

    void client() {
        BasicSpscProducer<Memory> producer(places(), cells);
        BasicSentCount<Memory, Orders> count(&sent);
        const std::uint64_t cell[cell_words] = {1};
        for (int i = 0; i < 2; ++i) {
            require(producer.try_push(cell, 1));
            count.add();
        }
    }

    void servo() {
        BasicSpscConsumer<Memory> consumer(places(), cells);
        for (int cycle = 0; cycle < 4; ++cycle) {
            if (cycle > 0) {  // in the first it is awake, and looks whatever the word says
                const std::uint64_t now = sent_so_far<Memory, Orders>(sent);
                if (now == seen) continue;
                seen = now;
            }
            const std::uint32_t n = consumer.available();
            consumer.pop(n);
            taken += n;
        }
    }

    /// A client that believes it has seen everything is right.
    void after() {
        if (Memory::load(sent, std::memory_order::relaxed) == seen) require(taken == 2);
    }
};

struct RelaxedPublishSent : SentOrders {
    static constexpr auto publish = std::memory_order::relaxed;
};
struct RelaxedSeeSent : SentOrders {
    static constexpr auto see = std::memory_order::relaxed;
};

TEST(SleepModel, NothingThatAClientCountsIsOverlooked) {
    expect_holds<Asleep<SentOrders>>();
}
TEST(SleepModel, WrongTwinRelaxedPublishSent) {
    expect_found_wrong<Asleep<RelaxedPublishSent>>();
}
TEST(SleepModel, WrongTwinRelaxedSeeSent) {
    expect_found_wrong<Asleep<RelaxedSeeSent>>();
}

}  // namespace
}  // namespace knurl::shm::model::waiter_model_tests
