// The other side writes anything into the shared words. It can spoil its own data; it cannot cause a crash, a
// hang, or an access outside the ring, whose memory ends at guard pages here.

#include <thread>

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>

#include "support.hpp"

namespace knurl::shm {
namespace {

/// Ends exactly where a page without access begins, and begins after one.
class Guarded {
  public:
    explicit Guarded(std::size_t bytes)
        : bytes_(round_up(bytes, line_bytes)), mapped_(round_up(bytes_, page) + 2 * page) {
        void* memory = ::mmap(nullptr, mapped_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) std::abort();
        base_ = static_cast<std::byte*>(memory);
        if (::mprotect(base_ + page, mapped_ - 2 * page, PROT_READ | PROT_WRITE) != 0) std::abort();
    }
    Guarded(const Guarded&) = delete;
    Guarded& operator=(const Guarded&) = delete;
    ~Guarded() { ::munmap(base_, mapped_); }

    std::byte* data() const { return base_ + mapped_ - page - bytes_; }
    std::size_t words() const { return bytes_ / 8; }
    std::uint64_t& word(std::size_t i) const { return reinterpret_cast<std::uint64_t*>(data())[i]; }

  private:
    static constexpr std::size_t page = 4096;
    std::size_t bytes_, mapped_;
    std::byte* base_;
};

class Hostile : public testing::Test {
  protected:
    Hostile() : trace_(__FILE__, __LINE__, "KNURL_SEED=" + std::to_string(test::seed())) {}

    std::uint64_t adversarial() {
        constexpr std::uint64_t liked[] = {0,   1,        2,   3,          4,          5,         6,  7,
                                           8,   9,        15,  16,         17,         63,        64, 255,
                                           256, 1u << 31, ~0u, 1ull << 32, 1ull << 62, 1ull << 63};
        const std::uint64_t value = liked[random_() % std::size(liked)];
        switch (random_() % 4) {
            case 0:
                return value;
            case 1:
                return ~value;
            case 2:
                return value + random_() % 32;
            default:
                return random_();
        }
    }
    /// Close to the present value, as a subtle attacker would write.
    void spoil(const Guarded& memory, std::size_t word) {
        std::uint64_t& at = memory.word(word);
        const std::uint64_t now = HardwareMemory::load(at, std::memory_order::relaxed);
        HardwareMemory::store(at, random_() % 2 ? adversarial() : now + random_() % 9 - 4,
                              std::memory_order::relaxed);
    }

