// A local application and one on another host push on one device together.

#include <csignal>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "setting.hpp"

namespace knurl::bridge::test {
namespace {

constexpr double ours = 0.2, theirs = 0.4;  // N

/// Pushes, on the other host, until it is killed.
[[noreturn]] void push(const Setting& setting) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    try {
        Client client = setting.remote();
        Claim hand = client.claim("", {.shared = true, .update_interval = 20ms});
        hand.add(along_x(theirs));
        hand.arm();
        for (;;) {
            hand.next_report(10ms);
            hand.commit();
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "the remote application: %s\n", error.what());
    }
    ::_exit(1);
}

TEST(Together, TheirForcesAddAndOneThatIsKilledTakesAwayItsOwnAlone) {
#if defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "it forks beside threads, of which the child then lacks those of ThreadSanitizer";
#endif
    Setting setting({.delay = 0.002});
    const pid_t remote = ::fork();
    if (remote == 0) push(setting);
    Client client = Client::connect("knurl:default", {.name = "local", .wait = 20s});
    Claim hand = client.claim("", {.shared = true, .update_interval = 20ms});
    // It holds: a machine that keeps this program off its CPUs for 100 ms fades nothing of ours.
    hand.add(along_x(ours), {.on_silence = OnSilence::hold});
    hand.arm();
    const auto commit = [&] { hand.commit(); };
    const auto both = [&] { return std::abs(setting.felt() - (ours + theirs)) < 1e-12; };
    setting.pass_until([&] { return setting.state == DeviceState::active && both(); }, commit);
    setting.trace.clear();
    setting.pass(500, 20, commit);
    for (const Cycle& cycle : setting.trace) ASSERT_NEAR(cycle.scene, ours + theirs, 1e-12) << cycle.number;

    setting.trace.clear();
    ::kill(remote, SIGKILL);
    ::waitpid(remote, nullptr, 0);
    setting.pass(500, 20, commit);
    std::uint64_t alone = setting.trace.size();
    while (alone > 0 && std::abs(setting.trace[alone - 1].scene - ours) < 1e-12) --alone;
    EXPECT_LE(alone, 250u) << "cycles: its connection has ended, nobody waits for its silence";
    expect_no_bumps(setting.trace, 1.2 * theirs / 0.05);
    double before = ours + theirs + 1e-12;
    for (const Cycle& cycle : setting.trace) {
        ASSERT_LE(cycle.scene, before) << "it fades, cycle " << cycle.number;
        ASSERT_GE(cycle.scene, ours - 1e-12) << "and nothing of ours with it, cycle " << cycle.number;
        before = cycle.scene + 1e-12;
    }
    EXPECT_EQ(setting.state, DeviceState::active);
    EXPECT_EQ(hand.reattachments(), 0u);
}

}  // namespace
}  // namespace knurl::bridge::test
