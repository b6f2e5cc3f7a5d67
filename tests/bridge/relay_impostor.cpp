// A bridge that lies: whatever it answers, the application gets one clear line, at once.

#include <functional>
#include <limits>
#include <thread>

#include <sys/eventfd.h>

#include "relay_stranger.hpp"

namespace knurl::bridge::test::impostor_tests {
namespace {

using Bytes = std::vector<std::byte>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

template <class T>
Bytes raw(const T& value) {
    const auto bytes = bytes_of(value);
    return {bytes.begin(), bytes.end()};
}

/// A frame of any payload; `bytes`: the length that it states.
Bytes framed(FrameType type, std::uint16_t stream, const Bytes& payload, std::uint32_t bytes) {
    return raw(FrameHeader{.bytes = bytes, .type = static_cast<std::uint16_t>(type), .stream = stream}) +
           payload;
}
Bytes framed(FrameType type, std::uint16_t stream, const Bytes& payload) {
    return framed(type, stream, payload, static_cast<std::uint32_t>(payload.size()));
}

/// Accepts callers at a free port, gives the n-th frame of a caller the n-th answer, and disconnects when no
/// answer is left. Datagrams get valid answers.
class Impostor {
  public:
    explicit Impostor(std::vector<Bytes> answers) : answers_(std::move(answers)) {
        EXPECT_EQ(::listen(listener_.get(), 8), 0);
        thread_ = std::thread([this] { run(); });
    }
    ~Impostor() {
        const std::uint64_t one = 1;
        [[maybe_unused]] const ssize_t written = ::write(stop_.get(), &one, sizeof one);
        thread_.join();
    }
    Impostor(const Impostor&) = delete;
    Impostor& operator=(const Impostor&) = delete;

    std::string address() const { return "knurl://127.0.0.1:" + std::to_string(port_of(listener_)); }

  private:
    /// Waits until `fd` is readable, and answers datagrams meanwhile. False: stop.
    bool await(int fd) {
        for (;;) {
            pollfd sources[] = {{.fd = stop_.get(), .events = POLLIN, .revents = 0},
                                {.fd = datagrams_.get(), .events = POLLIN, .revents = 0},
                                {.fd = fd, .events = POLLIN, .revents = 0}};
            ::poll(sources, 3, -1);
            if (sources[0].revents != 0) return false;
            if (sources[1].revents != 0) echo();
            if (sources[2].revents != 0) return true;
        }
    }

    void echo() {
        Bytes bytes(2000);
        sockaddr_in from{};
        socklen_t length = sizeof from;
        const ssize_t got = ::recvfrom(datagrams_.get(), bytes.data(), bytes.size(), 0,
                                       reinterpret_cast<sockaddr*>(&from), &length);
        DatagramHeader header;
        std::memcpy(&header, bytes.data(), sizeof header);
        if (got < static_cast<ssize_t>(sizeof header + sizeof(PongBody)) || header.kind != DatagramKind::ping)
            return;
        header.kind = DatagramKind::pong;
        header.counter = ++sent_;
        std::memcpy(bytes.data(), &header, sizeof header);
        ::sendto(datagrams_.get(), bytes.data(), static_cast<std::size_t>(got), 0,
                 reinterpret_cast<const sockaddr*>(&from), length);
    }

    void run() {
        while (await(listener_.get())) {
            FrameStream stream(
                shm::UniqueFd(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)),
                true);
            std::size_t heard = 0;
            sent_ = 0;
            while (stream.state() != FrameStream::State::closed) {
                if (!await(stream.fd())) return;
                stream.pump();
                while (stream.next() != nullptr) {
                    if (heard == answers_.size()) stream.close();
                    if (heard >= answers_.size()) break;
                    const Bytes& answer = answers_[heard++];
                    ::send(stream.fd(), answer.data(), answer.size(), MSG_NOSIGNAL);
                    if (heard == answers_.size()) ::shutdown(stream.fd(), SHUT_WR);
                }
            }
        }
    }

