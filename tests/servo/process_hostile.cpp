// Whatever arrives through the socket, the servo continues, nothing leaks, and the next client is served.

#include <atomic>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/protocol/asset.hpp>
#include <knurl/shm/socket.hpp>
#include <knurl/shm/waiter.hpp>

#include "../lingering.hpp"
#include "process_knurld.hpp"

namespace knurl::test {
namespace {

/// The servo still cycles and admits a client.
void expect_alive(const Home& home) {
    RawClient client(home);
    const Answer welcome = client.greet();
    ASSERT_TRUE(welcome.welcome);
    const DeviceView view(welcome.fds.at(0).get());
    const std::uint64_t cycles = view.count(protocol::Count::cycles);
    EXPECT_TRUE(eventually([&] { return view.count(protocol::Count::cycles) > cycles; }));
}

/// Sends without checks; a peer that has hung up is no error here.
void throw_at(int fd, const std::vector<std::byte>& bytes) {
    send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

TEST(Hostile, RandomMessagesOfRandomSizeWithDescriptorsAttached) {
    constexpr unsigned seed = 20240229;
    SCOPED_TRACE(seed);
    const Home home;
    const Knurld knurld(home);
    const std::size_t before = descriptors_of(knurld.pid());
    std::mt19937 random(seed);
    const auto below = [&](unsigned n) { return std::uniform_int_distribution<unsigned>(0, n - 1)(random); };
    for (int i = 0; i < 300; ++i) {
        RawClient client(home);
        if (below(2) == 0) {
            ASSERT_TRUE(client.greet().welcome);
        }
        for (unsigned messages = 1 + below(4); messages > 0; --messages) {
            std::vector<std::byte> bytes(1 + below(below(2) == 0 ? 200 : 20'000));
            for (std::byte& byte : bytes) byte = static_cast<std::byte>(below(256));
            if (below(2) == 0 && bytes.size() >= 8) {  // valid enough to be parsed
                const std::uint32_t header[2] = {protocol::attach_magic, below(9)};
                std::memcpy(bytes.data(), header, sizeof header);
            }
            if (below(3) == 0) {
                const std::vector<int> fds(1 + below(16), STDERR_FILENO);
                client.send_bytes(bytes.data(), bytes.size(), fds);
            } else {
                throw_at(client.fd(), bytes);
            }
        }
    }
    expect_alive(home);
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }))
        << descriptors_of(knurld.pid()) << " descriptors, " << before << " before";
}

TEST(Hostile, ClaimsOfRandomNumbersNeitherKillNorLeak) {
    constexpr unsigned seed = 7;
    SCOPED_TRACE(seed);
    const Home home;
    const Knurld knurld(home);
    const std::size_t before = descriptors_of(knurld.pid());
    std::mt19937_64 random(seed);
    for (int i = 0; i < 500; ++i) {
        RawClient client(home);
        ASSERT_TRUE(client.greet().welcome);
        protocol::ClaimRequest request;
        auto* words = reinterpret_cast<std::byte*>(&request) + sizeof(protocol::MessageHeader);
        for (std::size_t at = 0; at + 8 <= sizeof request - sizeof(protocol::MessageHeader); at += 8) {
            if (random() % 4 != 0) continue;  // mostly valid, so that later checks are reached
            const std::uint64_t word = random() >> (random() % 64);
            std::memcpy(words + at, &word, 8);
        }
        const Answer answer = client.claim(request);
        EXPECT_TRUE(answer.claimed || answer.refused);
    }
    expect_alive(home);
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }));
}

TEST(Hostile, AThousandConnectsLeaveNoDescriptor) {
    const Home home;
    const Knurld knurld(home);
    const std::size_t before = descriptors_of(knurld.pid());
    for (int i = 0; i < 1000; ++i) {
        RawClient client(home);
        ASSERT_TRUE(client.greet().welcome);
        if (i % 4 == 0) {
            EXPECT_TRUE(client.claim({.observe = 1}).claimed);
        }
    }
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }));
}

TEST(Hostile, CallersWhoSayNothingAreSentAwayAndKeepNobodyOutForLong) {
    const Home home;
    const Knurld knurld(home);
    const std::size_t before = descriptors_of(knurld.pid());
    std::vector<std::unique_ptr<RawClient>> silent;
    for (int i = 0; i < 20; ++i) silent.push_back(std::make_unique<RawClient>(home));
    RawClient polite(home);  // queued behind them
    polite.say_hello();
    std::size_t most = 0;  // half-open at once
    EXPECT_TRUE(eventually([&] {
        most = std::max(most, descriptors_of(knurld.pid()) - before);
        pollfd served{.fd = polite.fd(), .events = POLLIN, .revents = 0};
        return poll(&served, 1, 0) > 0;
    }));
    EXPECT_TRUE(polite.answer().welcome);
    EXPECT_EQ(most, 16u);
    const Answer sent_away = silent.front()->answer();
    ASSERT_TRUE(sent_away.refused);
    EXPECT_NE(std::string(sent_away.refused->text).find("no Hello within 2 s"), std::string::npos);
}

