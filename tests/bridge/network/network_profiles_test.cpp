// A remote application under every network profile: the hand gets what was committed, the newest first, and
// nothing from the past. The servo's own reports are the judge; they count in cycles.

#include <algorithm>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>

#include "setting.hpp"
#include "wire.hpp"

namespace knurl::bridge::test {
namespace {

struct Case {
    const char* name;
    NetworkProfile profile;
    Keyed keyed = Keyed::yes;
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.name;
}

constexpr NetworkProfile foul{
    .loss = 0.3, .duplicate = 0.2, .reorder = 0.3, .held = 0.2, .delay = 0.02, .jitter = 0.1};

constexpr std::uint64_t seed = 7;
constexpr std::uint64_t interval = 20;  // cycles between two commits

const Case profiles[] = {
    {"Lossy", {.loss = 0.3}},
    {"Far", {.delay = 0.1}},
    {"Doubled", {.duplicate = 0.5, .reorder = 0.5, .held = 0.03}},
    {"Swinging", {.delay = 0.001, .swing = 0.2, .swing_period = 0.2}},
    {"Foul", foul},
    {"FoulWithoutAKey", foul, Keyed::no},  // only on loopback
};

/// The network's effect on one observer's reports, by the datagrams' counters, which anybody can read.
class Ledger {
  public:
    struct Counts {
        std::uint64_t lost = 0, late = 0, duplicated = 0;
    };
    void note(proxy::Way way, Proxy::At at, std::span<const char> datagram) {
        DatagramHeader header;
        if (way != proxy::Way::back || datagram.size() < sizeof header) return;
        std::memcpy(&header, datagram.data(), sizeof header);
        if (header.kind != DatagramKind::report) return;
        const std::scoped_lock lock(mutex_);
        (at == Proxy::At::entry ? entered_ : left_).push_back(header.counter);
    }
    /// From the first datagram sent to the newest.
    Counts counts() const {
        const std::scoped_lock lock(mutex_);
        Counts counts;
        std::set<std::uint64_t> here;
        for (const std::uint64_t each : left_) {
            if (each < left_.front()) continue;
            if (!here.empty() && each < *here.rbegin() && !here.contains(each)) ++counts.late;
            counts.duplicated += here.insert(each).second ? 0 : 1;
        }
        for (const std::uint64_t each : entered_)
            counts.lost +=
                !here.empty() && each >= *here.begin() && each <= *here.rbegin() && !here.contains(each);
        return counts;
    }

