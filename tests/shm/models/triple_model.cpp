// The coalescing triple buffer: a client that issues commands and merges changes, a servo that takes batches.

#include "model.hpp"

namespace knurl::shm::model::triple_model_tests {
namespace {

using Memory = SimulatedMemory<PlainPayload>;

struct Rules : TripleOrders {
    static constexpr bool merge = true;  // what was not taken stays in later batches
};

template <class Rules, class Memory = Memory>
struct Buffer : rl::test_suite<Buffer<Rules, Memory>, 2> {
    static constexpr std::size_t slot_words = 3;  // versions of two representations, commands issued before
    // the first of representation 1, then of 0; before each, a command
    static constexpr std::uint64_t changes = 4;

    Word mid, commands;
    typename Memory::Payload slots[3 * slot_words];
    std::uint64_t applied[2];  // versions

    TriplePlaces<Memory> places() {
        return {.mid = &mid, .slots = slots, .slot_words = slot_words, .stride_words = slot_words};
    }

    void before() {
        Memory::store(mid, TripleMid::make(triple_first_mid, false, 0), std::memory_order::relaxed);
        Memory::store(commands, 0, std::memory_order::relaxed);
        for (auto& word : slots) word(here()) = 0;
        applied[0] = applied[1] = 0;
    }

    void thread(unsigned index) { index == 0 ? client() : servo(); }

    void client() {
        BasicTripleWriter<Memory, Rules> writer(places());
        std::uint64_t pending[slot_words] = {0, 0, 0};
        for (std::uint64_t n = 1; n <= changes; ++n) {
            Memory::store(commands, n, std::memory_order::release);
            const std::uint64_t changed = n == 1 ? 1 : 0;
            pending[changed] = n;
            pending[2] = n;
            const bool taken = writer.publish(pending, sizeof pending, n);
            if (taken || !Rules::merge) pending[1 - changed] = 0;
        }
        require(!writer.corrupt());
    }

    bool cycle(BasicTripleReader<Memory, Rules>& from) {
        const std::uint64_t done = Memory::load(commands, std::memory_order::acquire);
        if (!from.take(done)) return false;
        std::uint64_t batch[slot_words];
        from.copy(batch, 0, sizeof batch);
        require(batch[2] <= done);  // the channels never overtake each other
        require(batch[2] == from.front_tag());
        for (int i = 0; i < 2; ++i)
            if (batch[i] != 0) {
                require(batch[i] >= applied[i]);  // nothing stale
                applied[i] = batch[i];
            }
        return true;
    }

    void servo() {
        BasicTripleReader<Memory, Rules> from(places());
        for (int i = 0; i < 3; ++i) cycle(from);
        // Then, until the last change.
        for (int i = 0; i < 100 && applied[0] != changes; ++i) {
            if (!cycle(from)) rl::yield(1, here());
        }
        if (applied[0] == changes) require(applied[1] == 1);  // nothing lost on the way
        require(!from.corrupt());
    }
};

struct RelaxedPublish : Rules {
    static constexpr auto publish = std::memory_order::relaxed;
};
struct ReleaseOnlyPublish : Rules {
    static constexpr auto publish = std::memory_order::release;
};
struct RelaxedTake : Rules {
    static constexpr auto take = std::memory_order::relaxed;
};
struct AcquireOnlyTake : Rules {
    static constexpr auto take = std::memory_order::acquire;
};
struct NoMerge : Rules {
    static constexpr bool merge = false;
};
/// Reads the tag, then takes whatever is there by then.
struct LookThenExchange : Memory {
    static bool compare_exchange(Word& word, std::uint64_t& expected, std::uint64_t value,
                                 std::memory_order order) {
        expected = exchange(word, value, order);
        return true;
    }
};

TEST(TripleModel, EveryChangeArrivesWholeInOrderAndNeverBeforeItsCommands) {
    expect_holds<Buffer<Rules>>();
}
TEST(TripleModel, WrongTwinRelaxedPublish) {
    expect_found_wrong<Buffer<RelaxedPublish>>();
}
TEST(TripleModel, WrongTwinReleaseOnlyPublish) {
    expect_found_wrong<Buffer<ReleaseOnlyPublish>>();
}
TEST(TripleModel, WrongTwinRelaxedTake) {
    expect_found_wrong<Buffer<RelaxedTake>>();
}
TEST(TripleModel, WrongTwinAcquireOnlyTake) {
    expect_found_wrong<Buffer<AcquireOnlyTake>>();
}
TEST(TripleModel, WrongTwinNoMerge) {
    expect_found_wrong<Buffer<NoMerge>>();
}
TEST(TripleModel, WrongTwinLookThenExchange) {
    expect_found_wrong<Buffer<Rules, LookThenExchange>>();
}

}  // namespace
}  // namespace knurl::shm::model::triple_model_tests
