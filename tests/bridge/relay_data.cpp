// The data channel's two ends, with a network between them that loses, doubles and reorders datagrams:
// properties that always hold. No sockets; a seed determines each run.

#include <algorithm>
#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "batch_assembly.hpp"
#include "feedback_assembly.hpp"
#include "pending_batch.hpp"
#include "seed.hpp"
#include "unanswered.hpp"

namespace knurl::bridge::relay_data_tests {
namespace {

constexpr std::uint32_t slots = 39;
constexpr std::uint32_t param_bytes = 88;
constexpr std::uint32_t geometry_bytes = 24;  // the first of them: an entry may consist of these alone
// Bytes of a batch in a datagram, without a key and with one.
constexpr std::size_t wide = 1136, narrow = 1104;
// Even with all slots pending at once, no batch needs TCP.
static_assert(sizeof(protocol::BatchHeader) + slots * (sizeof(protocol::EntryHeader) + param_bytes) <=
              max_pieces * narrow);

/// The servo's rule: newer versions win, for representations that exist. If only the geometry arrives, the
/// parameters after it stay.
struct Scene {
    std::array<std::uint64_t, slots> version{}, value{}, material{};
    std::uint64_t sequence = 0;
    void apply(std::span<const std::byte> whole) {
        protocol::BatchHeader header;
        ASSERT_TRUE(take(whole, header));
        ASSERT_EQ(header.bytes, whole.size());
        EXPECT_GT(header.sequence, sequence) << "never back, never twice";
        sequence = header.sequence;
        for (std::uint32_t i = 0; i < header.entries; ++i) {
            protocol::EntryHeader entry;
            ASSERT_TRUE(take(whole, entry));
            const std::span<const std::byte> params = whole.first(entry.bytes);
            whole = whole.subspan((entry.bytes + 7) / 8 * 8);
            const std::uint32_t slot = entry.id.slot;
            if (entry.version <= version[slot]) continue;
            version[slot] = entry.version;
            std::memcpy(&value[slot], params.data(), sizeof value[slot]);
            if (entry.bytes == param_bytes)
                std::memcpy(&material[slot], params.data() + geometry_bytes, sizeof material[slot]);
        }
        EXPECT_TRUE(whole.empty());
    }
};

struct Datagram {
    DatagramHeader header;
    BatchPiece piece;
    std::vector<std::byte> bytes;
};

std::vector<Datagram> pieces_of(const PendingBatch& batch, std::size_t most) {
    const std::span<const std::byte> message = batch.message();
    const std::size_t count = (message.size() + most - 1) / most;
    std::vector<Datagram> result;
    for (std::size_t i = 0; i < count; ++i) {
        const auto part = message.subspan(i * most, std::min(most, message.size() - i * most));
        result.push_back({.header = {.kind = DatagramKind::batch,
                                     .piece = static_cast<std::uint8_t>(i),
                                     .pieces = static_cast<std::uint8_t>(count)},
                          .piece = {.sequence = batch.sequence(),
                                    .offset = static_cast<std::uint32_t>(i * most),
                                    .total = static_cast<std::uint32_t>(message.size())},
                          .bytes = {part.begin(), part.end()}});
    }
    return result;
}

TEST(Data, after_any_losses_the_newest_of_everything_is_there) {
    const std::uint32_t seed = test::seed();
    SCOPED_TRACE(test::text_of_seed(seed));
    std::mt19937 random(seed);
    for (int trial = 0; trial < 200; ++trial) {
        PendingBatch batch({.representations = slots, .batch_bytes = slots * 128});
        BatchAssembly assembly;
        Scene servo, truth;
        std::deque<Datagram> air;
        std::deque<std::uint64_t> answers;
        const std::uint64_t loss = random() % 60;
        std::uint64_t version = 0;
        const auto fly = [&](const std::vector<Datagram>& datagrams) {
            for (const Datagram& datagram : datagrams) {
                if (random() % 100 < loss) continue;
                for (unsigned copies = random() % 10 == 0 ? 2 : 1; copies > 0; --copies) {
                    const auto at = random() % 5 == 0 && !air.empty() ? random() % air.size() : air.size();
                    air.insert(air.begin() + static_cast<std::ptrdiff_t>(at), datagram);
                }
            }
        };
        const auto land = [&] {
            if (air.empty()) return;
            const Datagram datagram = air.front();
            air.pop_front();
            const auto whole = assembly.add(datagram.header, datagram.piece, datagram.bytes);
            if (!whole.empty()) servo.apply(whole);
            if (random() % 100 >= loss) answers.push_back(servo.sequence);
        };
        const std::size_t most = random() % 2 == 0 ? wide : narrow;
        for (std::uint64_t commit = 1; commit <= 60; ++commit) {
            std::vector<std::byte> entries;
            protocol::BatchHeader header{.sequence = commit};
            for (std::uint64_t n = random() % 4; n > 0; --n) {
                const auto slot = static_cast<std::uint32_t>(random() % slots);
                const bool whole = random() % 3 == 0;
                const protocol::EntryHeader entry{.id = {.slot = slot, .generation = 1},
                                                  .kind = 1,
                                                  .bytes = whole ? param_bytes : geometry_bytes,
                                                  .version = ++version};
                std::vector<std::byte> params(entry.bytes);
                truth.value[slot] = random();
                std::memcpy(params.data(), &truth.value[slot], sizeof truth.value[slot]);
                if (whole) {
                    truth.material[slot] = random();
                    std::memcpy(params.data() + geometry_bytes, &truth.material[slot], 8);
                }
                const auto bytes = bytes_of(entry);
                entries.insert(entries.end(), bytes.begin(), bytes.end());
                entries.insert(entries.end(), params.begin(), params.end());
                ++header.entries;
            }
            header.bytes = static_cast<std::uint32_t>(entries.size());
            batch.merge(header, entries);
            ASSERT_LE(batch.message().size(), max_pieces * most);
            fly(pieces_of(batch, most));
            for (std::uint64_t n = random() % 4; n > 0; --n) land();
            for (; random() % 3 == 0 && !answers.empty(); answers.pop_front())
                batch.acknowledged(answers.front());
        }
        for (int again = 0; again < 1000 && batch.unacknowledged(); ++again) {
            fly(pieces_of(batch, most));
            while (!air.empty()) land();
            for (; !answers.empty(); answers.pop_front()) batch.acknowledged(answers.front());
        }
        ASSERT_FALSE(batch.unacknowledged());
        EXPECT_EQ(batch.entries(), 0u) << "what is acknowledged is sent no more";
        ASSERT_EQ(servo.value, truth.value) << "trial " << trial;
        ASSERT_EQ(servo.material, truth.material) << "trial " << trial;
        EXPECT_EQ(servo.sequence, 60u);
    }
}

/// A batch of that many bytes, each of which is the batch's number.
struct Sent {
    std::uint64_t sequence;
    std::vector<std::byte> bytes;
    Sent(std::uint64_t number, std::size_t size) : sequence(number), bytes(size, std::byte(number)) {}
};
/// Puts one of a batch's pieces into the assembly. Returns the batch if it is complete.
std::span<const std::byte> land(BatchAssembly& assembly, const Sent& batch, std::uint8_t piece,
                                std::uint8_t pieces) {
    const std::size_t each = (batch.bytes.size() + pieces - 1) / pieces;
    const std::size_t offset = std::min(each * piece, batch.bytes.size());
    return assembly.add({.piece = piece, .pieces = pieces},
                        {.sequence = batch.sequence,
                         .offset = static_cast<std::uint32_t>(offset),
                         .total = static_cast<std::uint32_t>(batch.bytes.size())},
                        std::span(batch.bytes).subspan(offset, std::min(each, batch.bytes.size() - offset)));
}
bool is(std::span<const std::byte> whole, const Sent& batch) {
    return std::ranges::equal(whole, batch.bytes);
}

TEST(Data, a_batch_that_was_whole_is_never_given_again_however_it_is_cut) {
    // It comes again after the path has become narrower, and must not renew the claim.
    BatchAssembly assembly;
    const Sent batch(1, 600);
    EXPECT_TRUE(is(land(assembly, batch, 0, 1), batch));
    EXPECT_TRUE(land(assembly, batch, 0, 1).empty());
    for (std::uint8_t piece = 0; piece < 2; ++piece) EXPECT_TRUE(land(assembly, batch, piece, 2).empty());
}

TEST(Data, a_batch_cut_anew_before_it_was_whole_is_the_same_batch) {
    BatchAssembly assembly;
    const Sent batch(1, 600);
    EXPECT_TRUE(land(assembly, batch, 1, 2).empty());
    EXPECT_TRUE(land(assembly, batch, 0, 3).empty());
    EXPECT_TRUE(land(assembly, batch, 1, 3).empty()) << "of three, not of two";
    EXPECT_TRUE(is(land(assembly, batch, 2, 3), batch));
}

TEST(Data, an_older_batch_between_the_pieces_of_a_newer_one_changes_nothing) {
    BatchAssembly assembly;
    const Sent older(1, 600), newer(2, 800);
    EXPECT_TRUE(land(assembly, newer, 0, 2).empty());
    EXPECT_TRUE(land(assembly, older, 1, 2).empty());
    EXPECT_TRUE(land(assembly, older, 0, 1).empty()) << "whole, and too late";
    EXPECT_TRUE(is(land(assembly, newer, 1, 2), newer));
}

TEST(Data, a_batch_with_a_hole_is_none) {
    // Pieces of a peer that lies: all have arrived, but they do not add up to the stated length.
    BatchAssembly assembly;
    const std::vector<std::byte> bytes(100);
    EXPECT_TRUE(
        assembly.add({.piece = 0, .pieces = 2}, {.sequence = 1, .offset = 0, .total = 300}, bytes).empty());
    EXPECT_TRUE(
        assembly.add({.piece = 1, .pieces = 2}, {.sequence = 1, .offset = 100, .total = 300}, bytes).empty());
}

TEST(Data, of_the_two_ways_of_a_batch_the_newer_one_counts) {
    BatchAssembly assembly;
    const Sent first(1, 600), third(3, 600), fourth(4, 600);
    EXPECT_TRUE(assembly.whole(2)) << "by TCP";
    EXPECT_FALSE(assembly.whole(2)) << "once";
    EXPECT_TRUE(land(assembly, first, 0, 1).empty()) << "a datagram that was on its way meanwhile";
    EXPECT_TRUE(is(land(assembly, third, 0, 1), third));
    EXPECT_FALSE(assembly.whole(1));
    EXPECT_FALSE(assembly.whole(3));
    EXPECT_TRUE(land(assembly, fourth, 0, 2).empty());
    EXPECT_TRUE(assembly.whole(5));
    EXPECT_TRUE(land(assembly, fourth, 1, 2).empty()) << "what was half here is too late";
}

TEST(Data, pieces_that_were_never_sent_do_no_harm) {
    std::mt19937 random(1);
    BatchAssembly assembly;
    std::vector<std::byte> bytes(datagram_bytes);
    for (int i = 0; i < 200'000; ++i) {
        for (auto& byte : bytes) byte = static_cast<std::byte>(i);
        const auto any = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random() % most); };
        const auto whole = assembly.add(
            {.piece = static_cast<std::uint8_t>(any(6)), .pieces = static_cast<std::uint8_t>(any(6))},
            {.sequence = any(8) + static_cast<std::uint64_t>(i / 100),
             .offset = any(3) == 0 ? ~0u - any(2000) : any(5000),
             .total = any(3) == 0 ? ~0u - any(2000) : any(5000)},
            std::span(bytes).first(any(datagram_bytes)));
        ASSERT_LE(whole.size(), max_pieces * datagram_bytes);
    }
}

