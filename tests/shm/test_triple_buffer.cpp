#include <array>

#include <gtest/gtest.h>

#include <knurl/shm/triple_buffer.hpp>

#include "support.hpp"

namespace knurl::shm {
namespace {

using test::Memory;
using Batch = test::Record<40>;

class TripleBuffer : public testing::Test {
  protected:
    TripleBuffer() : memory_(triple_bytes(sizeof(Batch))) { triple_init(memory_.data()); }

    bool publish(std::uint64_t number, std::uint64_t tag = 0) {
        const Batch batch = Batch::numbered(number);
        return writer_.publish(&batch, sizeof batch, tag);
    }
    Batch front() const {
        Batch batch;
        reader_.copy(&batch, 0, sizeof batch);
        return batch;
    }

    Memory memory_;
    TripleWriter writer_{memory_.data(), sizeof(Batch)};
    TripleReader reader_{memory_.data(), sizeof(Batch)};
};

TEST_F(TripleBuffer, HasNothingAtFirst) {
    EXPECT_FALSE(reader_.fresh());
    EXPECT_FALSE(reader_.pending_tag());
    EXPECT_FALSE(reader_.take());
}

TEST_F(TripleBuffer, GivesTheNewestAndEachOnce) {
    for (std::uint64_t n = 0; n < 100; ++n) {
        for (std::uint64_t i = 0; i <= n % 4; ++i) publish(10 * n + i);
        ASSERT_TRUE(reader_.fresh());
        reader_.prefetch();
        ASSERT_TRUE(reader_.take());
        ASSERT_TRUE(front().is(10 * n + n % 4));
        ASSERT_FALSE(reader_.take());
        ASSERT_TRUE(front().is(10 * n + n % 4));  // what was taken stays
    }
}

TEST_F(TripleBuffer, WhatWasTakenIsNotTouchedByLaterBatches) {
    publish(1);
    ASSERT_TRUE(reader_.take());
    for (std::uint64_t n = 2; n < 20; ++n) {
        publish(n);
        ASSERT_TRUE(front().is(1));
    }
    EXPECT_EQ(std::memcmp(reader_.front(), Batch::numbered(1).word, sizeof(Batch)), 0);
}

TEST_F(TripleBuffer, TellsTheWriterWhetherTheBatchBeforeWasTaken) {
    publish(1);
    EXPECT_FALSE(publish(2));  // 1 was replaced: a writer that must lose nothing has merged it into 2
    ASSERT_TRUE(reader_.take());
    EXPECT_TRUE(publish(3));
    EXPECT_FALSE(publish(4));
}

TEST_F(TripleBuffer, ABatchWaitsForTheCommandsIssuedBeforeIt) {
    publish(1, 7);
    EXPECT_EQ(reader_.pending_tag(), 7u);
    EXPECT_FALSE(reader_.take(6));
    EXPECT_FALSE(publish(2, 8));  // it was not taken: keep merging
    EXPECT_FALSE(reader_.take(7));
    EXPECT_TRUE(reader_.take(8));
    EXPECT_TRUE(front().is(2));
    EXPECT_EQ(reader_.front_tag(), 8u);
    EXPECT_FALSE(reader_.pending_tag());
}

TEST_F(TripleBuffer, TagsHave56Bits) {
    publish(1, max_triple_tag);
    EXPECT_EQ(reader_.pending_tag(), max_triple_tag);
    EXPECT_TRUE(reader_.take());
    EXPECT_TRUE(front().is(1));
}

TEST_F(TripleBuffer, PublishesPartsOneAfterTheOther) {
    const Batch whole = Batch::numbered(5);
    const auto bytes = std::as_bytes(std::span(whole.word));
    const std::array parts = {bytes.first(16), bytes.subspan(16, 0), bytes.subspan(16, 80),
                              bytes.subspan(96)};
    writer_.publish(3, parts);
    ASSERT_TRUE(reader_.take(3));
    EXPECT_TRUE(front().is(5));
}

TEST_F(TripleBuffer, CopiesAnyPieceAndNothingBeyondTheSlot) {
    publish(5);
    ASSERT_TRUE(reader_.take());
    std::uint64_t out[4] = {1, 2, 3, 4};
    reader_.copy(out, 38 * 8, sizeof out);
    EXPECT_EQ(out[0], test::word_of(5, 38));
    EXPECT_EQ(out[1], test::word_of(5, 39));
    EXPECT_EQ(out[2], 3u);
    reader_.copy(out, 1000 * 8, sizeof out);
    EXPECT_EQ(out[0], test::word_of(5, 38));
}

TEST_F(TripleBuffer, CutsOffWhatGoesBeyondTheSlot) {
    const std::vector<std::uint64_t> large(200, 9);
    const Batch kept = Batch::numbered(1);
    writer_.publish(&kept, sizeof kept);
    ASSERT_TRUE(reader_.take());
    for (int i = 0; i < 3; ++i) writer_.publish(large.data(), large.size() * 8);
    EXPECT_TRUE(front().is(1));  // the neighbours are whole
    ASSERT_TRUE(reader_.take());
    EXPECT_EQ(front().word[39], 9u);
}

TEST(TripleBufferLayout, RefusesWhatCannotWork) {
    Memory memory(triple_bytes(64));
    EXPECT_THROW(TripleWriter(memory.data(), 63), std::invalid_argument);
    EXPECT_THROW(TripleWriter(memory.data(), 0), std::invalid_argument);
    EXPECT_THROW(TripleReader(memory.data() + 8, 64), std::invalid_argument);
    EXPECT_EQ(triple_bytes(64), 128 + 3 * 128u);
    EXPECT_EQ(triple_bytes(256), 128 + 3 * 256u);
}

}  // namespace
}  // namespace knurl::shm
