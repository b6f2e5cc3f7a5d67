// Faults of a remote application: of its network, of its bridge, and by strangers at the bridge. Its wall
// goes through the network proxy of tests/bridge, mostly with a key (TLS, sealed datagrams). Each fault
// begins and ends with a hand that feels the wall of a local application.

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>
#include <utility>

#include <sys/socket.h>
#include <unistd.h>

#include "../bridge/loopback.hpp"
#include "../bridge/proxy/proxy.hpp"
#include "faults.hpp"

namespace knurl::chaos {

using bridge::proxy::NetworkProfile;
using bridge::proxy::Proxy;
using bridge::test::dial;
using test::eventually;
using test::Program;

namespace {

enum class Keyed : bool { no, yes };

/// A bridge with a simulated network in front of it. During its lifetime the application that renders the
/// wall is connected through both.
class Remote {
  public:
    explicit Remote(Stage& stage, const NetworkProfile& profile = {.delay = 0.002}, Keyed keyed = Keyed::yes)
        : stage_(stage) {
        if (keyed == Keyed::yes) make_key();
        start_bridge("127.0.0.1:0");
        Proxy::Options options;
        options.to_port = port_;
        options.seed = stage.random();
        options.profile = profile;
        proxy.emplace(options);
        stage.start_wall("knurl://127.0.0.1:" + std::to_string(proxy->port()));
    }
    ~Remote() {
        stage_.wall.reset();
        unsetenv("KNURL_KEY");
    }

    void start_bridge(const std::string& listen) {
        bridge.reset();
        std::vector<std::string> words{"--listen", listen, "--anyone"};
        if (!keys_.empty()) words = {"--listen", listen, "--keys", keys_};
        bridge.emplace(stage_.home, KNURL_BRIDGE, words);
        const std::string mark = "is reached at knurl://127.0.0.1:";
        bridge->wait_for_output(mark);
        while (bridge->output().find('\n') == std::string::npos) bridge->wait_for_output("\n");
        port_ = static_cast<std::uint16_t>(
            std::stoi(bridge->output().substr(bridge->output().find(mark) + mark.size())));
    }
    std::uint16_t port() const { return port_; }
    /// Bytes of the bridge's resident memory.
    std::size_t resident() const {
        std::ifstream statm("/proc/" + std::to_string(bridge->pid()) + "/statm");
        std::size_t total = 0, pages = 0;
        statm >> total >> pages;
        return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    }

    std::optional<Program> bridge;
    std::optional<Proxy> proxy;

  private:
    /// A file with one key serves both as the bridge's and as the key's owner's, so the application uses the
    /// same.
    void make_key() {
        const std::string file = stage_.home.path() / "bridge.keys";
        std::error_code none;
        std::filesystem::remove(file, none);
        Program keygen(stage_.home, KNURL_BRIDGE,
                       {"keygen", "--keys", file, "--name", "wall", "--role", "control"});
        demand(keygen.wait() == 0, "a key is made: " + keygen.output());
        setenv("KNURL_KEY", file.c_str(), 1);
        keys_ = file;
    }

