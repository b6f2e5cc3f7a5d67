// Peers that send nonsense, too much, or nothing do not disturb the others.

#include <chrono>
#include <random>
#include <thread>

#include "../rights.hpp"
#include "relay.hpp"
#include "relay_stranger.hpp"
#include "seed.hpp"

namespace knurl::bridge::test {
namespace {

struct Hostile : testing::Test {
    const ServoUp servo;
    BridgeProcess bridge;
    const std::uint32_t drawn = seed();
    const testing::ScopedTrace trace{__FILE__, __LINE__, text_of_seed(drawn)};
    std::mt19937 random{drawn};
};

TEST_F(Hostile, bytes_on_the_connection_end_that_connection_alone) {
    Bystander bystander(bridge);
    const Nothing nothing;
    const std::vector<std::vector<std::byte>> openings{
        frame(FrameType::hello, 0, hello(), 0),           // of length zero
        frame(FrameType::hello, 0, hello(), 0xffffffff),  // longer than memory
        frame(FrameType::hello, 0, hello(), max_greeting_bytes + 1),
        frame(FrameType::hello, 0, nothing),   // cut short
        frame(FrameType::attach, 0, nothing),  // before hello
        frame(static_cast<FrameType>(999), 0, nothing),
    };
    says(bridge.line(), "in, role control");
    int host = 1;  // each from a host of its own, since the log has the same line of one host only once
    for (const auto& bytes : openings) {
        const shm::UniqueFd fd = dial_from(("127.0.0." + std::to_string(++host)).c_str(), bridge.port());
        put(fd, bytes);
        EXPECT_TRUE(hung_up(fd));
        says(bridge.line(), "not let in: ");  // because of its message, not after a timeout
        bystander.expect_well();
    }
    for (int i = 0; i < 60; ++i) {
        std::vector<std::byte> bytes(1 + random() % 2000);
        for (auto& byte : bytes) byte = static_cast<std::byte>(random());
        if (random() % 2 == 0) {  // after a valid hello
            const auto good = frame(FrameType::hello, 0, hello());
            bytes.insert(bytes.begin(), good.begin(), good.end());
        }
        put(dial(bridge), bytes);
    }
    bystander.expect_well();
}

TEST_F(Hostile, commands_and_batches_of_no_sense_end_that_session_alone) {
    Bystander bystander(bridge);
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
            const auto type = static_cast<FrameType>(random() % 20);
            if (type == FrameType::release) continue;  // releasing what does not exist is no error
            stream.send(static_cast<std::uint16_t>(type), static_cast<std::uint16_t>(random() % 3), body);
        }
        const bool attached = i % 4 != 3;
        if (attached) stream.send(static_cast<std::uint16_t>(FrameType::commands), 1, bytes_of(Nothing{}));
        stream.pump();
        if (!attached) continue;
        EXPECT_TRUE(ended(stream)) << "at the latest by half a command";
    }
    bystander.expect_well();
}

TEST_F(Hostile, callers_who_never_say_who_they_are_are_dropped_after_two_seconds) {
    Bystander bystander(bridge);
    std::vector<shm::UniqueFd> silent;
    for (int i = 0; i < CallerRate::burst / 2; ++i) silent.push_back(dial(bridge));
    bystander.expect_well();
    // A good peer on the same host does not have to wait for them.
    EXPECT_TRUE(Client::connect(bridge.address(), {.name = "test", .wait = 0ms}).connected());
    for (const shm::UniqueFd& each : silent) EXPECT_TRUE(hung_up(each));
    bystander.expect_well();
}