    const std::vector<Bytes> answers_;
    const shm::UniqueFd listener_ = bound(SOCK_STREAM), datagrams_ = bound(SOCK_DGRAM, port_of(listener_)),
                        stop_{::eventfd(0, EFD_CLOEXEC)};
    std::uint64_t sent_ = 0;
    std::thread thread_;
};

DeviceRow row() {
    DeviceRow row;
    put_text(row.name, "hand");
    row.rate = 1000;
    return row;
}
Bytes welcome(std::uint32_t devices, const Bytes& rows) {
    return framed(FrameType::welcome, 0, raw(Welcome{.session = 7, .devices = devices}) + rows);
}
template <class Change>
Bytes welcome_with(Change change) {
    DeviceRow changed = row();
    change(changed);
    return welcome(1, raw(changed));
}
const Bytes good_welcome = welcome(1, raw(row()));

Attached granted() {
    Attached attached;
    attached.stream = 1;
    attached.terms.capacity = {};  // the request of a claim without options
    return attached;
}
template <class Change>
Bytes attached_with(Change change) {
    Attached attached = granted();
    change(attached);
    return framed(FrameType::attached, 0, raw(attached));
}
const Bytes good_attached = framed(FrameType::attached, 0, raw(granted()));

Client connect_to(const Impostor& bridge) {
    return Client::connect(bridge.address(), {.name = "test", .wait = 0ms, .reattach = false});
}

struct Lie {
    const char* what;
    Bytes answer;
    Error::Kind kind;
    const char* says;
};
constexpr auto incompatible = Error::Kind::incompatible, disconnected = Error::Kind::disconnected,
               refused = Error::Kind::refused;

void expect_refused(const Lie& lie, const std::function<void()>& call) {
    const Error error = refusal(call);
    EXPECT_EQ(error.kind, lie.kind) << error.what();
    says(error.what(), lie.says);
    for (const char c : std::string(error.what())) EXPECT_TRUE(c >= ' ' && c <= '~') << error.what();
    // The client has understood the answer, and not given up waiting.
    EXPECT_EQ(std::string(error.what()).find("not answer"), std::string::npos) << error.what();
}

TEST(Impostor, what_it_says_of_itself_and_its_devices) {
    Refused shouting{.kind = 0xffffffff, .holder_pid = 0xffffffff};
    std::memset(shouting.text, 0x1b, sizeof shouting.text);
    const Refused mute;
    const char* const no_bridge = "is no knurl-bridge of this version";
    const std::vector<Lie> lies{
        {"nothing", {}, disconnected, "hung up"},
        {"half a frame", framed(FrameType::welcome, 0, {}, 344), disconnected, "in the middle of a frame"},
        {"no length", framed(FrameType::welcome, 0, {}, 0), incompatible, no_bridge},
        {"longer than memory", framed(FrameType::welcome, 0, {}, 0xffffffff), incompatible, no_bridge},
        {"half a welcome", framed(FrameType::welcome, 0, raw(Nothing{})), incompatible, no_bridge},
        {"no type of ours", framed(static_cast<FrameType>(999), 0, raw(row())), incompatible, no_bridge},
        {"an answer to another question", good_attached, incompatible, no_bridge},
        {"more devices than memory", welcome(0xffffffff, raw(row())), incompatible, no_bridge},
        {"more devices than it tells of", welcome(2, raw(row())), incompatible, no_bridge},
        {"fewer", welcome(1, raw(row()) + raw(row())), incompatible, no_bridge},
        {"half a device", welcome(1, raw(Nothing{})), incompatible, no_bridge},
        {"no rate", welcome_with([](DeviceRow& d) { d.rate = nan; }), incompatible, no_bridge},
        {"backwards", welcome_with([](DeviceRow& d) { d.rate = -1; }), incompatible, no_bridge},
        {"nowhere", welcome_with([](DeviceRow& d) { d.workspace_centre.y = nan; }), incompatible, no_bridge},
        {"no size", welcome_with([](DeviceRow& d) { d.workspace_radius = nan; }), incompatible, no_bridge},
        {"no force", welcome_with([](DeviceRow& d) { d.peak_force = nan; }), incompatible, no_bridge},
        {"no torque", welcome_with([](DeviceRow& d) { d.peak_torque = nan; }), incompatible, no_bridge},
        {"soft", welcome_with([](DeviceRow& d) { d.max_stiffness = nan; }), incompatible, no_bridge},
        {"no name", welcome_with([](DeviceRow& d) { d.name[0] = 0; }), incompatible, no_bridge},
        {"a name for a terminal", welcome_with([](DeviceRow& d) { d.name[0] = '\n'; }), incompatible,
         no_bridge},
        {"a name without an end", welcome_with([](DeviceRow& d) { std::memset(d.name, 'a', sizeof d.name); }),
         incompatible, no_bridge},
        {"half a refusal", framed(FrameType::refused, 0, raw(Nothing{})), incompatible, no_bridge},
        {"a refusal without an end", framed(FrameType::refused, 0, raw(shouting)), Error::Kind::exhausted,
         "????"},
        {"a refusal without a word", framed(FrameType::refused, 0, raw(mute)), Error::Kind::no_servo,
         "without a reason"},
    };
    for (const Lie& lie : lies) {
        SCOPED_TRACE(lie.what);
        const Impostor bridge({lie.answer});
        expect_refused(lie, [&] { connect_to(bridge); });
    }
}

TEST(Impostor, what_it_answers_to_a_claim) {
    const char* const nonsense = "not those of a knurl-bridge of this version";
    const char* const no_bridge = "is no knurl-bridge of this version";
    const Bytes ask_more = framed(FrameType::refused, 0, raw(Refused{.kind = 4, .holder_pid = 1}));
    const auto terms = [](auto change) { return attached_with([&](Attached& a) { change(a.terms); }); };
    using Terms = protocol::Claimed;
    const std::vector<Lie> lies{
        {"nothing", {}, disconnected, "hung up"},
        {"half a frame", framed(FrameType::attached, 0, {}, 300), disconnected, "in the middle of a frame"},
        {"half an answer", framed(FrameType::attached, 0, raw(Nothing{})), disconnected, nonsense},
        {"half a refusal", framed(FrameType::refused, 0, raw(Nothing{})), disconnected, nonsense},
        {"longer than memory", framed(FrameType::attached, 0, {}, 0xffffffff), disconnected,
         "longer than is allowed"},
        {"an answer to another question", good_welcome, disconnected, nonsense},
        {"no type of ours", framed(static_cast<FrameType>(999), 0, raw(Nothing{})), disconnected, nonsense},
        {"of another device", attached_with([](Attached& a) { a.device = 1; }), incompatible, no_bridge},
        {"of stream 0", attached_with([](Attached& a) { a.stream = 0; }), incompatible, no_bridge},
        {"of stream 17", attached_with([](Attached& a) { a.stream = 17; }), incompatible, no_bridge},
        {"of too many", terms([](Terms& t) { t.capacity.representations = 0xffffffff; }), incompatible,
         no_bridge},
        {"of none", terms([](Terms& t) { t.capacity.representations = 0; }), incompatible, no_bridge},
        {"of large batches", terms([](Terms& t) { t.capacity.batch_bytes = 0xffffffff; }), incompatible,
         no_bridge},
        {"without a scale", terms([](Terms& t) { t.frame.scale = nan; }), incompatible, no_bridge},
        {"scaled to nothing", terms([](Terms& t) { t.frame.scale = 0; }), incompatible, no_bridge},
        {"nowhere", terms([](Terms& t) { t.frame.world_centre.z = nan; }), incompatible, no_bridge},
        {"without a limit", terms([](Terms& t) { t.limits.max_stiffness = nan; }), incompatible, no_bridge},
        {"without a period", terms([](Terms& t) { t.limits.period = 0; }), incompatible, no_bridge},
        {"gone, with words for a terminal", framed(FrameType::gone, 0, Bytes(600, std::byte{0x1b})),
         disconnected, "????"},
    };
    for (const Lie& lie : lies) {
        SCOPED_TRACE(lie.what);
        const Impostor bridge({good_welcome, lie.answer});
        Client client = connect_to(bridge);
        expect_refused(lie, [&] { client.claim(); });
    }
}

TEST(Impostor, more_answers_than_questions_end_it) {
    const std::vector<Bytes> conversations[] = {{good_welcome + good_attached, good_attached},
                                                {good_welcome, good_attached + good_attached, {}}};
    for (const auto& answers : conversations) {
        const Impostor bridge(answers);
        Client client = connect_to(bridge);
        expect_refused({"", {}, disconnected, "not those of a knurl-bridge of this version"}, [&] {
            Claim hand = client.claim();
            hand.arm();
        });
    }
}

TEST(Impostor, what_it_answers_to_commands) {
    const protocol::Reply wild{.command = 1,
                               .code = 0xffffffff,
                               .field = 0xffffffff,
                               .value = nan,
                               .reason = 0xffffffff,
                               .kind = 0xffffffff};
    Bytes many;
    for (std::uint64_t n = 0; n < 5000; ++n) many = std::move(many) + raw(protocol::Reply{.command = n + 2});
    const protocol::FeedbackHeader huge{.cycle = ~0ull, .batch = ~0ull, .gain = nan, .entries = 0xffffffff};
    const std::vector<Lie> lies{
        {"nothing", {}, disconnected, "hung up"},
        {"half an answer", framed(FrameType::replies, 1, raw(Nothing{})), disconnected, "hung up"},
        {"of no code", framed(FrameType::replies, 1, raw(wild)), refused, "device 'hand'"},
        {"to what nobody asked", framed(FrameType::replies, 1, many), disconnected, "hung up"},
        {"of no stream", framed(FrameType::replies, 9, raw(wild)), disconnected, "hung up"},
        {"half of what is felt", framed(FrameType::feedback, 1, raw(Nothing{})), disconnected, "hung up"},
        {"more felt than there is", framed(FrameType::feedback, 1, raw(huge)), disconnected, "hung up"},
    };
    for (const Lie& lie : lies) {
        SCOPED_TRACE(lie.what);
        std::vector<Bytes> answers{good_welcome, good_attached, lie.answer};
        if (lie.kind == refused) answers.emplace_back();  // an answer: it need not hang up to be heard
        const Impostor bridge(answers);
        Client client = connect_to(bridge);
        Claim hand = client.claim();
        expect_refused(lie, [&] { hand.arm(); });
    }
}

}  // namespace
}  // namespace knurl::bridge::test::impostor_tests