    Stage& stage_;
    std::string keys_;  // the bridge's file; "": it asks for none
    std::uint16_t port_ = 0;
};

double share(Stage& stage) {
    return std::uniform_real_distribution<>()(stage.random);
}

/// Waits until the force is zero, and adds the time that this took to the table under `promise`. Returns
/// since when it is zero (ns).
std::int64_t gone(Stage& stage, std::int64_t from, const std::string& promise) {
    const std::int64_t zero = stage.wait_until_zero(from);
    stage.measured(promise, static_cast<double>(zero - from) * 1e-6);
    return zero;
}

/// Demands that the application reattaches by itself, and that the force, gone since `zero`, returns only
/// when the application arms.
void demand_return(Stage& stage, std::int64_t zero, const std::string& after) {
    stage.wall->wait_for_output("reattached-to " + std::to_string(stage.knurld->pid()));
    demand_off_until_armed(stage, zero, after);
    stage.wait_until_felt();
}

void demand_idle(Stage& stage) {
    demand(eventually([&] { return stage.state() == DeviceState::idle; }),
           "a device that nobody holds is idle");
}

// --------------------------------------------------------------------------------------------- the network

void bad_network(Stage& stage) {
    const NetworkProfile profile{.loss = 0.3 * share(stage),
                                 .duplicate = 0.3 * share(stage),
                                 .reorder = 0.3 * share(stage),
                                 .held = 0.1 * share(stage),
                                 .delay = 0.05 * share(stage),
                                 .jitter = 0.05 * share(stage),
                                 .swing = 0.1 * share(stage)};
    const Remote remote(stage, profile);
    const std::int64_t from = Stage::now();
    stage.let_pass(2.0);
    demand_undisturbed(stage, from, "a network that loses, delays, doubles and reorders");
}

/// Each datagram arrives a second time, up to a second late.
void replayed_datagrams(Stage& stage) {
    const Remote remote(stage, {.duplicate = 1, .reorder = 0.5, .held = 1});
    const std::int64_t from = Stage::now();
    stage.let_pass(2.0);
    demand_undisturbed(stage, from, "a network that replays each datagram");
}

void fluctuating_delay(Stage& stage) {
    const Remote remote(stage, {.swing = 0.2, .swing_period = 0.05 + 0.4 * share(stage)}, Keyed::no);
    const std::int64_t from = Stage::now();
    stage.let_pass(3.0);
    demand_undisturbed(stage, from, "a delay that goes up and down by 200 ms");
}

void network_cut(Stage& stage) {
    Remote remote(stage);
    const std::int64_t from = Stage::now();
    remote.proxy->cut();
    gone(stage, from, "network cut: silence (250 + 200 ms) and fade (100 ms)");
    remote.proxy->heal();
    stage.wait_until_felt();  // the same claim: it was away for a second only
}

void long_cut(Stage& stage) {
    Remote remote(stage);
    const std::int64_t from = Stage::now();
    remote.proxy->cut();
    const std::int64_t zero = stage.wait_until_zero(from);
    demand_idle(stage);
    remote.proxy->heal();
    demand_return(stage, zero, "after a long cut");
}

void connection_reset(Stage& stage) {
    Remote remote(stage);
    const std::int64_t from = Stage::now();
    remote.proxy->hang_up();
    demand_return(stage, gone(stage, from, "connection reset: zero within 60 ms"), "after a reset");
}

// ------------------------------------------------------------------------------- the processes at both ends

void peer_killed(Stage& stage) {
    const Remote remote(stage, {.delay = 0.002}, Keyed::no);
    const std::int64_t from = Stage::now();
    stage.wall->signal(SIGKILL);
    gone(stage, from, "remote application killed: zero within 60 ms");
    demand_idle(stage);
}

void peer_stopped(Stage& stage) {
    const Remote remote(stage);
    const std::int64_t from = Stage::now();
    stage.wall->signal(SIGSTOP);
    gone(stage, from, "remote application stopped: silence (250 + 200 ms) and fade (100 ms)");
    stage.wall->signal(SIGCONT);
    stage.wait_until_felt();
}

void bridge_killed(Stage& stage) {
    Remote remote(stage);
    const std::int64_t from = Stage::now();
    remote.bridge->signal(SIGKILL);
    const std::int64_t zero = gone(stage, from, "bridge killed: zero within 60 ms");
    remote.start_bridge("127.0.0.1:" + std::to_string(remote.port()));
    demand_return(stage, zero, "after a restart of the bridge");
}

void servo_killed_under_bridge(Stage& stage) {
    Remote remote(stage);
    const std::int64_t from = Stage::now();
    stage.knurld->signal(SIGKILL);
    const std::int64_t zero = stage.wait_until_zero(from);
    stage.start_servo();
    demand_return(stage, zero, "after a restart of the servo under the bridge");
}

// ----------------------------------------------------------------------------------------------- strangers

void hostile_packets_at(Stage& stage, Keyed keyed) {
    Remote remote(stage, {}, keyed);
    const std::size_t before = remote.resident();
    std::mt19937_64 random(stage.random());
    std::atomic<bool> done = false;
    const std::int64_t from = Stage::now();
    std::thread stranger([&] {
        std::array<char, 1500> bytes;
        const shm::UniqueFd udp = dial(remote.port(), SOCK_DGRAM | SOCK_NONBLOCK);
        while (!done) {
            const shm::UniqueFd tcp = dial(remote.port(), SOCK_STREAM | SOCK_NONBLOCK);
            for (int i = 0; i < 100; ++i) {
                for (char& byte : bytes) byte = static_cast<char>(random() % 4 ? random() : 0);
                const std::size_t size = random() % 8 ? random() % bytes.size() : 0;
                ::send(udp.get(), bytes.data(), size, MSG_NOSIGNAL);
                if (i % 10 == 0) ::send(tcp.get(), bytes.data(), size, MSG_NOSIGNAL);
            }
            std::this_thread::yield();
        }
    });
    stage.let_pass(1.0);
    done = true;
    stranger.join();
    demand_undisturbed(stage, from, "a flood of packets at the bridge");
    demand(remote.resident() < before + (32u << 20), "a flood costs the bridge no memory to speak of");
}

void hostile_packets(Stage& stage) {
    hostile_packets_at(stage, Keyed::yes);
}
void hostile_packets_without_keys(Stage& stage) {
    hostile_packets_at(stage, Keyed::no);
}

void half_open_peers(Stage& stage) {
    Remote remote(stage, {});
    const std::int64_t from = Stage::now();
    std::vector<shm::UniqueFd> silent;
    for (int i = 0; i < 40; ++i) silent.push_back(dial(remote.port(), SOCK_STREAM | SOCK_NONBLOCK));
    const std::int64_t asked = Stage::now();
    {
        Client client =
            Client::connect("knurl://127.0.0.1:" + std::to_string(remote.port()), {.wait = test::patience});
        demand(client.observe().next_report(test::patience).has_value(),
               "who comes after 40 silent peers gets in");
    }
    stage.measured("after 40 half-open peers: the next one is in",
                   static_cast<double>(Stage::now() - asked) * 1e-6);
    silent.clear();
    demand_undisturbed(stage, from, "40 peers that say nothing");
}

constexpr Fault of_networks[] = {
    {"bad network", bad_network},
    {"replayed datagrams", replayed_datagrams},
    {"fluctuating delay", fluctuating_delay},
    {"network cut", network_cut},
    {"long cut", long_cut},
    {"connection reset", connection_reset},
    {"remote application killed", peer_killed},
    {"remote application stopped", peer_stopped},
    {"bridge killed", bridge_killed},
    {"servo killed under the bridge", servo_killed_under_bridge},
    {"hostile packets", hostile_packets},
    {"hostile packets, no keys", hostile_packets_without_keys},
    {"half-open peers", half_open_peers},
};

/// Ends a fault with the wall of a local application.
template <std::size_t i>
void and_back(Stage& stage) {
    of_networks[i].happen(stage);
    stage.start_wall();
}

}  // namespace

std::span<const Fault> network_faults() {
    static constexpr auto wrapped = []<std::size_t... i>(std::index_sequence<i...>) {
        return std::array{Fault{of_networks[i].name, and_back<i>}...};
    }
    (std::make_index_sequence<std::size(of_networks)>());
    return wrapped;
}

}  // namespace knurl::chaos
