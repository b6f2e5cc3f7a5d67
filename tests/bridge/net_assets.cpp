// Assets in transfer, each end alone: how much data may be under way, and what the bridge does with the
// pieces that arrive.

#include <cstring>
#include <deque>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/link/error.hpp>
#include <knurl/shm/segment.hpp>

#include "asset_receiver.hpp"
#include "congestion_window.hpp"

namespace knurl::bridge {
namespace {

// ------------------------------------------------------------------------------------------- the window

/// A link with a queue in front, simulated in its own time.
struct Path {
    double rate = 0;             // bytes/s
    std::int64_t round_trip_ns;  // without the queue
};

struct Course {
    std::int64_t longest_queue_ns = 0;  // delay for a command in the queue
    double used = 0;                    // share of the link's capacity
};

Course send(CongestionWindow& window, const Path& path, std::size_t pieces) {
    struct Flight {
        std::int64_t sent_ns, taken_ns;
    };
    Course course;
    std::deque<Flight> flights;
    std::int64_t now = 0, free_at = 0;
    const auto piece_ns = static_cast<std::int64_t>(static_cast<double>(asset_piece_bytes) / path.rate * 1e9);
    for (std::size_t sent = 0; sent < pieces || !flights.empty();) {
        if (sent < pieces && window.has_room(flights.size() * asset_piece_bytes)) {
            free_at = std::max(free_at, now) + piece_ns;
            course.longest_queue_ns = std::max(course.longest_queue_ns, free_at - now);
            flights.push_back({now, free_at + path.round_trip_ns});
            ++sent;
            continue;
        }
        now = flights.front().taken_ns;
        window.taken(asset_piece_bytes, now - flights.front().sent_ns);
        flights.pop_front();
    }
    course.used = static_cast<double>(pieces) * static_cast<double>(piece_ns) / static_cast<double>(now);
    return course;
}

constexpr std::int64_t ms = 1'000'000;

TEST(CongestionWindow, fills_a_link_without_a_queue_before_it) {
    struct {
        Path path;
        double used;
    } const paths[] = {{{.rate = 1.25e6, .round_trip_ns = 1 * ms}, 0.9},
                       {{.rate = 1.25e6, .round_trip_ns = 40 * ms}, 0.9},
                       {{.rate = 12.5e6, .round_trip_ns = 10 * ms}, 0.9},
                       {{.rate = 125e6, .round_trip_ns = ms / 2}, 0.9}};
    for (const auto& [path, used] : paths) {
        CongestionWindow window;
        const Course course = send(window, path, 4000);
        const double piece_ns = static_cast<double>(asset_piece_bytes) / path.rate * 1e9;
        EXPECT_LE(static_cast<double>(course.longest_queue_ns), CongestionWindow::target_ns + 2.5 * piece_ns)
            << path.rate;
        EXPECT_GE(course.used, used) << path.rate << " bytes/s, " << path.round_trip_ns << " ns";
    }
}

TEST(CongestionWindow, gives_way_to_others_and_comes_to_terms_with_a_longer_path) {
    CongestionWindow window;
    send(window, {.rate = 12.5e6, .round_trip_ns = 10 * ms}, 2000);
    EXPECT_TRUE(window.has_room(10 * asset_piece_bytes));
    for (int i = 0; i < 200 && window.has_room(asset_piece_bytes); ++i)
        window.taken(asset_piece_bytes, 60 * ms);
    EXPECT_FALSE(window.has_room(asset_piece_bytes)) << "the queue is somebody else's";
    EXPECT_TRUE(window.has_room(0)) << "it goes on all the same";
    const Course longer = send(window, {.rate = 12.5e6, .round_trip_ns = 70 * ms}, 4000);
    EXPECT_GE(longer.used, 0.2) << "most of the 256 KiB per round trip";
}

// ------------------------------------------------------------------------------------------- the receiver

struct Offered {
    std::uint32_t number = 0;
    std::vector<std::byte> bytes;
};

struct FakeTransfer final : detail::AssetTransfer {
    shm::UniqueFd read, write;
    std::string refusal;
    std::uint64_t size = 1000;
    bool* ended;
    explicit FakeTransfer(bool* flag) : ended(flag) {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) == 0) {
            read = shm::UniqueFd(ends[0]);
            write = shm::UniqueFd(ends[1]);
        }
    }
    ~FakeTransfer() override { *ended = true; }
    int event() const override { return read.get(); }
    std::optional<protocol::AssetReady> answer(std::chrono::nanoseconds) override {
        if (!refusal.empty()) throw Error(Error::Kind::bad_parameters, refusal);
        protocol::AssetReady ready;
        ready.bytes = size;
        return ready;
    }
    void done() const { EXPECT_EQ(::write(write.get(), "x", 1), 1); }
};

