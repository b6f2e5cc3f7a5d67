// Whoever speaks nonsense, too much, or not at all, costs the others nothing.

#include <random>
#include <thread>

#include <poll.h>
#include <sys/socket.h>

#include <knurl/bridge/endpoint.hpp>

#include "frame_stream.hpp"
#include "relay_support.hpp"
#include "wire.hpp"

namespace knurl::bridge::test {
namespace {

/// A good application beside the bad ones: its reports come, its updates take effect, its session is still
/// the first.
class Bystander {
  public:
    explicit Bystander(const BridgeProcess& bridge)
        : client_(connect_to(bridge)), hand_(client_.claim("", {.shared = true})) {
        force_.emplace(hand_.add(at_once({})));
    }
    void expect_well() {
        for (int i = 0; i < 20; ++i) {
            ASSERT_TRUE(hand_.next_report(10s));
            force_->set(at_once({1e-3 * ++count_, 0, 0}));
            ASSERT_TRUE(hand_.wait_applied(hand_.commit(), 10s));
        }
        EXPECT_EQ(hand_.reattachments(), 0u);
    }

  private:
    Client client_;
    Claim hand_;
    std::optional<Representing<ConstantForce>> force_;
    int count_ = 0;
};

shm::UniqueFd dial(const BridgeProcess& bridge, int type = SOCK_STREAM) {
    const Endpoint at = resolve(bridge.host_and_port());
    shm::UniqueFd fd(::socket(at.family(), type | SOCK_CLOEXEC, 0));
    if (::connect(fd.get(), at.get(), at.length) != 0) throw std::runtime_error("cannot connect");
    return fd;
}

/// Until the other end has hung up.
bool hung_up(const shm::UniqueFd& fd, int patience_ms = 20'000) {
    char buffer[4096];
    for (;;) {
        pollfd one{.fd = fd.get(), .events = POLLIN, .revents = 0};
        if (::poll(&one, 1, patience_ms) <= 0) return false;
        const ssize_t got = ::recv(fd.get(), buffer, sizeof buffer, 0);
        if (got <= 0) return true;
    }
}

void put(const shm::UniqueFd& fd, const std::vector<std::byte>& bytes) {
    [[maybe_unused]] const ssize_t sent = ::send(fd.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

template <class T>
std::vector<std::byte> frame(FrameType type, std::uint16_t stream, const T& body,
                             std::uint32_t bytes = sizeof(T)) {
    const FrameHeader header{.bytes = bytes, .type = static_cast<std::uint16_t>(type), .stream = stream};
    std::vector<std::byte> result(sizeof header + sizeof body);
    std::memcpy(result.data(), &header, sizeof header);
    std::memcpy(result.data() + sizeof header, &body, sizeof body);
    return result;
}

Hello hello() {
    Hello message;
    message.layout = wire_hash();
    put_text(message.client, "stranger");
    return message;
}

/// In, with the session's number.
std::uint64_t greet(FrameStream& stream) {
    stream.send(static_cast<std::uint16_t>(FrameType::hello), 0, bytes_of(hello()));
    for (;;) {
        pollfd one{.fd = stream.fd(), .events = POLLIN, .revents = 0};
        ::poll(&one, 1, 10'000);
        stream.pump();
        if (const Frame* answer = stream.next()) {
            std::span<const std::byte> payload = answer->payload;
            Welcome welcome;
            if (answer->type != static_cast<std::uint16_t>(FrameType::welcome) || !take(payload, welcome))
                throw std::runtime_error("no welcome");
            return welcome.session;
        }
    }
}

TEST(Hostile, bytes_on_the_connection_end_that_connection_alone) {
    ServoProcess servo;
    BridgeProcess bridge;
    Bystander bystander(bridge);
    const std::uint32_t seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Nothing nothing;
    const std::vector<std::vector<std::byte>> openings{
        frame(FrameType::hello, 0, hello(), 0),           // of length zero
        frame(FrameType::hello, 0, hello(), 0xffffffff),  // longer than memory
        frame(FrameType::hello, 0, hello(), 700 * 1024),  // longer than allowed
        frame(FrameType::hello, 0, nothing),              // cut short
        frame(FrameType::attach, 0, nothing),             // before hello
        frame(static_cast<FrameType>(999), 0, nothing),
    };
    for (const auto& bytes : openings) {
        const shm::UniqueFd fd = dial(bridge);
        put(fd, bytes);
        EXPECT_TRUE(hung_up(fd));
        bystander.expect_well();
    }
    for (int i = 0; i < 200; ++i) {
        std::vector<std::byte> bytes(1 + random() % 2000);
        for (auto& byte : bytes) byte = static_cast<std::byte>(random());
        if (random() % 2 == 0) {  // behind a good hello
            const auto good = frame(FrameType::hello, 0, hello());
            bytes.insert(bytes.begin(), good.begin(), good.end());
        }
        put(dial(bridge), bytes);
    }
    bystander.expect_well();
}

TEST(Hostile, commands_and_batches_of_no_sense_end_that_session_alone) {
    ServoProcess servo;
    BridgeProcess bridge;
    Bystander bystander(bridge);
    const std::uint32_t seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    for (int i = 0; i < 60; ++i) {
        FrameStream stream(dial(bridge), false);
        stream.pump();
        greet(stream);
        Attach attach;
        attach.request.shared = 1;
        attach.request.capacity = {.representations = 8, .batch_bytes = 1024};
        if (i % 4 == 3) attach.request.workspace_radius = std::numeric_limits<double>::quiet_NaN();
        stream.send(static_cast<std::uint16_t>(FrameType::attach), 0, bytes_of(attach));
        for (int n = 0; n < 20; ++n) {
            std::vector<std::byte> body(random() % 4 == 0 ? 64 * (1 + random() % 8) : 1 + random() % 600);
            for (auto& byte : body) byte = static_cast<std::byte>(random() % 3 == 0 ? random() : 0);
            if (random() % 2 == 0) body[0] = std::byte{1};
            stream.send(static_cast<std::uint16_t>(random() % 12), static_cast<std::uint16_t>(random() % 3),
                        body);
        }
        stream.pump();
    }
    bystander.expect_well();
}

TEST(Hostile, callers_who_never_say_who_they_are_are_dropped_after_two_seconds) {
    ServoProcess servo;
    BridgeProcess bridge;
    Bystander bystander(bridge);
    std::vector<shm::UniqueFd> silent;
    for (int i = 0; i < 40; ++i) silent.push_back(dial(bridge));  // more than are let in at a time
    bystander.expect_well();
    // Somebody good comes behind them, and gets in when they have had their time.
    EXPECT_TRUE(connect_to(bridge).connected());
    for (const auto& fd : silent) EXPECT_TRUE(hung_up(fd));
    bystander.expect_well();
}

TEST(Hostile, one_that_asks_and_never_reads_is_closed) {
    ServoProcess servo;
    BridgeProcess bridge;
    Bystander bystander(bridge);
    const shm::UniqueFd fd = dial(bridge);
    put(fd, frame(FrameType::hello, 0, hello()));
    Attach attach;
    attach.request.observe = 1;
    attach.request.capacity = {.representations = 0, .batch_bytes = 0};
    attach.request.device = 99;  // refused with a line, each time
    const auto request = frame(FrameType::attach, 0, attach);
    std::vector<std::byte> many;
    for (int i = 0; i < 500; ++i) many.insert(many.end(), request.begin(), request.end());
    bool refused = false;
    for (int i = 0; i < 2000 && !refused; ++i) {
        pollfd writable{.fd = fd.get(), .events = POLLOUT, .revents = 0};
        ::poll(&writable, 1, 5'000);
        refused = ::send(fd.get(), many.data(), many.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0 &&
                  errno != EAGAIN && errno != EWOULDBLOCK;
    }
    EXPECT_TRUE(refused) << "its connection was never ended";
    bystander.expect_well();
}

TEST(Hostile, a_flood_of_datagrams_reaches_nobody) {
    ServoProcess servo;
    BridgeProcess bridge;
    Bystander bystander(bridge);
    FrameStream stream(dial(bridge), false);
    stream.pump();
    const std::uint64_t session = greet(stream);
    std::jthread flood([&](const std::stop_token& stop) {
        std::mt19937 random(5);
        const shm::UniqueFd fd = dial(bridge, SOCK_DGRAM);
        std::vector<std::byte> bytes(1500);
        while (!stop.stop_requested()) {
            for (auto& byte : bytes) byte = static_cast<std::byte>(random());
            const std::size_t size = random() % 8 == 0 ? 0 : random() % bytes.size();
            if (random() % 2 == 0) {  // a session that there is, and any kind and stream
                DatagramHeader header{.session = session, .counter = random()};
                header.kind = static_cast<DatagramKind>(random() % 7);
                header.stream = static_cast<std::uint8_t>(random() % 40);
                header.piece = static_cast<std::uint8_t>(random() % 6);
                header.pieces = static_cast<std::uint8_t>(random() % 6);
                std::memcpy(bytes.data(), &header, sizeof header);
            }
            ::send(fd.get(), bytes.data(), size, MSG_DONTWAIT);
            if (random() % 16 == 0) std::this_thread::yield();
        }
    });
    for (int i = 0; i < 10; ++i) bystander.expect_well();
}

TEST(Hostile, a_peer_that_stands_still_loses_its_session_and_gets_another_when_it_goes_on) {
    ServoProcess servo;
    BridgeProcess bridge;
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t application = ::fork();
    if (application == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        Client client = connect_to(bridge);
        Observer observer = client.observe();
        char word = 'a';
        while (!observer.next_report(1s)) {
        }
        [[maybe_unused]] ssize_t told = ::write(ready[1], &word, 1);
        while (observer.reattachments() == 0) observer.next_report(10ms);
        while (!observer.next_report(1s)) {
        }
        told = ::write(ready[1], &word, 1);
        ::_exit(0);
    }
    ::close(ready[1]);
    Bystander bystander(bridge);
    char word = 0;
    ASSERT_EQ(::read(ready[0], &word, 1), 1);
    ::kill(application, SIGSTOP);
    for (std::string line; line.find("out: nothing was heard") == std::string::npos;) {
        line = bridge.line();
        ASSERT_FALSE(line.empty());
    }
    bystander.expect_well();
    ::kill(application, SIGCONT);
    ASSERT_EQ(::read(ready[0], &word, 1), 1);
    ::waitpid(application, nullptr, 0);
    ::close(ready[0]);
}

}  // namespace
}  // namespace knurl::bridge::test