protocol::FeedbackHeader feedback(std::uint64_t cycle, std::uint32_t entries, std::uint64_t batch = 0) {
    protocol::FeedbackHeader header;
    header.cycle = cycle;
    header.batch = batch;
    header.entries = entries;
    return header;
}

TEST(Data, what_is_felt_is_of_one_cycle_and_never_goes_back) {
    FeedbackAssembly assembly(4);
    protocol::FeedbackHeader header;
    std::vector<protocol::FeedbackEntry> entries, none;
    const auto piece = [&](std::uint64_t cycle, std::uint8_t index, double force) {
        protocol::FeedbackEntry entry;
        entry.force.x = force;
        assembly.piece({.piece = index, .pieces = 2},
                       {.feedback_cycle = cycle, .first_entry = index, .entries = 1}, bytes_of(entry));
    };
    assembly.header(feedback(10, 2), 0);
    piece(10, 0, 1);
    ASSERT_TRUE(assembly.take(0, header, entries));
    EXPECT_TRUE(entries.empty()) << "half of it is nothing";
    piece(10, 1, 1);
    ASSERT_TRUE(assembly.take(0, header, entries));
    ASSERT_EQ(entries.size(), 2u);
    EXPECT_EQ(header.cycle, 10u);
    piece(12, 1, 3);  // overtakes
    piece(11, 0, 2);
    piece(11, 1, 2);
    piece(12, 0, 3);
    ASSERT_TRUE(assembly.take(0, header, entries));
    EXPECT_EQ(header.cycle, 12u);
    for (const auto& entry : entries) EXPECT_EQ(entry.force.x, 3);
    piece(11, 0, 2);
    piece(11, 1, 2);
    EXPECT_FALSE(assembly.take(0, header, entries));
}

