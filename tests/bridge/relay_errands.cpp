// Requests to the servo (to build a shape, to forget one, to grant a claim) take a round trip. The bridge's
// only thread waits for none of them, and each peer has one request at a time.

#include <atomic>
#include <functional>
#include <ostream>
#include <thread>

#include <linux/sockios.h>
#include <sys/ioctl.h>

#include <knurl/link/clock.hpp>
#include <knurl/shm/socket.hpp>

#include "../rights.hpp"
#include "peer.hpp"
#include "relay_stranger.hpp"

namespace knurl::bridge::test {
namespace {

constexpr std::size_t tiny = 40;  // bytes

/// Offers an asset, sends all of it, and cancels it.
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

/// A peer of a bridge whose rounds the test runs; the peer sees the servo's answer in the next round.
struct ByRounds : testing::Test {
    ServoUp servo_{{"--device", "one=sim:cartesian3", "--device", "two=sim:cartesian3"}};
    const std::string name = "default";
    ReportNotifier notifier;
    ServoErrands errands;
    shm::UniqueFd datagrams = bound(SOCK_DGRAM);
    OutQueue out{datagrams.get()};
    PeerContext context{.servo = name, .keys = {}, .notifier = notifier, .out = out, .errands = errands};
    std::optional<Peer> peer;
    std::optional<FrameStream> stream;  // its application
    std::uint32_t id = 0;

