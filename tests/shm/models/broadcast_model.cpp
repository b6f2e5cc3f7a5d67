// The report ring: a writer that overtakes its reader in a ring of two and of four slots.

#include "model.hpp"

namespace knurl::shm::model::broadcast_model_tests {
namespace {

using Memory = SimulatedMemory<AtomicPayload>;

template <class Orders, std::uint32_t count>
struct Reports : rl::test_suite<Reports<Orders, count>, 2> {
    static constexpr std::size_t slot_words = 2;
    static constexpr std::uint64_t reports = count + 3;

    Word end;
    Memory::Payload slots[count * slot_words];

    BroadcastPlaces<Memory> places() {
        return {.end = &end,
                .slots = slots,
                .count = count,
                .stride_words = slot_words,
                .slot_words = slot_words};
    }

    void before() {
        Memory::store(end, 0, std::memory_order::relaxed);
        for (auto& word : slots) Memory::store(word, 0, std::memory_order::relaxed);
    }

    void thread(unsigned index) { index == 0 ? write() : read(); }

    void write() {
        BasicBroadcastWriter<Memory, Orders> writer(places());
        for (std::uint64_t n = 0; n < reports; ++n) {
            const std::uint64_t report[slot_words] = {n + 1, n + 1};
            writer.publish(report);
        }
    }

    void read() {
        BasicBroadcastReader<Memory, Orders> reader(places(), 0);
        std::uint64_t got = 0;
        for (std::uint64_t i = 0; i < reports; ++i) {
            std::uint64_t report[slot_words] = {0, 0};
            const bool newest = i == reports / 2;
            if (!(newest ? reader.latest(report) : reader.next(report))) continue;
            ++got;
            require(report[0] == reader.position() &&
                    report[1] == reader.position());  // whole, and the right one
            require(got + reader.missed() + reader.skipped() == reader.position());
            std::uint64_t again[slot_words] = {0, 0};
            if (reader.at(reader.position() - 1, again))
                require(again[0] == report[0] && again[1] == report[1]);
        }
        require(!reader.restarted());
    }
};

/// The same writer, and a reader that copies two reports before it looks at the counter again.
template <class Orders, std::uint32_t count>
struct SomeReports : Reports<Orders, count> {
    using Base = Reports<Orders, count>;

    void thread(unsigned index) { index == 0 ? this->write() : read(); }

    void read() {
        BasicBroadcastReader<Memory, Orders> reader(this->places(), 0);
        std::uint64_t got = 0;
        for (std::uint64_t i = 0; i < Base::reports; ++i) {
            std::uint64_t some[2][Base::slot_words] = {};
            const std::size_t read =
                reader.next_some(reinterpret_cast<std::byte*>(some), sizeof some[0], std::size(some));
            got += read;
            for (std::size_t k = 0; k < read; ++k)
                for (const std::uint64_t word : some[k]) require(word == reader.position() - read + k + 1);
            require(got + reader.missed() == reader.position());
        }
    }
};

struct RelaxedPublishEnd : BroadcastOrders {
    static constexpr auto publish_end = std::memory_order::relaxed;
    static constexpr auto put_word = std::memory_order::relaxed;
};
struct RelaxedSeeEnd : BroadcastOrders {
    static constexpr auto see_end = std::memory_order::relaxed;
    static constexpr auto get_word = std::memory_order::relaxed;
};
struct RelaxedPutWord : BroadcastOrders {
    static constexpr auto put_word = std::memory_order::relaxed;
};
struct RelaxedGetWord : BroadcastOrders {
    static constexpr auto get_word = std::memory_order::relaxed;
};
/// No substitute: an acquire holds back what comes after it, and the words come before.
struct AcquireOnTheSecondEnd : RelaxedGetWord {
    static constexpr auto check_end = std::memory_order::acquire;
};
/// Takes the slot that the writer is filling for a readable one.
struct OneSlotTooMany : BroadcastOrders {
    static constexpr bool readable(std::uint64_t n, std::uint64_t end, std::uint64_t slots) {
        return end - n - 1 <= slots - 1;
    }
};

TEST(BroadcastModel, ReportsAreWholeAndTheMissedAreCountedExactly) {
    expect_holds<Reports<BroadcastOrders, 2>>();
    expect_holds<Reports<BroadcastOrders, 4>>();
}
TEST(BroadcastModel, SomeReportsAtOnceAreWholeAndTheMissedAreCountedExactly) {
    expect_holds<SomeReports<BroadcastOrders, 4>>();
}
TEST(BroadcastModel, WrongTwinsOfSomeReportsAtOnce) {
    expect_found_wrong<SomeReports<RelaxedPublishEnd, 4>>();
    expect_found_wrong<SomeReports<RelaxedGetWord, 4>>();
    expect_found_wrong<SomeReports<OneSlotTooMany, 4>>();
}
TEST(BroadcastModel, WrongTwinRelaxedPublishEnd) {
    expect_found_wrong<Reports<RelaxedPublishEnd, 2>>();
}
TEST(BroadcastModel, WrongTwinRelaxedSeeEnd) {
    expect_found_wrong<Reports<RelaxedSeeEnd, 2>>();
}
TEST(BroadcastModel, WrongTwinRelaxedPutWord) {
    expect_found_wrong<Reports<RelaxedPutWord, 2>>();
}
TEST(BroadcastModel, WrongTwinRelaxedGetWord) {
    expect_found_wrong<Reports<RelaxedGetWord, 2>>();
}
TEST(BroadcastModel, WrongTwinAcquireOnTheSecondEnd) {
    expect_found_wrong<Reports<AcquireOnTheSecondEnd, 2>>();
}
TEST(BroadcastModel, WrongTwinOneSlotTooMany) {
    expect_found_wrong<Reports<OneSlotTooMany, 2>>();
}

}  // namespace
}  // namespace knurl::shm::model::broadcast_model_tests
