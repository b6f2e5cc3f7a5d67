// Hosts that call without a key do not keep the owner of a key out, whatever they send.

#include <functional>
#include <thread>

#include "../rights.hpp"
#include "relay.hpp"
#include "relay_stranger.hpp"

namespace knurl::bridge::test {
namespace {

constexpr std::size_t hosts = 200;
// More than the waiting room has seats.
constexpr std::size_t calls = 3 * hosts;
static_assert(calls > WaitingRoom::seats);

/// The first message of the key's owner, as it is on the wire.
std::vector<std::byte> recorded_hello(const std::string& key_file) {
    const shm::UniqueFd listener = bound(SOCK_STREAM);
    EXPECT_EQ(::listen(listener.get(), 1), 0);
    FrameStream owner(dial(port_of(listener), SOCK_STREAM), false,
                      TlsContext::client(read_keys(key_file).front()));
    const shm::UniqueFd peer(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
    owner.pump();
    std::vector<std::byte> bytes(max_hello_bytes);
    pollfd one{.fd = peer.get(), .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&one, 1, 20'000), 1);
    bytes.resize(static_cast<std::size_t>(::recv(peer.get(), bytes.data(), bytes.size(), 0)));
    return bytes;
}

struct Crowd : testing::Test {
    KeyRing ring;
    const std::string key = ring.add("anna", Role::control);
    const ServoUp servo;
    BridgeProcess bridge{{"--keys", ring.file()}};

    bool gets_in() {
        return Client::connect(bridge.address(), {.name = "test", .wait = 0ms, .key_file = key}).connected();
    }
    /// 200 hosts call, send this, keep the connection, and call again as soon as they have lost it.
    void expect_the_owner_to_get_in_beside(const std::vector<std::byte>& opening) {
        Bystander bystander(bridge, key);
        std::jthread crowd([&](const std::stop_token& stop) {
            std::vector<shm::UniqueFd> sockets(calls);
            while (!stop.stop_requested()) {
                for (std::size_t i = 0; i < calls && !stop.stop_requested(); ++i) {
                    if (sockets[i] && !hung_up(sockets[i], 0)) continue;
                    sockets[i] =
                        dial_from(("127.0.1." + std::to_string(1 + i % hosts)).c_str(), bridge.port());
                    if (!opening.empty()) put(sockets[i], opening);
                }
            }
        });
        ASSERT_NE(bridge.line_with("another caller waits"), "") << "all seats are taken";
        for (int i = 0; i < 20; ++i) EXPECT_TRUE(gets_in()) << i;
        if (knurl::test::missing_second_processor().empty()) bystander.expect_well();
    }
};

TEST_F(Crowd, of_silent_hosts) {
    expect_the_owner_to_get_in_beside({});
}

TEST_F(Crowd, of_hosts_that_begin_a_hello) {
    std::vector<std::byte> half = recorded_hello(key);
    half.resize(half.size() / 2);
    expect_the_owner_to_get_in_beside(half);
}

TEST_F(Crowd, of_hosts_that_send_an_owner_s_recorded_hello) {
    const std::vector<std::byte> hello = recorded_hello(key);
    const shm::UniqueFd one = dial(bridge);
    put(one, hello);
    pollfd answer{.fd = one.get(), .events = POLLIN, .revents = 0};
    char record = 0;
    ASSERT_EQ(::poll(&answer, 1, 20'000), 1);
    ASSERT_EQ(::recv(one.get(), &record, 1, 0), 1);
    ASSERT_EQ(record, 22) << "it is good, as far as the bridge can tell: the handshake goes on";
    expect_the_owner_to_get_in_beside(hello);
}

TEST_F(Crowd, of_the_owner_s_own_host) {
    const std::vector<std::byte> hello = recorded_hello(key);
    std::vector<shm::UniqueFd> sockets;
    for (int i = 0; i < CallerRate::burst / 2; ++i) {
        sockets.push_back(dial(bridge));
        if (i % 2 == 0) put(sockets.back(), hello);
    }
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(gets_in()) << i;
    for (const shm::UniqueFd& each : sockets) EXPECT_TRUE(hung_up(each));
}

TEST_F(Crowd, of_whom_none_knows_a_key_is_gone_before_the_next_one_is_heard) {
    const std::vector<std::byte> hello = recorded_hello(ring.stranger("carl", Role::control));
    const shm::UniqueFd patient = dial(bridge);
    for (int i = 0; i < 30; ++i) {
        const shm::UniqueFd each = dial(bridge);
        put(each, hello);
        EXPECT_TRUE(hung_up(each));
    }
    EXPECT_FALSE(hung_up(patient, 0)) << "none of them was waited for until its time was over";
    says(bridge.line(), "no key is named 'carl'");
}

}  // namespace
}  // namespace knurl::bridge::test