  private:
    mutable std::mutex mutex_;
    std::vector<std::uint64_t> entered_, left_;
};

class Under : public testing::TestWithParam<Case> {
  protected:
    Ledger ledger;
    Setting setting{GetParam().profile, seed, GetParam().keyed,
                    [this](proxy::Way way, Proxy::At at, std::span<const char> datagram) {
                        ledger.note(way, at, datagram);
                    }};
};
INSTANTIATE_TEST_SUITE_P(NetworkProfile, Under, testing::ValuesIn(profiles),
                         [](const auto& of) { return std::string(of.param.name); });

TEST_P(Under, OnlyTheNewestIsAppliedNothingFromThePastAndTheLastOneArrives) {
    Remote remote(setting, along_x(0.01), {.on_silence = OnSilence::hold});
    // 0.011, 0.012, ... N: all distinct, and later ones are larger.
    std::vector<double> committed{0.01};
    setting.pass(1200, 10, [&] {
        committed.push_back(0.01 + 0.001 * static_cast<double>(committed.size()));
        remote.commit(along_x(committed.back()));
    });
    setting.pass_until([&] { return setting.felt() == committed.back(); }, [] {});  // nobody commits again

    double newest = 0;
    for (const Cycle& cycle : setting.trace) {
        ASSERT_GE(cycle.scene, newest) << "from the past, in cycle " << cycle.number << ", seed " << seed;
        ASSERT_TRUE(std::ranges::binary_search(committed, cycle.scene))
            << cycle.scene << " N was never committed, cycle " << cycle.number << ", seed " << seed;
        newest = cycle.scene;
    }
    EXPECT_EQ(setting.missed(), 0u) << "the judge must have seen all";
}

TEST_P(Under, EachLastUpdateArrivesThoughNobodyCommitsAgain) {
    Remote remote(setting, along_x(0.01), {.on_silence = OnSilence::hold});
    for (int round = 1; round <= 8; ++round) {
        const double force = 0.01 + 0.01 * round;
        remote.commit(along_x(force));
        setting.pass_until([&] { return setting.felt() == force; }, [] {});
    }
}

TEST_P(Under, ALivePeerNeverCountsAsSilent) {
    Remote remote(setting, along_x(0.2));
    setting.pass(1500, interval, [&] { remote.hand.commit(); });
    for (const Cycle& cycle : setting.trace)
        ASSERT_EQ(cycle.scene, 0.2) << "cycle " << cycle.number << ", seed " << seed;
}

TEST_P(Under, TheForceChangesWithoutBumps) {
    constexpr double step = 0.3;        // N, of the requested force
    constexpr double recovery = 0.050;  // s, in which the hand gets it
    const auto gently = [](double x) { return ConstantForce{.force = {x, 0, 0}, .recovery = recovery}; };
    Remote remote(setting, gently(0.1));
    bool up = false;
    setting.pass(1200, interval, [&] { remote.commit(gently((up = !up) ? 0.1 + step : 0.1)); });
    // A smooth step rises at most 1.5 or 1.875 times as fast as a straight line does (of third or fifth
    // order), and a change may come in the middle of another.
    expect_no_bumps(setting.trace, 2 * 1.875 * step / recovery, seed);
    for (const Cycle& cycle : setting.trace) {
        ASSERT_GE(cycle.scene, 0.1 - 1e-9);
        ASSERT_LE(cycle.scene, 0.1 + step + 1e-9);
    }
}

TEST_P(Under, EachReportIsReadOnceInOrderAndTheOthersAreCounted) {
    Client client = setting.remote();
    Observer observer = client.observe();
    std::optional<HandReport> first = observer.next_report(20s);
    ASSERT_TRUE(first);
    std::uint64_t read = 1, last = first->cycle;
    const Network before = observer.network();
    const std::uint64_t missed_before = observer.missed();
    const auto read_all = [&] {
        while (const auto report = observer.next_report(0ns)) {
            ASSERT_GT(report->cycle, last) << "newest first, and once";
            last = report->cycle;
            ++read;
        }
    };
    // Counts the observer's own reports, since far more may already wait for the watcher.
    setting.pass_until([&] { return last >= first->cycle + 1200; }, read_all);
    // Reports that have arrived unread are in the network's counts but not in the reader's: waits until both
    // agree.
    Network now = observer.network(), then;
    do {
        then = now;
        read_all();
        now = observer.network();
    } while (now.lost != then.lost || now.late != then.late);
    const std::uint64_t missed = observer.missed() - missed_before;
    EXPECT_EQ(read + missed, last - first->cycle + 1)
        << "each cycle's report is read or counted, seed " << seed;
    const NetworkProfile& profile = GetParam().profile;
    EXPECT_EQ(now.lost + now.late, observer.missed()) << "seed " << seed;
    if (profile.loss == 0 && profile.jitter == 0 && profile.reorder == 0) {
        EXPECT_EQ(now.lost, before.lost);
    }
    EXPECT_EQ(now.duplicated > before.duplicated, profile.duplicate > 0);
}

TEST_P(Under, WhatIsCountedIsWhatTheNetworkDid) {
    setting.proxy.set({});  // a good network until the first report, so that the bridge sends none twice
    Client client = setting.remote(250);  // Hz: rare enough that the kernel never has to drop one
    Observer observer = client.observe();
    ASSERT_TRUE(observer.next_report(20s));
    setting.pass(100);
    const NetworkProfile& profile = GetParam().profile;
    setting.proxy.set(profile);
    setting.pass(2000);
    setting.proxy.cut();  // only what has left the proxy still arrives
    const Ledger::Counts did = ledger.counts();
    Network counted;
    static_cast<void>(test::eventually([&] {
        if (!observer.connected()) return true;
        counted = observer.network();
        return counted.lost == did.lost && counted.late == did.late && counted.duplicated == did.duplicated;
    }));
    EXPECT_EQ(counted.lost, did.lost) << "seed " << seed;
    EXPECT_EQ(counted.late, did.late) << "seed " << seed;
    EXPECT_EQ(counted.duplicated, did.duplicated) << "seed " << seed;
    EXPECT_EQ(did.duplicated > 0, profile.duplicate > 0);
    if (profile.loss > 0) {
        EXPECT_GT(did.lost, 0u);
    }
    if (profile.reorder > 0) {
        EXPECT_GT(did.late, 0u);
    }
}

TEST_P(Under, TheClockIsKnownWithinWhatItSays) {
    Client client = setting.remote();
    Observer observer = client.observe();
    std::uint64_t looked = 0;
    const auto look = [&] {
        while (const auto report = observer.next_report(0ns)) {
            // Both ends are on this host, so the truth is known, except for the time of looking.
            const auto truth = [&] {
                return std::chrono::steady_clock::now().time_since_epoch() -
                       std::chrono::nanoseconds(report->read_ns);
            };
            const auto least = truth();
            const Age age = observer.age(*report);
            const auto most = truth();
            if (age.uncertainty > 10s) continue;  // no exchange yet
            EXPECT_LE(age.age - age.uncertainty, most) << "seed " << seed;
            EXPECT_GE(age.age + age.uncertainty, least) << "seed " << seed;
            ++looked;
        }
        const Network network = observer.network();
        if (network.round_trip > 0ns) {
            EXPECT_LE(std::chrono::abs(network.clock_offset), network.clock_uncertainty);
        }
    };
    setting.pass(1200, 10, look);
    // Delays vary so much that many reports are overtaken: there may be few in a second.
    setting.pass_until([&] { return looked > 20; }, look);
}

}  // namespace
}  // namespace knurl::bridge::test