TEST(Data, an_acknowledgement_is_shown_after_the_answers_that_went_before_it) {
    FeedbackAssembly assembly(4);
    protocol::FeedbackHeader header;
    std::vector<protocol::FeedbackEntry> entries;
    assembly.header(feedback(10, 0, 5), 3);
    assembly.take(2, header, entries);
    EXPECT_EQ(header.batch, 0u);
    assembly.header(feedback(11, 0, 6), 4);  // a steady stream of commands
    ASSERT_TRUE(assembly.take(3, header, entries));
    EXPECT_EQ(header.batch, 5u) << "the next one waits, this one need not";
    ASSERT_TRUE(assembly.take(4, header, entries));
    EXPECT_EQ(header.batch, 6u);
}

TEST(Data, commands_keep_within_the_ring_until_their_answers_are_read) {
    Unanswered unanswered(8);
    std::array<std::byte, 2 * shm::cell_bytes> command{};
    protocol::CommandHeader header{.cells = 2, .type = protocol::CommandType::remove, .number = 1};
    const RepresentationId id{.slot = 3, .generation = 7};
    std::memcpy(command.data(), &header, sizeof header);
    std::memcpy(command.data() + sizeof header, &id, sizeof id);
    for (std::uint64_t n = 1; n <= 4; ++n) {
        header.number = n;
        std::memcpy(command.data(), &header, sizeof header);
        ASSERT_TRUE(unanswered.fits(2));
        unanswered.sent(command.data(), 2);
    }
    EXPECT_FALSE(unanswered.fits(1));
    unanswered.answered({.command = 1});
    unanswered.answered({.command = 2, .code = static_cast<std::uint32_t>(Verdict::Code::refused)});
    EXPECT_FALSE(unanswered.fits(1)) << "not read yet";
    Unanswered::Answer answer;
    ASSERT_TRUE(unanswered.next(answer));
    EXPECT_TRUE(answer.removed);
    EXPECT_EQ(answer.id, id);
    EXPECT_TRUE(unanswered.fits(2));
    ASSERT_TRUE(unanswered.next(answer));
    EXPECT_FALSE(answer.removed) << "refused";
    EXPECT_FALSE(unanswered.next(answer));
    for (int i = 0; i < 100; ++i) unanswered.answered({.command = 9});  // no such command was sent
    int taken = 0;
    while (unanswered.next(answer)) ++taken;
    EXPECT_EQ(taken, 2) << "as many as were sent";
    EXPECT_TRUE(unanswered.fits(8));
}

