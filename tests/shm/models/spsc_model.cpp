// The command ring: groups of 1, 2 and 1 cells through a ring of two.

#include "model.hpp"

namespace knurl::shm::model {
namespace {

using Memory = SimulatedMemory<PlainPayload>;

template <class Orders>
struct Ring : rl::test_suite<Ring<Orders>, 2> {
    static constexpr std::uint32_t cells = 2;
    static constexpr std::uint64_t groups[3] = {1, 2, 1};

    Word tail, head;
    Memory::Payload memory[cells * cell_words];

    SpscPlaces<Memory> places() { return {.tail = &tail, .head = &head, .cells = memory}; }

    void before() {
        Memory::store(tail, 0, std::memory_order::relaxed);
        Memory::store(head, 0, std::memory_order::relaxed);
        for (auto& word : memory) word(here()) = 0;
    }

    void thread(unsigned index) { index == 0 ? produce() : consume(); }

    void produce() {
        BasicSpscProducer<Memory, Orders> producer(places(), cells);
        std::uint64_t number = 0;
        int attempts = 0;
        for (const std::uint64_t n : groups) {
            std::uint64_t group[2 * cell_words];
            for (std::size_t i = 0; i < n * cell_words; ++i) group[i] = number + i / cell_words;
            while (!producer.try_push(group, n))
                if (++attempts == 8) return;
            number += n;
        }
    }

    void consume() {
        BasicSpscConsumer<Memory, Orders> consumer(places(), cells);
        std::uint64_t number = 0;
        for (int round = 0; round < 6; ++round) {
            const std::uint32_t n = consumer.available();
            const std::uint64_t seen = number + n;
            require(seen == 0 || seen == 1 || seen == 3 || seen == 4);  // a group is whole or not there
            std::uint64_t got[cells * cell_words];
            require(consumer.peek(0, got, n));
            for (std::size_t i = 0; i < n * cell_words; ++i) require(got[i] == number + i / cell_words);
            consumer.pop(n);
            number += n;
        }
        require(!consumer.corrupt());
    }
};

struct RelaxedPublishTail : SpscOrders {
    static constexpr auto publish_tail = std::memory_order::relaxed;
};
struct RelaxedSeeTail : SpscOrders {
    static constexpr auto see_tail = std::memory_order::relaxed;
};
struct RelaxedPublishHead : SpscOrders {
    static constexpr auto publish_head = std::memory_order::relaxed;
};
struct RelaxedSeeHead : SpscOrders {
    static constexpr auto see_head = std::memory_order::relaxed;
};

TEST(SpscModel, GroupsArriveWholeInOrderAndAreNotOverwrittenTooEarly) {
    expect_holds<Ring<SpscOrders>>();
}
TEST(SpscModel, WrongTwinRelaxedPublishTail) {
    expect_found_wrong<Ring<RelaxedPublishTail>>();
}
TEST(SpscModel, WrongTwinRelaxedSeeTail) {
    expect_found_wrong<Ring<RelaxedSeeTail>>();
}
TEST(SpscModel, WrongTwinRelaxedPublishHead) {
    expect_found_wrong<Ring<RelaxedPublishHead>>();
}
TEST(SpscModel, WrongTwinRelaxedSeeHead) {
    expect_found_wrong<Ring<RelaxedSeeHead>>();
}

}  // namespace
}  // namespace knurl::shm::model