TEST(Hostile, AClientThatNeverReadsIsDroppedAndDelaysNobody) {
    const Home home;
    const Knurld knurld(home);
    RawClient deaf(home);
    ASSERT_TRUE(deaf.greet().welcome);
    // Each refusal is an unread answer of half a KiB: the socket's buffer fills, and the broker drops the
    // client.
    const protocol::ClaimRequest impossible{.device = 99};
    const bool dropped = eventually([&] {
        const ssize_t n = send(deaf.fd(), &impossible, sizeof impossible, MSG_NOSIGNAL | MSG_DONTWAIT);
        return n < 0 && errno == EPIPE;
    });
    EXPECT_TRUE(dropped);
    expect_alive(home);
}

// It says again and again that it waits on its socket, and reads nothing from it. It does to the descriptor
// what would make writing to an eventfd block.
TEST(Hostile, AClientThatFillsWhatItSleepsOnHoldsUpNobody) {
    const Home home;
    const Knurld knurld(home);
    RawClient hostile(home);
    const Answer welcome = hostile.greet();
    ASSERT_TRUE(welcome.welcome);
    const DeviceView view(welcome.fds.at(0).get());
    Answer held = hostile.claim({.shared = 1});
    ASSERT_TRUE(held.claimed) << text(held);
    const int wake_fd = held.fds.at(1).get();
    ASSERT_EQ(::fcntl(wake_fd, F_SETFL, 0), 0);
    const std::uint64_t full = ~std::uint64_t{1};
    if (::send(wake_fd, &full, sizeof full, MSG_NOSIGNAL) < 0 && errno == ENOTSOCK) {
        ASSERT_EQ(::write(wake_fd, &full, sizeof full), static_cast<ssize_t>(sizeof full));
    }

    // protocol::claim_layout puts the flag at the same place for every capacity.
    auto* flag = reinterpret_cast<shm::WaiterFlag*>(held.memory.data() + protocol::claim_layout({}).waiter);
    const std::atomic_ref<std::uint64_t> waiting(flag->waiting);
    for (int wake_ups = 0; wake_ups < 100; ++wake_ups) {
        waiting.store(static_cast<std::uint64_t>(shm::Waits::on_socket));
        ASSERT_TRUE(eventually([&] { return waiting.load() == 0; })) << "the servo wakes nobody any more";
    }
    waiting.store(static_cast<std::uint64_t>(shm::Waits::on_socket));
    const std::uint64_t cycles = view.count(protocol::Count::cycles);
    EXPECT_TRUE(eventually([&] { return view.count(protocol::Count::cycles) > cycles + 100; }));
    expect_alive(home);
    hostile.hang_up();
    EXPECT_TRUE(eventually([&] { return view.held_rows() == 0; }));
}

/// While it lives, the process is stopped.
class Stopped {
  public:
    explicit Stopped(const Program& program) : program_(program) {
        program.signal(SIGSTOP);
        const bool stopped = eventually([&] {
            std::ifstream file("/proc/" + std::to_string(program.pid()) + "/stat");
            std::string line;
            std::getline(file, line);
            return line.find(") T ") != std::string::npos;
        });
        if (!stopped) throw std::runtime_error("the servo does not stop");
    }
    ~Stopped() { program_.signal(SIGCONT); }
    Stopped(const Stopped&) = delete;
    Stopped& operator=(const Stopped&) = delete;

  private:
    const Program& program_;
};

/// Each of these descriptors keeps whoever closes it last for an hour. An answer within the patience of
/// RawClient shows that the broker did not.
class SlowToClose : public ::testing::Test {
  protected:
    /// Sends a message with descriptors that nobody else holds when the servo looks at it.
    template <class Message>
    void give(RawClient& client, const Message& message, int count = 1) {
        const Stopped stopped(knurld);
        std::vector<int> fds;
        for (int i = 0; i < count; ++i) fds.push_back(made.emplace_back(std::make_unique<Lingering>())->fd());
        ASSERT_TRUE(client.send(message, fds));
        for (const auto& each : made) each->let_go();
    }
    Answer held(RawClient& client) {
        EXPECT_TRUE(client.greet().welcome);
        return client.claim({.shared = 1});
    }