struct FakeDoor final : detail::AssetDoor {
    std::vector<Offered> offered;
    std::vector<std::uint32_t> forgotten;
    FakeTransfer* last = nullptr;
    bool ended = false;

    std::unique_ptr<detail::AssetTransfer> offer(std::uint32_t number, const shm::UniqueFd& source,
                                                 std::uint64_t bytes) override {
        const shm::Segment memory = shm::Segment::open_sealed(source.get(), bytes);
        offered.push_back({number, {memory.data(), memory.data() + memory.size()}});
        ended = false;
        auto transfer = std::make_unique<FakeTransfer>(&ended);
        last = transfer.get();
        return transfer;
    }
    void forget(std::uint32_t number) override { forgotten.push_back(number); }
};

struct AssetReceiving : testing::Test {
    AssetReceiving() {
        int ends[2];
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
        frames.emplace(shm::UniqueFd(ends[0]), true);
        peer.emplace(shm::UniqueFd(ends[1]), false);
        frames->pump();
        peer->pump();
        receiver.emplace(*frames, awaited);
    }
    bool offer(std::uint64_t ticket, std::uint32_t number, std::uint64_t bytes, std::uint32_t stream = 1) {
        return receiver->offer(stream, door,
                               bytes_of(AssetOffer{.ticket = ticket, .bytes = bytes, .number = number}),
                               why) &&
               after_servo();
    }
    bool piece(std::uint64_t ticket, std::uint64_t offset, std::span<const std::byte> bytes) {
        std::vector<std::byte> frame(sizeof(AssetPiece) + bytes.size());
        const AssetPiece header{.ticket = ticket, .offset = offset};
        std::memcpy(frame.data(), &header, sizeof header);
        if (!bytes.empty()) std::memcpy(frame.data() + sizeof header, bytes.data(), bytes.size());
        return receiver->piece(frame, why) && after_servo();
    }
    bool forget(std::uint32_t number) {
        return receiver->forget(1, bytes_of(AssetForget{.number = number}), why) && after_servo();
    }
    bool cancel(std::uint64_t ticket) {
        return receiver->cancel(bytes_of(AssetTicket{.ticket = ticket}), why) && after_servo();
    }
    /// The servo answers every request at once.
    bool after_servo() {
        while (awaited.waits()) {
            awaited.errand()->run();
            if (!awaited.go_on()) return false;
        }
        return true;
    }
    /// The peer's next message: the refusal, "taken", "ready"; empty: none.
    std::string told() {
        peer->pump();
        const Frame* const frame = peer->next();
        if (frame == nullptr) return "";
        std::span<const std::byte> payload = frame->payload;
        AssetRefused refused;
        switch (static_cast<FrameType>(frame->type)) {
            case FrameType::asset_refused:
                EXPECT_TRUE(take(payload, refused));
                return text_of(refused.refused.text);
            case FrameType::asset_taken:
                return "taken";
            case FrameType::asset_ready:
                return "ready";
            default:
                return "no sense";
        }
    }
    /// The whole asset, and its final answer.
    std::string deliver(std::uint64_t ticket, std::uint32_t number, const std::vector<std::byte>& bytes) {
        EXPECT_TRUE(offer(ticket, number, bytes.size())) << why;
        for (std::size_t at = 0; at < bytes.size(); at += asset_piece_bytes) {
            EXPECT_TRUE(piece(ticket, at,
                              std::span(bytes).subspan(at, std::min(asset_piece_bytes, bytes.size() - at))));
            EXPECT_EQ(told(), "taken");
        }
        door->last->done();
        EXPECT_TRUE(receiver->answers(why));
        return told();
    }

    std::optional<FrameStream> frames, peer;
    Awaited awaited;
    std::optional<AssetReceiver> receiver;
    std::shared_ptr<FakeDoor> door = std::make_shared<FakeDoor>();
    std::string why;
    const std::vector<std::byte> some = std::vector<std::byte>(100, std::byte{7});
};

TEST_F(AssetReceiving, what_came_in_pieces_is_offered_whole_and_sealed) {
    std::vector<std::byte> bytes(3 * asset_piece_bytes + 5);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 >> 3);
    EXPECT_EQ(receiver->event(), -1);
    EXPECT_EQ(deliver(1, 9, bytes), "ready");
    ASSERT_EQ(door->offered.size(), 1u);
    EXPECT_EQ(door->offered[0].number, 9u);
    EXPECT_EQ(door->offered[0].bytes, bytes);
    EXPECT_TRUE(door->ended);
    EXPECT_TRUE(forget(9));
    EXPECT_EQ(door->forgotten, std::vector<std::uint32_t>{9});
    EXPECT_EQ(deliver(2, 9, bytes), "ready");
}

