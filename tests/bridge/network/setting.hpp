#pragma once
// A servo with its bridge, a bad network before it, and an observer on the servo's own host, whose reports
// are the force trace. The application and the proxy are on a separate host where two can be created
// (two_hosts.hpp); then the wire to the bridge is a real one.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/client/client.hpp>
#include <knurl/reps/constant_force.hpp>

#include "../relay_support.hpp"
#include "proxy.hpp"
#include "two_hosts.hpp"

namespace knurl::bridge::test {

using proxy::NetworkProfile;
using proxy::Proxy;

/// One cycle as the local observer saw it.
struct Cycle {
    std::uint64_t number;
    double dt;           // s, since the previous cycle's deadline: at least as long as the servo assumed
    double scene, sent;  // N along x: the scene's force, and the supervisor's output
};

/// The scene's force never changes faster than `slope` (N/s). On a busy machine a cycle may be late, and its
/// step is then larger. (The sent force may also fall to 0 at once: a servo that could not run for 20 ms
/// ramps up anew.)
inline void expect_no_bumps(const std::vector<Cycle>& trace, double slope, std::uint64_t seed = 0) {
    for (std::size_t i = 1; i < trace.size(); ++i)
        ASSERT_LE(std::abs(trace[i].scene - trace[i - 1].scene), slope * trace[i].dt)
            << "cycle " << trace[i].number << ", seed " << seed;
}

/// Created once: it takes longer than most tests.
inline const TwoHosts& hosts() {
    static const TwoHosts two;
    static const bool said = [] {
        if (!two.two()) std::fprintf(stderr, "one host only (%s): over loopback\n", two.why().c_str());
        return true;
    }();
    static_cast<void>(said);
    return two;
}

enum class Keyed : bool { no, yes };  // TLS and sealed datagrams; the only mode on two hosts

class Setting {
  public:
    using Overhear = decltype(Proxy::Options::overhear);

    explicit Setting(const NetworkProfile& profile = {}, std::uint64_t seed = 1, Keyed keyed = Keyed::yes,
                     Overhear overhear = {})
        : here_(hosts_of(keyed), TwoHosts::Host::client),
          key_(keyed == Keyed::yes ? ring_.add("remote", Role::control) : ""),
          bridge_(start_bridge(keyed)),
          bridge(*bridge_),
          proxy(options(profile, seed, keyed, std::move(overhear))) {
        local_ = std::make_unique<Client>(Client::connect("knurl:default", {.name = "watcher", .wait = 20s}));
        watcher_ = std::make_unique<Observer>(local_->observe());
    }

    std::string address() const { return "knurl://127.0.0.1:" + std::to_string(proxy.port()); }
    Client remote(double report_rate = 0) const {
        return Client::connect(address(),
                               {.name = "remote", .wait = 20s, .report_rate = report_rate, .key_file = key_});
    }

    /// Lets that many cycles of the servo pass; every `step` cycles `app` acts as the application. The trace
    /// continues.
    template <class App>
    void pass(std::uint64_t cycles, std::uint64_t step, App app) {
        for (std::uint64_t i = 0; i < cycles; ++i) {
            const auto report = watcher_->next_report(10s);
            ASSERT_TRUE(report) << "the servo stands still";
            const double dt = std::max(1e-3, 1e-9 * static_cast<double>(report->read_ns - last_deadline_ns_));
            trace.push_back({report->cycle, dt, report->scene_force.x, report->sent_force.x});
            last_deadline_ns_ = report->deadline_ns;
            state = report->state;
            position = report->position;
            if (i % step == 0) app();
        }
    }
    void pass(std::uint64_t cycles) {
        pass(cycles, cycles, [] {});
    }
    /// Until `so`, for at most a minute of servo time.
    template <class So, class App>
    void pass_until(So so, App app) {
        for (int rounds = 0; rounds < 6000 && !so(); ++rounds) {
            pass(10, 10, app);
            if (testing::Test::HasFatalFailure()) return;  // the servo stands still: the wait timed out
        }
        ASSERT_TRUE(so());
    }

    std::uint64_t missed() const { return watcher_->missed(); }
    double felt() const { return trace.empty() ? 0 : trace.back().scene; }  // N along x, in the newest cycle

    std::vector<Cycle> trace;
    DeviceState state = DeviceState::disconnected;
    Vec3 position;  // m

  private:
    static const TwoHosts& hosts_of(Keyed keyed) {
        static const TwoHosts one{TwoHosts::One{}};
        return keyed == Keyed::yes ? hosts() : one;
    }
    std::unique_ptr<BridgeProcess> start_bridge(Keyed keyed) const {
        const TwoHosts& on = hosts_of(keyed);
        const TwoHosts::On there(on, TwoHosts::Host::server);
        if (keyed == Keyed::no) return std::make_unique<BridgeProcess>();
        return std::make_unique<BridgeProcess>(std::vector<std::string>{"--keys", ring_.file()},
                                               on.address(TwoHosts::Host::server) + ":0");
    }
    Proxy::Options options(const NetworkProfile& profile, std::uint64_t seed, Keyed keyed,
                           Overhear overhear) const {
        Proxy::Options o;
        o.to = hosts_of(keyed).address(TwoHosts::Host::server);
        o.to_port = bridge.port();
        o.overhear = std::move(overhear);
        o.seed = seed;
        o.profile = profile;
        return o;
    }

    const TwoHosts::On here_;  // for this thread and all that it starts, except the bridge
    KeyRing ring_;
    const std::string key_;  // its owner's file
    ServoProcess servo_;
    std::unique_ptr<BridgeProcess> bridge_;

  public:
    BridgeProcess& bridge;
    Proxy proxy;

  private:
    std::int64_t last_deadline_ns_ = 0;
    std::unique_ptr<Client> local_;
    std::unique_ptr<Observer> watcher_;
};

inline ConstantForce along_x(double x) {
    return at_once({x, 0, 0});
}

/// A remote application that holds a force, armed and in full effect.
struct Remote {
    Remote(Setting& setting, const ConstantForce& first, const AddOptions& options = {})
        : client(setting.remote()),
          hand(client.claim("", {.update_interval = 20ms})),
          force(hand.add(first, options)) {
        hand.arm();
        setting.pass_until(
            [&] { return setting.state == DeviceState::active && setting.felt() == first.force.x; },
            [&] { hand.commit(); });
        setting.trace.clear();
    }
    void commit(const ConstantForce& params) {
        force.set(params);
        hand.commit();
    }

    Client client;
    Claim hand;
    Handle<ConstantForce> force;
};

}  // namespace knurl::bridge::test
