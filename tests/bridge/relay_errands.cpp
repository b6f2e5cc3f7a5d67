// What the servo has to be asked for (a shape that has come, one that is forgotten, a claim) is a way there
// and back for which the bridge's one thread waits. Nobody gets more than one of them in a round.

#include <atomic>
#include <thread>

#include <knurl/link/clock.hpp>

#include "../rights.hpp"
#include "peer.hpp"
#include "relay_stranger.hpp"

namespace knurl::bridge::test {
namespace {

constexpr std::size_t tiny = 40;  // bytes

/// Offers one, sends all of it, and calls it off.
void offer_and_call_off(FrameStream& stream, std::uint16_t id, std::uint64_t ticket) {
    const std::array<std::byte, tiny> bytes{};
    const AssetPiece header{.ticket = ticket, .offset = 0};
    const std::array parts{bytes_of(header), std::span<const std::byte>(bytes)};
    send(stream, FrameType::asset_offer, AssetOffer{.ticket = ticket, .bytes = tiny, .number = 1}, id);
    stream.send(static_cast<std::uint16_t>(FrameType::asset_piece), id, parts);
    send(stream, FrameType::asset_cancel, AssetTicket{.ticket = ticket}, id);
}

Attach shared_claim() {
    Attach message;
    message.request.shared = 1;
    message.request.capacity = {.representations = 8, .batch_bytes = 1024};
    return message;
}

/// A peer of a bridge whose rounds are made here.
struct ByRounds : testing::Test {
    const ServoUp servo;
    const std::string name = "default";
    ReportNotifier notifier{name};
    shm::UniqueFd datagrams = bound(SOCK_DGRAM);
    OutQueue out{datagrams.get()};
    PeerContext context{.servo = name, .keys = {}, .notifier = notifier, .out = out};
    std::optional<Peer> peer;
    std::optional<FrameStream> stream;  // its application
    std::uint32_t id = 0;

    void SetUp() override {
        std::array<int, 2> ends{};
        ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
        const sockaddr_in from = loopback(1);
        sockaddr_storage address{};
        std::memcpy(&address, &from, sizeof from);
        peer.emplace(shm::UniqueFd(ends[0]), address, 1, nullptr, detail::monotonic_ns());
        stream.emplace(shm::UniqueFd(ends[1]), false);
        send(*stream, FrameType::hello, hello());
        send(*stream, FrameType::attach, shared_claim());
        stream->pump();
        while (!peer->greeted() || peer->unfinished()) ASSERT_TRUE(round());
        id = await<Attached>(*stream, FrameType::attached).stream;
    }
    void TearDown() override {
        if (peer) peer->close(context, Error::Kind::disconnected, "");
    }
    bool round() { return peer->serve(context, detail::monotonic_ns()); }
    /// How many such answers have come since the last call.
    int answers(FrameType type) {
        int count = 0;
        stream->pump();
        while (const Frame* frame = stream->next())
            count += frame->type == static_cast<std::uint16_t>(type) ? 1 : 0;
        return count;
    }
};

TEST_F(ByRounds, of_many_tiny_shapes_of_one_peer_one_is_passed_on_in_each) {
    constexpr int many = 50;
    for (std::uint64_t ticket = 1; ticket <= many; ++ticket)
        offer_and_call_off(*stream, static_cast<std::uint16_t>(id), ticket);
    stream->pump();
    ASSERT_FALSE(stream->wants_write()) << "all of it waits at the bridge";
    int taken = 0, rounds = 0;
    do {
        ASSERT_TRUE(round()) << peer->why();
        const int now = answers(FrameType::asset_taken);
        EXPECT_LE(now, 1) << "in round " << rounds;
        taken += now;
    } while (peer->unfinished() && ++rounds < 10 * many);
    EXPECT_EQ(taken, many) << "all in their order";
    EXPECT_GE(rounds, many);
}

// The other ways to ask.
TEST_F(ByRounds, claims_are_one_in_each_too_and_what_asks_for_nothing_goes_at_once) {
    constexpr int many = 10;
    for (int i = 0; i < many; ++i) send(*stream, FrameType::attach, shared_claim());
    // Pieces of one that is not complete: no question to the servo.
    send(*stream, FrameType::asset_offer, AssetOffer{.ticket = 1, .bytes = 10 * tiny, .number = 1},
         static_cast<std::uint16_t>(id));
    for (std::uint64_t i = 0; i < 9; ++i) {
        const std::array<std::byte, tiny> bytes{};
        const AssetPiece header{.ticket = 1, .offset = i * tiny};
        const std::array parts{bytes_of(header), std::span<const std::byte>(bytes)};
        stream->send(static_cast<std::uint16_t>(FrameType::asset_piece), static_cast<std::uint16_t>(id),
                     parts);
    }
    stream->pump();
    for (int i = 0; i < many; ++i) {
        ASSERT_TRUE(round());
        EXPECT_TRUE(peer->unfinished());
        EXPECT_EQ(answers(FrameType::attached), 1) << i;
    }
    ASSERT_TRUE(round());
    EXPECT_FALSE(peer->unfinished());
    EXPECT_EQ(answers(FrameType::asset_taken), 9);
}

/// Rounds; one that was served to its end in each had thousands of them done in one.
constexpr std::uint64_t most_meanwhile = 100;

/// Sends tiny shapes as fast as the bridge takes them, for as long as it lives.
class Flood {
  public:
    explicit Flood(const BridgeProcess& bridge) : stream_(dial(bridge), false) {
        greet(stream_);
        send(stream_, FrameType::attach, shared_claim());
        id_ = await<Attached>(stream_, FrameType::attached).stream;
        thread_ = std::thread([this] { run(); });
    }
    ~Flood() {
        end_ = true;
        thread_.join();
    }
    Flood(const Flood&) = delete;
    Flood& operator=(const Flood&) = delete;
    std::uint64_t taken() const { return taken_; }