    std::mt19937_64 random_{test::seed()};
    testing::ScopedTrace trace_;
    const int rounds_ = test::long_run() ? 2'000'000 : 60'000;
};

TEST_F(Hostile, ProducerCannotMislead) {
    constexpr std::uint32_t cells = 8;
    const Guarded memory(spsc_bytes(cells));
    for (int round = 0; round < rounds_; ++round) {
        spsc_init(memory.data());
        SpscProducer producer(memory.data(), cells);
        SpscConsumer consumer(memory.data(), cells);
        bool was_corrupt = false;
        for (int step = 0; step < 6; ++step) {
            const std::uint64_t cell[cell_words] = {};
            producer.try_push(cell, 1);
            if (random_() % 2) spoil(memory, offsetof(SpscShared, tail) / 8);
            const std::uint32_t n = consumer.available();
            ASSERT_LE(n, cells);
            ASSERT_TRUE(!was_corrupt || (consumer.corrupt() && n == 0)) << "corrupt is for ever";
            was_corrupt = consumer.corrupt();
            std::uint64_t out[cells * cell_words];
            ASSERT_EQ(consumer.peek(0, out, n), true);
            const auto at = static_cast<std::uint32_t>(adversarial());
            const std::size_t wanted = random_() % (cells + 1);
            ASSERT_EQ(consumer.peek(at, out, wanted), at <= n && wanted <= n - at);
            consumer.pop(static_cast<std::uint32_t>(adversarial()));
        }
    }
}

TEST_F(Hostile, ConsumerCannotMislead) {
    constexpr std::uint32_t cells = 8;
    const Guarded memory(spsc_bytes(cells));
    for (int round = 0; round < rounds_; ++round) {
        spsc_init(memory.data());
        SpscProducer producer(memory.data(), cells);
        for (int step = 0; step < 6; ++step) {
            spoil(memory, offsetof(SpscShared, head) / 8);
            const std::uint64_t group[cells * cell_words] = {};
            ASSERT_LE(producer.free_cells(), cells);
            producer.try_push(group, random_() % (cells + 1));
        }
    }
}

TEST_F(Hostile, BatchWriterCannotMislead) {
    constexpr std::size_t slot_bytes = 256;
    const Guarded memory(triple_bytes(slot_bytes));
    for (int round = 0; round < rounds_; ++round) {
        triple_init(memory.data());
        TripleReader reader(memory.data(), slot_bytes);
        bool was_corrupt = false;
        for (int step = 0; step < 6; ++step) {
            spoil(memory, 0);
            reader.prefetch();
            const std::uint64_t allowed = adversarial();
            const auto pending = reader.pending_tag();
            const bool taken = reader.take(allowed);
            ASSERT_TRUE(!taken || (pending == reader.front_tag() && reader.front_tag() <= allowed));
            ASSERT_FALSE(taken && was_corrupt) << "corrupt is for ever";
            was_corrupt = reader.corrupt();
            std::uint64_t out[slot_bytes / 8];
            reader.copy(out, 0, sizeof out);
            ASSERT_GE(reader.front(), memory.data() + line_bytes);
            ASSERT_LE(reader.front() + slot_bytes, memory.data() + triple_bytes(slot_bytes));
        }
    }
}

TEST_F(Hostile, FeedbackReaderCannotMislead) {
    constexpr std::size_t slot_bytes = 256;
    const Guarded memory(triple_bytes(slot_bytes));
    for (int round = 0; round < rounds_; ++round) {
        triple_init(memory.data());
        TripleWriter writer(memory.data(), slot_bytes);
        for (int step = 0; step < 6; ++step) {
            spoil(memory, 0);
            const std::uint64_t batch[slot_bytes / 8] = {};
            writer.publish(batch, sizeof batch, adversarial());
        }
    }
}

TEST_F(Hostile, ReportRingWithAnyBytesIsReadWithoutHangingOrLeavingIt) {
    constexpr std::uint32_t slots = 8;
    const Guarded memory(broadcast_bytes(slots, 64));
    for (int round = 0; round < rounds_; ++round) {
        spoil(memory, 0);
        BroadcastReader reader(memory.data(), slots, 64,
                               random_() % 2 ? BroadcastReader::newest : adversarial());
        for (int step = 0; step < 6; ++step) {
            spoil(memory, random_() % 2 ? 0 : random_() % memory.words());
            std::uint64_t out[8 * slots];
            const std::uint64_t before = reader.position();
            switch (random_() % 4) {
                case 0:
                    reader.next(out);
                    break;
                case 1:
                    reader.latest(out);
                    break;
                case 2:
                    ASSERT_LT(reader.next_some(reinterpret_cast<std::byte*>(out), 64, slots), slots);
                    break;
                default:
                    reader.at(adversarial(), out);
            }
            ASSERT_GE(reader.position(), before);
            reader.restarted();
        }
    }
}

TEST_F(Hostile, FlagsWithAnyBytesOnlyWakeTheirOwner) {
    WaiterFlag flag;
    const WakePair wake = make_wake_pair();
    Waker waker;
    waker.add({.flag = &flag, .wake_fd = wake.servo.get()});
    for (int round = 0; round < 1000; ++round) {
        flag.waiting = adversarial();
        ASSERT_LE(waker.run_once(), 1u);
        ASSERT_EQ(flag.waiting, 0u);
    }
}

TEST_F(Hostile, AScribblerAtFullSpeedStopsNobody) {
    constexpr std::uint32_t cells = 8;
    constexpr std::size_t slot_bytes = 128;
    const Guarded commands(spsc_bytes(cells)), replies(spsc_bytes(cells));
    const Guarded batches(triple_bytes(slot_bytes)), feedback(triple_bytes(slot_bytes));
    const Guarded reports(broadcast_bytes(8, 64));
    for (const Guarded* memory : {&commands, &replies}) spsc_init(memory->data());
    for (const Guarded* memory : {&batches, &feedback}) triple_init(memory->data());
    std::atomic<bool> stop = false;
    std::thread scribbler([&] {
        const Guarded* const all[] = {&commands, &replies, &batches, &feedback, &reports};
        while (!stop.load(std::memory_order::relaxed))
            for (const Guarded* memory : all) {
                spoil(*memory, 0);
                spoil(*memory, random_() % memory->words());
            }
    });
    SpscConsumer commands_in(commands.data(), cells);
    SpscProducer replies_out(replies.data(), cells);
    TripleReader batches_in(batches.data(), slot_bytes);
    TripleWriter feedback_out(feedback.data(), slot_bytes);
    BroadcastReader reports_in(reports.data(), 8, 64);
    std::uint64_t block[cells * cell_words] = {};
    for (int round = 0; round < rounds_; ++round) {
        const std::uint32_t n = commands_in.available();
        ASSERT_LE(n, cells);
        commands_in.peek(0, block, n);
        commands_in.pop(n);
        replies_out.try_push(block, 3);
        if (batches_in.take(1000)) batches_in.copy(block, 0, slot_bytes);
        feedback_out.publish(block, slot_bytes);
        reports_in.next(block);
        if (commands_in.corrupt()) commands_in = SpscConsumer(commands.data(), cells);
        if (batches_in.corrupt()) batches_in = TripleReader(batches.data(), slot_bytes);
        if (reports_in.restarted()) reports_in = BroadcastReader(reports.data(), 8, 64);
    }
    stop = true;
    scribbler.join();
}

}  // namespace
}  // namespace knurl::shm