    Home home;
    Knurld knurld{home};
    const std::size_t before = descriptors_of(knurld.pid());
    std::vector<std::unique_ptr<Lingering>> made;
    protocol::AssetForget no_answer;
};

TEST_F(SlowToClose, WhereNoneIsDueTheyHoldUpNobody) {
    protocol::Hello hello;
    hello.layout = protocol::wire_hash();
    RawClient stranger(home), client(home), two(home);
    give(stranger, hello);
    EXPECT_NE(text(stranger.answer()).find("carries descriptors"), std::string::npos);
    EXPECT_TRUE(stranger.answer().hung_up);
    expect_alive(home);
    ASSERT_TRUE(client.greet().welcome);
    give(client, no_answer);
    EXPECT_NE(text(client.answer()).find("carries descriptors"), std::string::npos);
    expect_alive(home);
    ASSERT_TRUE(two.greet().welcome);
    give(two, protocol::ClaimRequest{}, 2);
    EXPECT_NE(text(two.answer()).find("carries descriptors"), std::string::npos);
    expect_alive(home);
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }));
}

TEST_F(SlowToClose, WhereOneIsDueTheyHoldUpNobody) {
    RawClient holder(home), guess(home), offering(home), two(home);
    const Answer claim = held(holder);
    ASSERT_TRUE(claim.claimed) << text(claim);
    protocol::AssetOffer offer;
    offer.number = 1;
    offer.bytes = 4096;
    for (RawClient* client : {&guess, &offering, &two}) ASSERT_TRUE(client->greet().welcome);
    give(guess, offer);
    EXPECT_NE(text(guess.answer()).find("no claim"), std::string::npos);
    expect_alive(home);
    offer.key = claim.claimed->key;
    give(offering, offer);
    EXPECT_NE(text(offering.answer()).find("not sealed"), std::string::npos);
    expect_alive(home);
    give(two, offer, shm::max_fds);
    EXPECT_NE(text(two.answer()).find("one descriptor"), std::string::npos);
    expect_alive(home);
}

TEST_F(SlowToClose, UnreadTheyHoldUpNobody) {
    auto silent = std::make_unique<RawClient>(home), rude = std::make_unique<RawClient>(home);
    {
        // It hangs up before it is looked at.
        give(*silent, no_answer);
        const Stopped stopped(knurld);
        silent.reset();
    }
    expect_alive(home);
    ASSERT_TRUE(rude->greet().welcome);
    {
        // It waits behind a message that ends the connection.
        const Stopped stopped(knurld);
        rude->send(protocol::MessageHeader{.type = protocol::MessageType::welcome});
        made.push_back(std::make_unique<Lingering>());
        rude->send(no_answer, {made.back()->fd()});
        made.back()->let_go();
    }
    EXPECT_TRUE(rude->answer().refused);
    expect_alive(home);
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }));
}

TEST_F(SlowToClose, TheyDoNotHoldUpTheEnd) {
    // 30 callers: some wait to be accepted.
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < 30; ++i) clients.push_back(std::make_unique<RawClient>(home));
    {
        const Stopped stopped(knurld);
        for (const auto& client : clients) {
            made.push_back(std::make_unique<Lingering>());
            client->send(no_answer, {made.back()->fd()});
            made.back()->let_go();
        }
        knurld.signal(SIGTERM);
    }
    EXPECT_EQ(knurld.wait(), 0);
}

TEST_F(SlowToClose, ACloserThatDiesIsReplaced) {
    const auto closers = [&] {
        std::vector<pid_t> found;
        std::ifstream children("/proc/" + std::to_string(knurld.pid()) + "/task/" +
                               std::to_string(knurld.pid()) + "/children");
        for (pid_t child = 0; children >> child;) {
            std::string name;
            std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm") >> std::ws, name);
            if (name == "knurl-closer") found.push_back(child);
        }
        return found;
    };
    ASSERT_TRUE(eventually([&] { return closers().size() == 1; }));
    const pid_t first = closers().front();
    ASSERT_EQ(::kill(first, SIGKILL), 0);
    EXPECT_TRUE(eventually([&] {
        RawClient client(home);  // its end is the closer's work
        EXPECT_TRUE(client.greet().welcome);
        const std::vector<pid_t> now = closers();
        return now.size() == 1 && now.front() != first;
    }));
    RawClient client(home);
    give(client, no_answer);
    EXPECT_TRUE(client.answer().refused);
    expect_alive(home);
    EXPECT_TRUE(eventually([&] { return descriptors_of(knurld.pid()) <= before; }));
}

}  // namespace
}  // namespace knurl::test