TEST_F(AssetReceiving, what_the_claim_may_not_have_is_refused_before_a_byte_of_it_is_taken) {
    ASSERT_EQ(deliver(1, 1, some), "ready");
    ASSERT_TRUE(offer(2, 2, 1000));
    const struct {
        std::uint32_t number;
        std::uint64_t bytes;
        const char* why;
    } refused[] = {{0, 100, "number 0"},
                   {max_assets + 1, 100, "number 65"},
                   {1, 100, "taken"},
                   {2, 100, "being built"},
                   {3, 0, "0 bytes"},
                   {3, protocol::max_asset_bytes + 1, "a claim may hold"},
                   {3, std::uint64_t{1} << 63, "a claim may hold"},
                   {3, protocol::max_asset_bytes - 999, "1000 on their way"}};
    std::uint64_t ticket = 2;
    for (const auto& each : refused) {
        EXPECT_TRUE(offer(++ticket, each.number, each.bytes)) << "the connection is not to blame";
        EXPECT_NE(told().find(each.why), std::string::npos) << each.why;
        EXPECT_TRUE(piece(ticket, 0, some)) << "it was on its way already";
        EXPECT_EQ(told(), "taken");
    }
    for (std::uint32_t number = 3; number <= 5; ++number) EXPECT_TRUE(offer(++ticket, number, 100));
    EXPECT_EQ(told(), "");
    EXPECT_TRUE(offer(++ticket, 6, 100));
    EXPECT_NE(told().find("4 are on their way"), std::string::npos);
    EXPECT_EQ(door->offered.size(), 1u);
    door->last = nullptr;
    // Another claim of the same connection has its own numbers and its own limit.
    receiver->drop(1);
    EXPECT_TRUE(offer(++ticket, 1, protocol::max_asset_bytes, 2));
    EXPECT_EQ(told(), "");
}

TEST_F(AssetReceiving, what_makes_no_sense_ends_the_connection) {
    const auto fresh = [&] {
        receiver.emplace(*frames, awaited);
        EXPECT_TRUE(offer(5, 1, 100));
        why.clear();
    };
    const auto ends = [&](const char* what, bool went_on) {
        EXPECT_FALSE(went_on) << what;
        EXPECT_NE(why, "") << what;
        fresh();
    };
    fresh();
    ends("a ticket of before", offer(5, 2, 100));
    ends("half an offer", receiver->offer(1, door, some, why));
    ends("an observer's",
         receiver->offer(1, nullptr, bytes_of(AssetOffer{.ticket = 9, .bytes = 9, .number = 2}), why));
    ends("of an offer that is still to come", piece(6, 0, some));
    ends("not where the last one ended", piece(5, 1, some));
    ends("beyond the end", piece(5, 0, std::vector<std::byte>(101)));
    ends("of nothing", piece(5, 0, {}));
    ends("a long one", piece(5, 0, std::vector<std::byte>(asset_piece_bytes + 1)));
    ends("half a piece", receiver->piece(std::span(some).first(15), why));
    ends("one more than all", piece(5, 0, some) && piece(5, 100, some));
    ends("calling off what never was", cancel(6));
    ends("forgetting what it does not have", forget(1));
    ends("half a word", receiver->forget(1, std::span(some).first(7), why));
}

TEST_F(AssetReceiving, what_is_called_off_is_called_off_at_the_servo) {
    ASSERT_TRUE(offer(1, 1, 100));
    EXPECT_TRUE(cancel(1));
    EXPECT_TRUE(piece(1, 0, some)) << "it was on its way already";
    EXPECT_EQ(told(), "taken");
    EXPECT_TRUE(door->offered.empty());
    ASSERT_TRUE(offer(2, 1, 100) && piece(2, 0, some)) << "its number is free";
    EXPECT_EQ(told(), "taken");
    EXPECT_FALSE(door->ended);
    EXPECT_TRUE(cancel(2));
    EXPECT_TRUE(door->ended);
    // The asset is already ready, but its owner has not received the answer.
    ASSERT_EQ(deliver(3, 1, some), "ready");
    EXPECT_TRUE(cancel(3));
    EXPECT_EQ(door->forgotten, std::vector<std::uint32_t>{1});
    ASSERT_TRUE(offer(4, 1, 100) && piece(4, 0, some));
    receiver->drop(1);
    EXPECT_TRUE(door->ended);
}

TEST_F(AssetReceiving, what_the_servo_refuses_its_sender_is_told) {
    ASSERT_TRUE(offer(1, 1, 100) && piece(1, 0, some));
    EXPECT_EQ(told(), "taken");
    door->last->refusal = "asset: triangle 17";
    door->last->done();
    EXPECT_TRUE(receiver->answers(why));
    EXPECT_EQ(told(), "asset: triangle 17");
    EXPECT_EQ(deliver(2, 1, some), "ready") << "the number is free";
}

}  // namespace
}  // namespace knurl::bridge
