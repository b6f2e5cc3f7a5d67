// An eavesdropper on the path sends recorded datagrams again, or modified copies: the force does not change,
// the eavesdropper gets no reports, and the bridge logs how many datagrams there were.

#include <cstring>
#include <mutex>

#include <poll.h>
#include <sys/socket.h>

#include <knurl/bridge/endpoint.hpp>

#include "setting.hpp"
#include "wire.hpp"

namespace knurl::bridge::test {
namespace {

struct Replay : testing::Test {
    using Datagram = std::vector<char>;

    /// All that came from the application so far.
    std::vector<Datagram> heard() {
        const std::scoped_lock lock(mutex);
        return recorded;
    }
    /// Sent by somebody on the application's host. A few per cycle, so that no buffer has to drop one.
    void send(const std::vector<Datagram>& datagrams) {
        const Endpoint to = resolve(setting.bridge.host_and_port());
        if (!attacker) attacker = shm::UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        for (std::size_t i = 0; i < datagrams.size(); ++i) {
            ASSERT_EQ(
                ::sendto(attacker.get(), datagrams[i].data(), datagrams[i].size(), 0, to.get(), to.length),
                static_cast<ssize_t>(datagrams[i].size()));
            if (i % 8 == 7) setting.pass(1);
        }
        setting.pass(100);
    }
    /// Since the trace was cleared.
    void expect_unmoved(double held) {
        for (const Cycle& cycle : setting.trace) ASSERT_EQ(cycle.scene, held) << "cycle " << cycle.number;
        EXPECT_EQ(setting.missed(), 0u) << "the judge must have seen all";
        pollfd one{.fd = attacker.get(), .events = POLLIN, .revents = 0};
        EXPECT_EQ(::poll(&one, 1, 0), 0) << "something was sent to the attacker";
    }
    /// Forces up to `most`, then `held`, which no earlier datagram contains.
    void vary(Remote& remote, double most, double held) {
        int n = 0;
        setting.pass(800, 8, [&] { remote.commit(along_x(most * (++n % 10 + 1) / 10)); });
        remote.commit(along_x(held));
        setting.pass_until([&] { return setting.felt() == held; }, [] {});
        setting.trace.clear();
    }

    std::mutex mutex;
    std::vector<Datagram> recorded;
    shm::UniqueFd attacker;
    Setting setting{{}, 1, Keyed::yes, [this](proxy::Way way, Proxy::At at, std::span<const char> datagram) {
                        if (way != proxy::Way::forth || at != Proxy::At::entry) return;
                        const std::scoped_lock lock(mutex);
                        recorded.emplace_back(datagram.begin(), datagram.end());
                    }};
};

TEST_F(Replay, OfALiveSessionMovesNothingAndIsCounted) {
    std::optional<Remote> remote(std::in_place, setting, along_x(0.01),
                                 AddOptions{.on_silence = OnSilence::hold});
    vary(*remote, 0.4, 0.05);
    const auto all = heard();
    ASSERT_GT(all.size(), 100u);
    send(all);
    expect_unmoved(0.05);
    EXPECT_EQ(remote->hand.reattachments(), 0u);
    remote.reset();
    const std::string out = setting.bridge.line_with("out: ");
    says(out,
         "dropped: " + std::to_string(all.size()) + " datagrams that had come before or were too old, 0 ");
}

TEST_F(Replay, OfAnEarlierSessionMovesNothingAndIsCounted) {
    std::optional<Remote> remote(std::in_place, setting, along_x(0.01),
                                 AddOptions{.on_silence = OnSilence::hold});
    vary(*remote, 0.4, 0.05);
    const auto all = heard();
    remote.reset();
    says(setting.bridge.line_with("out: "), "out: ");
    remote.emplace(setting, along_x(0.02),
                   AddOptions{.on_silence = OnSilence::hold});  // the same key, another session
    send(all);
    expect_unmoved(0.02);
    says(setting.bridge.line_with("of no session"), "datagrams of no session were dropped");
}

TEST_F(Replay, UnderAnotherSessionsNameOrANewCounterIsNobodys) {
    std::optional<Remote> remote(std::in_place, setting, along_x(0.01),
                                 AddOptions{.on_silence = OnSilence::hold});
    vary(*remote, 0.4, 0.05);
    auto before = heard();
    remote.reset();
    remote.emplace(setting, along_x(0.02), AddOptions{.on_silence = OnSilence::hold});
    vary(*remote, 0.4, 0.03);
    auto now = heard();
    now.erase(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(before.size()));
    const Datagram newest = now.back();
    std::uint64_t counter = std::uint64_t{1} << 40;
    // Headers are not encrypted, so the attacker can insert the open session, and counters that were never
    // seen.
    for (auto* group : {&before, &now})
        for (Datagram& each : *group) {
            DatagramHeader header;
            std::memcpy(&header, newest.data(), sizeof header);
            const std::uint64_t session = header.session;
            std::memcpy(&header, each.data(), sizeof header);
            header.session = session;
            header.counter = ++counter;
            std::memcpy(each.data(), &header, sizeof header);
        }
    send(before);
    send(now);
    expect_unmoved(0.03);
    remote.reset();
    says(setting.bridge.line_with("out: "), "out: ");  // of the first
    says(setting.bridge.line_with("out: "), "dropped: 0 datagrams that had come before or were too old, " +
                                                std::to_string(before.size() + now.size()) +
                                                " that were not its own");
}

}  // namespace
}  // namespace knurl::bridge::test
