// Two threads at full speed. Run under ThreadSanitizer: the command ring and the triple buffer are built here
// over plain payload, so that a slot which both sides touch at once is a race that it reports. (Over atomic
// words it would be silent even about a ring without any order.)

#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>

#include "support.hpp"

namespace knurl::shm {
namespace {

using test::Memory;
using test::Record;

struct PlainPayloadMemory : HardwareMemory {
    // Not memcpy: GCC expands a short one inline after the sanitizer's pass, which then never sees it.
    static void store_payload(Payload* shared, const void* from, std::size_t words,
                              std::memory_order) noexcept {
        for (std::size_t i = 0; i < words; ++i) shared[i] = static_cast<const std::uint64_t*>(from)[i];
    }
    static void load_payload(void* to, const Payload* shared, std::size_t words, std::memory_order) noexcept {
        for (std::size_t i = 0; i < words; ++i) static_cast<std::uint64_t*>(to)[i] = shared[i];
    }
};

constexpr std::uint64_t messages = 50000;

TEST(Threads, CommandRingKeepsOrderAndWholeness) {
    constexpr std::uint32_t cells = 16;
    using Cell = Record<cell_words>;
    Memory memory(spsc_bytes(cells));
    spsc_init(memory.data());
    const SpscPlaces<> at = spsc_places(memory.data(), cells);
    const SpscPlaces<PlainPayloadMemory> places{.tail = at.tail, .head = at.head, .cells = at.cells};
    std::thread client([&] {
        BasicSpscProducer<PlainPayloadMemory> producer(places, cells);
        for (std::uint64_t n = 0; n < messages;) {
            Cell group[3];
            const std::uint64_t length = 1 + n % 3;
            for (std::uint64_t i = 0; i < length; ++i) group[i] = Cell::numbered(n + i);
            while (!producer.try_push(group, length)) std::this_thread::yield();
            n += length;
        }
    });
    BasicSpscConsumer<PlainPayloadMemory> consumer(places, cells);
    std::uint64_t wrong = 0;
    for (std::uint64_t n = 0; n < messages;) {
        const std::uint32_t available = consumer.available();
        if (available == 0) std::this_thread::yield();
        for (std::uint32_t i = 0; i < available; ++i) {
            Cell cell;
            if (!consumer.peek(i, &cell, 1) || !cell.is(n + i)) ++wrong;
        }
        consumer.pop(available);
        n += available;
    }
    client.join();
    EXPECT_EQ(wrong, 0u);
    EXPECT_FALSE(consumer.corrupt());
}

TEST(Threads, TripleBufferNeverSharesASlot) {
    using Batch = Record<32>;
    Memory memory(triple_bytes(sizeof(Batch)));
    triple_init(memory.data());
    const TriplePlaces<> at = triple_places(memory.data(), sizeof(Batch));
    const TriplePlaces<PlainPayloadMemory> places{
        .mid = at.mid, .slots = at.slots, .slot_words = at.slot_words, .stride_words = at.stride_words};
    std::thread client([&] {
        BasicTripleWriter<PlainPayloadMemory> writer(places);
        for (std::uint64_t n = 1; n <= messages; ++n) {
            const Batch batch = Batch::numbered(n);
            writer.publish(&batch, sizeof batch, n);
            if (n % 64 == 0) std::this_thread::yield();
        }
    });
    BasicTripleReader<PlainPayloadMemory> reader(places);
    std::uint64_t last = 0, wrong = 0;
    while (last != messages) {
        if (!reader.take(last + 1000)) {
            if (!reader.take()) std::this_thread::yield();
            if (reader.front_tag() <= last) continue;
        }
        Batch batch;
        reader.copy(&batch, 0, sizeof batch);
        if (reader.front_tag() <= last || !batch.is(reader.front_tag())) ++wrong;
        last = reader.front_tag();
    }
    client.join();
    EXPECT_EQ(wrong, 0u);
    EXPECT_FALSE(reader.corrupt());
}

TEST(Threads, ReportsAreWholeAndExactlyCountedUnderAFullSpeedWriter) {
    using Report = Record<32>;
    constexpr std::uint32_t slots = 4;  // small: the writer laps its readers all the time
    Memory memory(broadcast_bytes(slots, sizeof(Report)));
    broadcast_init(memory.data());
    std::atomic<std::uint64_t> wrong = 0;
    const auto read = [&] {
        BroadcastReader reader(memory.data(), slots, sizeof(Report), 0);
        std::uint64_t got = 0;
        while (reader.position() < messages) {
            Report report;
            if (!reader.next(&report)) {
                std::this_thread::yield();
                continue;
            }
            ++got;
            if (!report.is(reader.position() - 1) || got + reader.missed() != reader.position()) ++wrong;
        }
    };
    std::thread first(read), second(read);
    BroadcastWriter writer(memory.data(), slots, sizeof(Report));
    for (std::uint64_t n = 0; n < messages; ++n) {
        const Report report = Report::numbered(n);
        writer.publish(&report);
        if (n % 64 == 0) std::this_thread::yield();
    }
    first.join();
    second.join();
    EXPECT_EQ(wrong, 0u);
}

TEST(Threads, ManyReportsAtOnceAreWholeAndExactlyCountedByReadersThatStall) {
    using Report = Record<47>;
    constexpr std::uint32_t slots = 64;
    const std::uint64_t first_seed = test::seed();
    SCOPED_TRACE("KNURL_SEED=" + std::to_string(first_seed));
    Memory memory(broadcast_bytes(slots, sizeof(Report)));
    broadcast_init(memory.data());
    std::atomic<std::uint64_t> wrong = 0, got_any = 0;
    const auto read = [&](std::uint64_t own_seed) {
        std::mt19937_64 random(own_seed);
        BroadcastReader reader(memory.data(), slots, sizeof(Report), 0);
        std::vector<Report> reports(slots);
        std::uint64_t got = 0;
        while (reader.position() < messages) {
            const std::size_t some = reader.next_some(reinterpret_cast<std::byte*>(reports.data()),
                                                      sizeof(Report), 1 + random() % reports.size());
            got += some;
            for (std::size_t i = 0; i < some; ++i)
                if (!reports[i].is(reader.position() - some + i)) ++wrong;
            if (got + reader.missed() != reader.position()) ++wrong;
            for (std::uint64_t stall = random() % 3 == 0 ? random() % 200 : 0; stall > 0; --stall)
                std::this_thread::yield();
        }
        got_any += got;
    };
    std::thread first(read, first_seed), second(read, first_seed + 1);
    BroadcastWriter writer(memory.data(), slots, sizeof(Report));
    for (std::uint64_t n = 0; n < messages; ++n) {
        const Report report = Report::numbered(n);
        writer.publish(&report);
        if (n % 64 == 0) std::this_thread::yield();
    }
    first.join();
    second.join();
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(got_any, 0u);
}

}  // namespace
}  // namespace knurl::shm