TEST(Data, a_removal_is_done_when_its_own_answer_says_so) {
    // Only a later command is answered: the one before it was malformed, so the servo did not execute it.
    Unanswered unanswered(8);
    std::array<std::byte, shm::cell_bytes> command{};
    for (const std::uint64_t n : {1u, 2u}) {
        const protocol::CommandHeader header{.cells = 1, .type = protocol::CommandType::remove, .number = n};
        const RepresentationId id{.slot = static_cast<std::uint32_t>(n), .generation = 1};
        std::memcpy(command.data(), &header, sizeof header);
        std::memcpy(command.data() + sizeof header, &id, sizeof id);
        unanswered.sent(command.data(), 1);
    }
    const protocol::CommandHeader arm{.cells = 1, .type = protocol::CommandType::arm, .number = 3};
    std::memcpy(command.data(), &arm, sizeof arm);
    unanswered.sent(command.data(), 1);
    Unanswered::Answer answer;
    unanswered.answered({.command = 2});
    ASSERT_TRUE(unanswered.next(answer));
    EXPECT_TRUE(answer.removed);
    EXPECT_EQ(answer.id.slot, 2u);
    unanswered.answered({.command = 3});
    ASSERT_TRUE(unanswered.next(answer));
    EXPECT_FALSE(answer.removed) << "nothing of it was a removal";
    const protocol::CommandHeader last{.cells = 1, .type = protocol::CommandType::remove, .number = 4};
    std::memcpy(command.data(), &last, sizeof last);
    unanswered.sent(command.data(), 1);
    unanswered.answered({.command = 5});
    ASSERT_TRUE(unanswered.next(answer));
    EXPECT_FALSE(answer.removed) << "an answer to none of ours";
    EXPECT_TRUE(unanswered.fits(8));
}

TEST(Data, an_acknowledgement_never_goes_back) {
    FeedbackAssembly assembly(4);
    protocol::FeedbackHeader header;
    std::vector<protocol::FeedbackEntry> entries;
    assembly.header(feedback(11, 0, 6), 0);
    assembly.header(feedback(10, 0, 5), 0);  // overtaken
    ASSERT_TRUE(assembly.take(0, header, entries));
    EXPECT_EQ(header.batch, 6u);
    assembly.header(feedback(10, 0, 5), 0);
    EXPECT_FALSE(assembly.take(0, header, entries) && header.batch != 6u);
}

}  // namespace
}  // namespace knurl::bridge::relay_data_tests