TEST_F(Hostile, who_calls_again_and_again_is_heard_so_often_and_costs_the_others_nothing) {
    Bystander bystander(bridge);
    Hello other = hello();
    ++other.version;  // a different version is answered
    const auto call = frame(FrameType::hello, 0, other);
    const auto begin = std::chrono::steady_clock::now();
    int heard = 0;
    for (int i = 0; i < 2000; ++i) {
        const shm::UniqueFd fd = dial_from("127.0.0.2", bridge.port());
        put(fd, call);
        char first = 0;
        heard += ::recv(fd.get(), &first, 1, 0) == 1 ? 1 : 0;
        if (i % 500 == 0) bystander.expect_well();
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    EXPECT_GE(heard, CallerRate::burst);
    EXPECT_LE(heard, CallerRate::burst + static_cast<double>(CallerRate::per_second) * took.count() + 1);
    says(bridge.line_with("not let in: its host"), "127.0.0.2:");
    EXPECT_TRUE(Client::connect(bridge.address(), {.name = "test", .wait = 0ms}).connected())
        << "of another host";
    bystander.expect_well();
}

TEST_F(Hostile, callers_of_one_host_keep_nobody_of_another_one_out) {
    std::jthread crowd([&](const std::stop_token& stop) {
        std::vector<shm::UniqueFd> sockets(80);
        while (!stop.stop_requested())
            for (shm::UniqueFd& socket : sockets)
                if (!socket || hung_up(socket, 0)) socket = dial_from("127.0.0.2", bridge.port());
    });
    ASSERT_NE(bridge.line_with("127.0.0.2"), "") << "all its places are taken";
    for (int i = 0; i < 20; ++i)
        EXPECT_TRUE(Client::connect(bridge.address(), {.name = "test", .wait = 0ms}).connected());
}

TEST_F(Hostile, one_that_asks_and_never_reads_is_closed) {
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

TEST_F(Hostile, a_flood_of_datagrams_reaches_nobody) {
    KNURL_NEEDS(knurl::test::missing_second_processor());
    Bystander bystander(bridge);
    FrameStream stream(dial(bridge), false);
    stream.pump();
    const std::uint64_t session = greet(stream);
    std::jthread flood([&](const std::stop_token& stop) {
        const shm::UniqueFd fd = dial(bridge, SOCK_DGRAM);
        std::vector<std::byte> bytes(1500);
        while (!stop.stop_requested()) {
            for (auto& byte : bytes) byte = static_cast<std::byte>(random());
            const std::size_t size = random() % 8 == 0 ? 0 : random() % bytes.size();
            if (random() % 2 == 0) {  // an existing session, with any kind and stream
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

TEST_F(Hostile, a_replayed_datagram_keeps_nobody_s_session_alive) {
    FrameStream stream(dial(bridge), false);
    const std::uint64_t session = greet(stream);
    Pinger mine(session, bound(SOCK_DGRAM)), stranger(session, bound(SOCK_DGRAM));
    const auto datagram = mine.ping(bridge.port(), 1);
    ASSERT_TRUE(mine.answered());
    std::jthread replay([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            stranger.send(bridge.port(), datagram);
            // Often enough to keep the session alive if one of them counted, but not a flood.
            std::this_thread::sleep_for(20ms);
        }
    });
    EXPECT_TRUE(ended(stream));
    EXPECT_FALSE(stranger.answered(0ms));
}

TEST_F(Hostile, a_datagram_of_the_session_from_another_host_is_dropped) {
    FrameStream stream(dial(bridge), false);
    const std::uint64_t session = greet(stream);
    Pinger foreign(session, bound_at("127.0.0.2")), mine(session, bound(SOCK_DGRAM));
    foreign.ping(bridge.port(), 1);
    mine.ping(bridge.port(), 2);
    EXPECT_TRUE(mine.answered());
    EXPECT_FALSE(foreign.answered(0ms)) << "it came before the one that was answered";
    mine.ping(bridge.port(), 1);
    EXPECT_TRUE(mine.answered()) << "and nothing of it was taken for this session's";
}

TEST_F(Hostile, a_crowd_that_is_turned_away_is_one_line_and_hides_nobody) {
    const auto garbage = frame(FrameType::attach, 0, Nothing{});
    for (int i = 0; i < 100; ++i) {
        const shm::UniqueFd fd = dial(bridge);
        put(fd, garbage);
        ASSERT_TRUE(hung_up(fd));
    }
    says(bridge.line(), "not let in: it did not say hello first");
    FrameStream stream(dial(bridge), false);
    greet(stream);
    says(bridge.line(), "not let in, 99 times more until now: it did not say hello first");
    says(bridge.line(), "in, role control");
}

TEST_F(Hostile, a_peer_that_stands_still_loses_its_session_and_gets_another_when_it_goes_on) {
    BridgeProcess other;  // is stopped itself for as long, for which it must not blame its peers
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
    FrameStream patient(dial(other), false);
    greet(patient);
    other.stop();
    ::kill(application, SIGSTOP);
    ASSERT_NE(bridge.line_with("out: nothing was heard"), "");
    other.go_on();
    EXPECT_EQ(attach_observer(patient).stream, 1u);
    bystander.expect_well();
    ::kill(application, SIGCONT);
    ASSERT_EQ(::read(ready[0], &word, 1), 1);
    ::waitpid(application, nullptr, 0);
    ::close(ready[0]);
}

}  // namespace
}  // namespace knurl::bridge::test