    void SetUp() override {
        std::array<int, 2> ends{};
        ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
        const sockaddr_in from = loopback(1);
        sockaddr_storage address{};
        std::memcpy(&address, &from, sizeof from);
        peer.emplace(shm::UniqueFd(ends[0]), address, 1, std::nullopt, detail::monotonic_ns());
        stream.emplace(shm::UniqueFd(ends[1]), false);
        send(*stream, FrameType::hello, hello());
        send(*stream, FrameType::attach, shared_claim());
        stream->pump();
        while (!peer->greeted() || peer->waits_for_servo()) ASSERT_TRUE(round());
        id = await<Attached>(*stream, FrameType::attached).stream;
    }
    void TearDown() override {
        if (peer) peer->close(context, Error::Kind::disconnected, "");
    }
    bool round() {
        const std::int64_t now = detail::monotonic_ns();
        if (!peer->waits_for_servo()) return peer->serve(context, now);
        pollfd one{.fd = errands.event(), .events = POLLIN, .revents = 0};
        while (!peer->servo_answered()) EXPECT_EQ(::poll(&one, 1, 20'000), 1);
        errands.clear_event();
        return peer->go_on(context, now);
    }
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
    } while (peer->waits_for_servo() && ++rounds < 10 * many);
    EXPECT_EQ(taken, many) << "all in their order";
    EXPECT_GE(rounds, many);
}

// The other kinds of request.
TEST_F(ByRounds, claims_are_one_in_each_too_and_what_asks_for_nothing_goes_at_once) {
    constexpr int many = 10;
    for (int i = 0; i < many; ++i) send(*stream, FrameType::attach, shared_claim());
    // Pieces of an incomplete asset cause no request to the servo.
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
        EXPECT_TRUE(peer->waits_for_servo());
        EXPECT_EQ(answers(FrameType::attached), i > 0 ? 1 : 0) << i;
    }
    ASSERT_TRUE(round());
    EXPECT_FALSE(peer->waits_for_servo());
    std::vector<std::uint16_t> types;
    stream->pump();
    while (const Frame* frame = stream->next()) types.push_back(frame->type);
    std::vector<std::uint16_t> expected(10, static_cast<std::uint16_t>(FrameType::asset_taken));
    expected.front() = static_cast<std::uint16_t>(FrameType::attached);
    EXPECT_EQ(types, expected);
}

// As above, but the servo is stopped.
TEST_F(ByRounds, no_round_waits_for_a_servo_that_stands_still) {
    servo_.stop();
    send(*stream, FrameType::attach, shared_claim());
    stream->pump();
    ASSERT_TRUE(round());
    EXPECT_TRUE(peer->waits_for_servo());
    EXPECT_FALSE(peer->servo_answered());
    servo_.go_on();
    ASSERT_TRUE(round());
    EXPECT_EQ(answers(FrameType::attached), 1);
}

TEST_F(ByRounds, a_claim_for_which_nobody_waits_any_more_is_not_kept) {
    servo_.stop();
    Attach alone;
    alone.request.capacity = {.representations = 8, .batch_bytes = 1024};
    alone.request.device = 1;
    send(*stream, FrameType::attach, alone);
    stream->pump();
    ASSERT_TRUE(round());
    ASSERT_TRUE(peer->waits_for_servo());
    ASSERT_TRUE(eventually([&] {
        int bytes = 0;
        return ::ioctl(peer->hang_up(), SIOCOUTQ, &bytes) == 0 && bytes > 0;
    })) << "the servo is asked, and has not read it";
    peer->close(context, Error::Kind::disconnected, "");
    servo_.go_on();
    Client client = Client::connect("knurl:default", {.wait = 20s});
    EXPECT_TRUE(eventually([&] {
        try {
            client.claim(client.devices()[1].name);
            return true;
        } catch (const Error&) {
            return false;
        }
    }));
}

/// A request of a real bridge's peer, while the servo is stopped.
struct Asking {
    const char* what;
    FrameType answer;  // the bridge's, when the servo does not answer
    std::function<void(FrameStream&)> before, ask;
};
void PrintTo(const Asking& asking, std::ostream* out) {
    *out << asking.what;
}
void come_in(FrameStream& stream) {
    greet(stream);
    send(stream, FrameType::attach, shared_claim());
    ASSERT_EQ(await<Attached>(stream, FrameType::attached).stream, 1u);
}
const Asking askings[] = {
    {"hello", FrameType::refused, [](FrameStream&) {},
     [](FrameStream& stream) { send(stream, FrameType::hello, hello()); }},
    {"claim", FrameType::refused, come_in,
     [](FrameStream& stream) { send(stream, FrameType::attach, shared_claim()); }},
    {"asset", FrameType::asset_refused, come_in,
     [](FrameStream& stream) { offer_and_call_off(stream, 1, 1); }},
};

struct AtAStoppedServo : testing::TestWithParam<Asking> {};

// The bridge answers a ping without the servo. Many answers must come while another peer waits. If the
// bridge itself waited, one or two could still come: just before its wait and just after.
TEST_P(AtAStoppedServo, one_peer_waits_and_the_others_do_not) {
    ServoUp servo;
    BridgeProcess bridge;
    FrameStream other(dial(bridge), false), waiting(dial(bridge), false);
    Pinger pinger(greet(other), bound(SOCK_DGRAM));
    waiting.pump();
    GetParam().before(waiting);
    servo.stop();
    GetParam().ask(waiting);
    std::uint64_t pongs = 0;
    bool refused = false;
    while (!refused && waiting.state() != FrameStream::State::closed) {
        pinger.ping(bridge.port(), pongs + 1);
        ASSERT_TRUE(pinger.answered());
        ++pongs;
        waiting.pump();
        while (const Frame* frame = waiting.next())
            refused = refused || frame->type == static_cast<std::uint16_t>(GetParam().answer);
    }
    EXPECT_TRUE(refused) << "it is told that the servo does not answer";
    EXPECT_GT(pongs, 4u);
    servo.go_on();
    EXPECT_TRUE(connect_to(bridge).connected());
}

INSTANTIATE_TEST_SUITE_P(Asked, AtAStoppedServo, testing::ValuesIn(askings),
                         [](const auto& each) { return std::string(each.param.what); });

// A process on the servo's host takes all places for half-open connections at the servo, and takes them
// again as soon as it has lost them.
TEST(Errands, of_peers_who_cannot_reach_the_servo_keep_nobody_else_waiting) {
    KNURL_NEEDS(knurl::test::missing_second_processor());
    const ServoUp servo;
    BridgeProcess bridge;
    Bystander bystander(bridge);
    std::jthread door([&](const std::stop_token& stop) {
        std::vector<shm::UniqueFd> sockets(64);  // 16 are half-open, the others wait for such a place
        while (!stop.stop_requested()) {
            for (shm::UniqueFd& socket : sockets)
                if (!stop.stop_requested() && (!socket || hung_up(socket, 0)))
                    socket = shm::connect_to(servo.socket());
        }
    });
    std::atomic<int> turned_away{0};
    std::vector<std::jthread> coming;
    for (int i = 0; i < 3; ++i)
        coming.emplace_back([&](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                try {
                    Client::connect(bridge.address(), {.name = "late", .wait = 0ms});
                } catch (const Error&) {
                    ++turned_away;
                }
            }
        });
    ASSERT_TRUE(eventually([&] { return turned_away > 0; })) << "the servo's door is crowded";
    bystander.expect_well();
    const int before = turned_away;
    ASSERT_TRUE(eventually([&] { return turned_away > before; }));
    bystander.expect_well();
}

/// Rounds. A peer whose requests were all served within one round had thousands of them done.
constexpr std::uint64_t most_meanwhile = 100;

/// Sends tiny shapes as fast as the bridge takes them, during its lifetime.
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

// The duration of an update is measured by the requests that the flood completes meanwhile: one per round,
// as above.
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
