// What a peer sends to the servo: the order in which it arrives, and what ends the peer.

#include "net_stream.hpp"

namespace knurl::bridge::test {
namespace {

/// Commands of one cell each, with these numbers, one group.
std::vector<std::byte> group(std::initializer_list<std::uint64_t> numbers) {
    std::vector<std::byte> cells(numbers.size() * shm::cell_bytes);
    std::byte* at = cells.data();
    for (const std::uint64_t number : numbers) {
        const protocol::CommandHeader header{
            .cells = 1,
            .type = protocol::CommandType::arm,
            .number = number,
            .flags = number == *(numbers.end() - 1) ? 0u : protocol::command_flags::more};
        std::memcpy(at, &header, sizeof header);
        at += shm::cell_bytes;
    }
    return cells;
}

std::vector<protocol::CommandHeader> headers_of(const std::vector<std::vector<std::byte>>& groups) {
    std::vector<protocol::CommandHeader> headers;
    for (const auto& cells : groups)
        for (std::size_t at = 0; at < cells.size(); at += shm::cell_bytes)
            std::memcpy(&headers.emplace_back(), cells.data() + at, sizeof(protocol::CommandHeader));
    return headers;
}
std::vector<std::uint64_t> numbers_of(const std::vector<std::vector<std::byte>>& groups) {
    std::vector<std::uint64_t> numbers;
    for (const protocol::CommandHeader& header : headers_of(groups)) numbers.push_back(header.number);
    return numbers;
}

TEST_F(Stream, CommandsThatFindNoRoomWaitAndKeepTheirOrder) {
    PeerStream stream(stream_id, attachment(), 0);
    const auto came = [&] { return numbers_of(servo.groups); };
    servo.room = 0;
    ASSERT_TRUE(stream.commands(group({1, 2}), Role::control, why)) << why;
    EXPECT_TRUE(servo.groups.empty());
    servo.room = 1;
    ASSERT_TRUE(stream.commands(group({3}), Role::control, why)) << why;
    EXPECT_TRUE(servo.groups.empty()) << "the later group would fit, and does not overtake";
    servo.room = 4;
    ASSERT_TRUE(stream.commands(group({4}), Role::control, why)) << why;
    EXPECT_EQ(came(), (std::vector<std::uint64_t>{1, 2, 3, 4}));
    EXPECT_EQ(servo.groups.size(), 3u) << "each group whole";
    ASSERT_TRUE(stream.commands(group({5}), Role::control, why)) << why;
    ASSERT_TRUE(cycle(stream, 0));
    EXPECT_EQ(came().size(), 4u);
    servo.room = 1;
    ASSERT_TRUE(cycle(stream, 1)) << "which has made room";
    EXPECT_EQ(came(), (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
}

TEST_F(Stream, MoreCommandsThanTheRingHoldsEndThePeer) {
    PeerStream stream(stream_id, attachment(), 0);
    servo.room = 0;
    for (std::uint64_t n = 1; n <= ring_cells; ++n)
        ASSERT_TRUE(stream.commands(group({n}), Role::control, why)) << n << ": " << why;
    EXPECT_FALSE(stream.commands(group({ring_cells + 1}), Role::control, why));
    EXPECT_STREQ(why, "more commands than it has room for");
}

TEST_F(Stream, CommandsThatAreNoWholeGroupEndThePeer) {
    PeerStream stream(stream_id, attachment(), 0);
    const auto refused = [&](const std::vector<std::byte>& cells) {
        why = "";
        return !stream.commands(cells, Role::control, why) &&
               std::string(why) == "commands that are not whole groups of messages";
    };
    const auto with = [](std::uint32_t cells, std::uint32_t more) {
        std::vector<std::byte> one = group({1});
        const protocol::CommandHeader header{.cells = cells, .flags = more};
        std::memcpy(one.data(), &header, sizeof header);
        return one;
    };
    std::vector<std::byte> cut = group({1, 2});
    EXPECT_TRUE(refused(with(1, 1))) << "its group goes on, and there is no more";
    EXPECT_TRUE(refused(with(0, 0))) << "of no cells";
    EXPECT_TRUE(refused(with(2, 0))) << "longer than what came";
    EXPECT_TRUE(refused(with(1, protocol::command_flags::restricted))) << "marked by the peer itself";
    EXPECT_TRUE(refused({}));
    cut.resize(cut.size() - 8);
    EXPECT_TRUE(refused(cut)) << "half a cell";
    EXPECT_TRUE(servo.groups.empty());
}

TEST_F(Stream, EachCommandOfARenderingPeerIsMarkedAndNoneOfAControllingOne) {
    PeerStream stream(stream_id, attachment(), 0);
    ASSERT_TRUE(stream.commands(group({1, 2, 3}), Role::render, why)) << why;
    for (const protocol::CommandHeader& header : headers_of(servo.groups)) {
        EXPECT_NE(header.flags & protocol::command_flags::restricted, 0u) << header.number;
        EXPECT_EQ(header.flags & 1u, header.number < 3 ? 1u : 0u) << "the group is the same";
    }
    servo.groups.clear();
    ASSERT_TRUE(stream.commands(group({4}), Role::control, why)) << why;
    EXPECT_EQ(headers_of(servo.groups).at(0).flags, 0u);
}

TEST_F(Stream, ABatchThatDoesNotFitItsClaimReachesNobody) {
    PeerStream stream(stream_id, attachment(), 0);
    const auto batch = [](std::uint64_t sequence, std::size_t bytes, std::size_t says) {
        const protocol::BatchHeader header{.sequence = sequence, .bytes = static_cast<std::uint32_t>(says)};
        std::vector<std::byte> whole(sizeof header + bytes);
        std::memcpy(whole.data(), &header, sizeof header);
        return whole;
    };
    const auto by_datagram = [&](std::uint64_t sequence, const std::vector<std::byte>& whole) {
        std::vector<std::byte> body(sizeof(BatchPiece) + whole.size());
        const BatchPiece piece{.sequence = sequence, .total = static_cast<std::uint32_t>(whole.size())};
        std::memcpy(body.data(), &piece, sizeof piece);
        std::memcpy(body.data() + sizeof piece, whole.data(), whole.size());
        stream.batch_piece({.kind = DatagramKind::batch, .pieces = 1}, body);
    };
    EXPECT_TRUE(stream.batch(batch(1, 64, 64), why)) << why;
    EXPECT_FALSE(stream.batch(batch(2, 64, 72), why)) << "shorter than it says";
    EXPECT_FALSE(stream.batch(batch(2, batch_capacity + 8, batch_capacity + 8), why))
        << "larger than the claim's";
    EXPECT_FALSE(stream.batch(std::vector<std::byte>(8), why)) << "no header";
    EXPECT_EQ(servo.batches, (std::vector<std::uint64_t>{1}));
    by_datagram(3, batch(3, 64, 64));
    by_datagram(4, batch(4, 64, 72));
    by_datagram(5, batch(5, 60, 60));  // the servo counts in multiples of eight
    by_datagram(6, batch(6, batch_capacity + 8, batch_capacity + 8));
    EXPECT_EQ(servo.batches, (std::vector<std::uint64_t>{1, 3}));
    EXPECT_TRUE(stream.batch(batch(2, 64, 64), why)) << "late, which is nobody's fault";
    by_datagram(1, batch(1, 64, 64));
    EXPECT_EQ(servo.batches, (std::vector<std::uint64_t>{1, 3})) << "and older than what is there";
}

TEST_F(Stream, AnObserverHasNoChannels) {
    PeerStream stream(stream_id, detail::Attachment{}, 0);
    EXPECT_FALSE(stream.commands(group({1}), Role::control, why));
    EXPECT_STREQ(why, "commands of an observer");
    EXPECT_FALSE(stream.batch(std::vector<std::byte>(sizeof(protocol::BatchHeader)), why));
    bind(stream);
    ASSERT_TRUE(cycle(stream, 0));
    const auto all = datagrams();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_TRUE(all[0].report);
    EXPECT_FALSE(all[0].feedback);
}

}  // namespace
}  // namespace knurl::bridge::test
