// The plain echo servers beside a bridge: they return all input, whatever other peers do.

#include <array>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <latency_echo.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "program.hpp"

namespace knurl::test {
namespace {

using cli::now_ns;
using cli::TcpCaller;
using cli::TcpEcho;

constexpr cli::Nanoseconds patience_ns = std::chrono::nanoseconds(patience).count();

bridge::Endpoint any_port() {
    return bridge::resolve("127.0.0.1:0");
}

/// A peer that behaves in ways in which no measurement does.
class RawPeer {
  public:
    static constexpr int little = 4096;  // bytes of its buffers, so that the echo soon has to wait
    explicit RawPeer(const TcpEcho& echo, int room = little, int segment = 0)
        : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        ::setsockopt(fd_.get(), SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
        if (segment > 0) ::setsockopt(fd_.get(), IPPROTO_TCP, TCP_MAXSEG, &segment, sizeof segment);
        EXPECT_EQ(::connect(fd_.get(), echo.at().get(), echo.at().length), 0);
        const timeval limit{.tv_sec = patience.count(), .tv_usec = 0};
        ::setsockopt(fd_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    }
    void send(std::span<const char> bytes) const {
        while (!bytes.empty()) {
            const ssize_t sent = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
            ASSERT_GT(sent, 0);
            bytes = bytes.subspan(static_cast<std::size_t>(sent));
        }
    }
    /// Sends what fits without waiting.
    std::size_t send_now(std::span<const char> bytes) const {
        const ssize_t sent = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        return static_cast<std::size_t>(std::max<ssize_t>(0, sent));
    }
    /// False: nothing was accepted for a while. (An echo that is slow, not stuck, makes a test weaker, not
    /// wrong.)
    bool takes_more() const {
        constexpr int a_while = 50;  // ms
        pollfd room{.fd = fd_.get(), .events = POLLOUT, .revents = 0};
        return ::poll(&room, 1, a_while) == 1 && (room.revents & (POLLERR | POLLHUP)) == 0;
    }
    /// Receives that many bytes; fewer if the echo has closed.
    std::vector<char> receive(std::size_t bytes) const {
        std::vector<char> all(bytes);
        const ssize_t got = ::recv(fd_.get(), all.data(), bytes, MSG_WAITALL);
        all.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
        return all;
    }
    bool echoes(std::span<const char> bytes) const {
        send(bytes);
        const auto came = receive(bytes.size());
        return std::ranges::equal(came, bytes);
    }
    /// Sends until nothing more is accepted.
    void stuff() const {
        const std::vector<char> much(1 << 16);
        while (send_now(much) > 0) {
        }
    }
    void break_off() {
        const linger at_once{.l_onoff = 1, .l_linger = 0};
        ::setsockopt(fd_.get(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        fd_.reset();
    }

  private:
    shm::UniqueFd fd_;
};

constexpr std::array<char, 5> word{'k', 'n', 'u', 'r', 'l'};

TEST(TcpEcho, AnswersExactlyWhatCameHoweverItWasSplitAndHoweverOftenItHadToWait) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const TcpEcho echo(any_port());
    // Room for whole loopback segments. With less, only a timer reports that the TCP window has opened again.
    const RawPeer peer(echo, 1 << 18);
    std::vector<char> sent, came;
    for (int round = 0; round < 6; ++round) {
        // Sends without reading until nothing more is accepted. Then every buffer on the path is full, and
        // the echo waits within a message, or without any room.
        do {
            std::vector<char> part(1 + random() % (random() % 2 == 0 ? 7 : 90'000));
            for (char& byte : part) byte = static_cast<char>(random());
            const std::size_t taken = peer.send_now(part);
            sent.insert(sent.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(taken));
        } while (peer.takes_more());
        const std::size_t under_way = sent.size() - came.size();
        const auto back = peer.receive(round % 3 == 0 ? under_way : 1 + random() % under_way);
        ASSERT_FALSE(back.empty());
        came.insert(came.end(), back.begin(), back.end());
    }
    const auto rest = peer.receive(sent.size() - came.size());
    came.insert(came.end(), rest.begin(), rest.end());
    EXPECT_TRUE(came == sent) << came.size() << " of " << sent.size() << " bytes came back";
}

TEST(TcpEcho, WaitsWhereThereIsNoRoomAtAll) {
    // Segments as long as one read of the echo (and 12 bytes of time stamps). Its buffer is then full at the
    // end of a message, and has no room for a single byte of the next one.
    constexpr std::size_t at_a_time = 4096;
    const TcpEcho echo(any_port());
    const RawPeer peer(echo, 1 << 18, at_a_time + 12);
    std::vector<char> sent, came;
    for (int round = 0; round < 6; ++round) {
        do {
            std::vector<char> part(at_a_time, static_cast<char>('a' + sent.size() / at_a_time % 26));
            const std::size_t taken = peer.send_now(part);
            sent.insert(sent.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(taken));
        } while (peer.takes_more());
        const auto back = peer.receive(sent.size() - came.size());
        came.insert(came.end(), back.begin(), back.end());
    }
    EXPECT_TRUE(came == sent) << came.size() << " of " << sent.size() << " bytes came back";
}

TEST(TcpEcho, DoesNotWaitForTheRestOfAMessage) {
    const TcpEcho echo(any_port());
    const RawPeer peer(echo);
    for (std::size_t i = 0; i < word.size(); ++i)
        EXPECT_TRUE(peer.echoes(std::span(word).subspan(i, 1))) << i;
}

TEST(TcpEcho, APeerThatNeverReadsDelaysNobody) {
    const TcpEcho echo(any_port());
    const RawPeer rude(echo), polite(echo);
    rude.stuff();
    EXPECT_TRUE(polite.echoes(word));
}

TEST(TcpEcho, APeerThatBreaksOffInTheMiddleTakesNobodyAlong) {
    const TcpEcho echo(any_port());
    const RawPeer polite(echo);
    for (int i = 0; i < 20; ++i) {
        RawPeer rude(echo);
        rude.send(word);
        rude.break_off();
        EXPECT_TRUE(polite.echoes(word));
    }
}

TEST(TcpEcho, WhenAllPlacesAreTakenTheLongestSilentHasToGo) {
    const TcpEcho echo(any_port());
    std::vector<std::unique_ptr<RawPeer>> peers;
    for (std::size_t i = 0; i < TcpEcho::places; ++i) {
        peers.push_back(std::make_unique<RawPeer>(echo));
        EXPECT_TRUE(peers.back()->echoes(word));
    }
    EXPECT_TRUE(peers[0]->echoes(word));  // so that the second peer has been silent longest
    const RawPeer more(echo);
    EXPECT_TRUE(more.echoes(word));
    EXPECT_TRUE(peers[1]->receive(1).empty());
    for (std::size_t i = 0; i < peers.size(); ++i) {
        if (i != 1) {
            EXPECT_TRUE(peers[i]->echoes(word)) << i;
        }
    }
}

TEST(TcpEcho, EndsThoughPeersAreThereAndTheySeeIt) {
    auto echo = std::make_unique<TcpEcho>(any_port());
    const RawPeer quiet(*echo), rude(*echo);
    EXPECT_TRUE(quiet.echoes(word));
    rude.stuff();
    echo.reset();
    EXPECT_TRUE(quiet.receive(1).empty());
}

TEST(TcpCaller, TakesNothingButItsOwnBytesForAnAnswer) {
    const TcpEcho echo(any_port());
    TcpCaller caller(echo.at(), 72, now_ns() + patience_ns);
    EXPECT_TRUE(caller.round_trip(now_ns() + patience_ns));
    EXPECT_TRUE(caller.round_trip(now_ns() + patience_ns));

    // Listens, and gives the same answer to everything.
    const shm::UniqueFd other(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    bridge::Endpoint at = any_port();
    ASSERT_EQ(::bind(other.get(), at.get(), at.length), 0);
    ASSERT_EQ(::listen(other.get(), 1), 0);
    ASSERT_EQ(::getsockname(other.get(), at.get(), &at.length), 0);
    TcpCaller asked(at, word.size(), now_ns() + patience_ns);
    ASSERT_TRUE(asked.connected());
    const shm::UniqueFd accepted(::accept(other.get(), nullptr, nullptr));
    const std::vector<char> nonsense(72, '!');
    ASSERT_GT(::send(accepted.get(), nonsense.data(), nonsense.size(), MSG_NOSIGNAL), 0);
    EXPECT_FALSE(asked.round_trip(now_ns() + patience_ns));
    EXPECT_FALSE(asked.connected());
}

TEST(TcpCaller, SaysSoWhereNobodyListensOrAnswers) {
    std::optional<TcpEcho> echo(any_port());
    const bridge::Endpoint at = echo->at();
    echo.reset();
    EXPECT_FALSE(TcpCaller(at, 72, now_ns() + patience_ns).connected());
    EXPECT_FALSE(TcpCaller(at, 72, now_ns() + patience_ns).round_trip(now_ns() + patience_ns));
}

TEST(ServedEcho, AnswersByUdpAndByTcpAtOnePort) {
    Background served({knurl_program(), "latency", "--serve-echo", "127.0.0.1:0"});
    ASSERT_TRUE(served.says("by UDP and TCP")) << served.said();
    const std::size_t from = served.said().find("127.0.0.1:");
    const bridge::Endpoint at =
        bridge::resolve(served.said().substr(from, served.said().find(' ', from) - from));
    EXPECT_TRUE(cli::udp_echoes(at));
    EXPECT_TRUE(TcpCaller(at, 72, now_ns() + patience_ns).round_trip(now_ns() + patience_ns));
}

}  // namespace
}  // namespace knurl::test