  private:
    void run() {
        while (!end_ && stream_.state() == FrameStream::State::open) {
            while (stream_.queued() < 64 * 1024)
                offer_and_call_off(stream_, static_cast<std::uint16_t>(id_), ++ticket_);
            pollfd one{.fd = stream_.fd(), .events = POLLIN | POLLOUT, .revents = 0};
            ::poll(&one, 1, 100);
            stream_.pump();
            while (const Frame* frame = stream_.next())
                taken_ += frame->type == static_cast<std::uint16_t>(FrameType::asset_taken) ? 1 : 0;
        }
    }
    FrameStream stream_;
    std::uint32_t id_ = 0;
    std::uint64_t ticket_ = 0;
    std::atomic<std::uint64_t> taken_{0};
    std::atomic<bool> end_{false};
    std::thread thread_;
};

// How long an update takes is counted in what the flood got done meanwhile: one in each round, as above.
TEST(Errands, two_that_flood_the_bridge_with_tiny_shapes_keep_nobody_waiting) {
    KNURL_NEEDS(knurl::test::missing_second_processor());
    const ServoUp servo;
    BridgeProcess bridge;
    Client client = connect_to(bridge);
    Claim hand = client.claim("", {.shared = true});
    auto force = hand.add(at_once({}));
    Flood one(bridge), other(bridge);
    ASSERT_TRUE(eventually([&] { return one.taken() > 10 && other.taken() > 10; }));
    const std::uint64_t before[] = {one.taken(), other.taken()};
    std::vector<std::uint64_t> meanwhile;
    for (int i = 1; i <= 21; ++i) {
        ASSERT_TRUE(hand.next_report(10s));
        const std::uint64_t then = one.taken();
        force.set(at_once({1e-3 * i, 0, 0}));
        ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
        meanwhile.push_back(one.taken() - then);
    }
    std::ranges::sort(meanwhile);
    EXPECT_LE(meanwhile[10], most_meanwhile) << "the median";
    EXPECT_EQ(hand.reattachments(), 0u);
    EXPECT_TRUE(eventually([&] { return one.taken() > before[0] + 10 && other.taken() > before[1] + 10; }))
        << "they get their turns, too";
}

}  // namespace
}  // namespace knurl::bridge::test
