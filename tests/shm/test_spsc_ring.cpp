#include <gtest/gtest.h>

#include <knurl/shm/spsc_ring.hpp>

#include "support.hpp"

namespace knurl::shm {
namespace {

using test::Memory;
using Cell = test::Record<cell_words>;

class SpscRing : public testing::Test {
  protected:
    static constexpr std::uint32_t cells = 8;

    SpscRing() : memory_(spsc_bytes(cells)) { spsc_init(memory_.data()); }

    bool push(std::uint32_t n) {
        std::vector<Cell> group;
        for (std::uint32_t i = 0; i < n; ++i) group.push_back(Cell::numbered(pushed_ + i));
        if (!producer_.try_push(group.data(), n)) return false;
        pushed_ += n;
        return true;
    }
    void expect_cells(std::uint32_t n) {
        for (std::uint32_t i = 0; i < n; ++i) {
            Cell cell;
            ASSERT_TRUE(consumer_.peek(i, &cell, 1));
            ASSERT_TRUE(cell.is(popped_ + i));
        }
    }
    void pop(std::uint32_t n) {
        expect_cells(n);
        consumer_.pop(n);
        popped_ += n;
    }

    Memory memory_;
    SpscProducer producer_{memory_.data(), cells};
    SpscConsumer consumer_{memory_.data(), cells};
    std::uint64_t pushed_ = 0, popped_ = 0;
};

TEST_F(SpscRing, IsEmptyAtFirst) {
    EXPECT_EQ(consumer_.available(), 0u);
    EXPECT_EQ(producer_.free_cells(), cells);
}

TEST_F(SpscRing, HandsOverGroupsInOrderAroundItsEnd) {
    for (int round = 0; round < 100; ++round)
        for (std::uint32_t n = 1; n <= cells; ++n) {
            ASSERT_TRUE(push(n));
            ASSERT_EQ(consumer_.available(), n);
            pop(n);
        }
}

TEST_F(SpscRing, FullIsAnAnswerAndLosesNothing) {
    ASSERT_TRUE(push(6));
    EXPECT_FALSE(push(3));  // whole or not at all
    EXPECT_EQ(producer_.free_cells(), 2u);
    EXPECT_TRUE(push(2));
    EXPECT_FALSE(push(1));
    EXPECT_EQ(consumer_.available(), 8u);
    pop(1);
    EXPECT_TRUE(push(1));
    EXPECT_EQ(consumer_.available(), 8u);
    pop(8);
    EXPECT_FALSE(push(cells + 1));  // can never fit
}

TEST_F(SpscRing, PeekingConsumesNothing) {
    push(4);
    ASSERT_EQ(consumer_.available(), 4u);
    expect_cells(4);
    expect_cells(4);
    consumer_.pop(2);
    EXPECT_EQ(producer_.free_cells(), 6u);
    EXPECT_EQ(consumer_.available(), 2u);
}

TEST_F(SpscRing, NothingBeyondWhatIsAvailableCanBeReadOrPopped) {
    push(3);
    Cell out[8];
    EXPECT_FALSE(consumer_.peek(0, out, 1));  // before the first look
    ASSERT_EQ(consumer_.available(), 3u);
    EXPECT_TRUE(consumer_.peek(0, out, 3));
    EXPECT_FALSE(consumer_.peek(1, out, 3));
    EXPECT_FALSE(consumer_.peek(4, out, 1));
    EXPECT_FALSE(consumer_.peek(~0u, out, 1));
    EXPECT_FALSE(consumer_.peek(1, out, ~std::size_t{0}));
    consumer_.pop(100);
    EXPECT_EQ(consumer_.available(), 0u);
    EXPECT_EQ(producer_.free_cells(), cells);
}

TEST_F(SpscRing, AGroupIsSeenOnlyWhole) {
    // The one store that publishes is the tail: until it moves, the words may be there, but nothing is.
    std::uint64_t& tail = reinterpret_cast<SpscShared*>(memory_.data())->tail;
    push(5);
    EXPECT_EQ(tail, 5u);
    EXPECT_EQ(consumer_.available(), 5u);
}

TEST(SpscRingLayout, RefusesWhatCannotWork) {
    Memory memory(spsc_bytes(8));
    EXPECT_THROW(SpscProducer(memory.data(), 7), std::invalid_argument);
    EXPECT_THROW(SpscProducer(memory.data(), 0), std::invalid_argument);
    EXPECT_THROW(SpscConsumer(memory.data() + 64, 8), std::invalid_argument);
    EXPECT_THROW(SpscConsumer(nullptr, 8), std::invalid_argument);
    EXPECT_EQ(spsc_bytes(8), 2 * 128 + 8 * 64u);
}

}  // namespace
}  // namespace knurl::shm
