// Hosts with unrelated clocks: one has been up for a day longer than the other.

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <sched.h>

#include <knurl/link/clock.hpp>
#include <knurl/shm/fd.hpp>

#include "../rights.hpp"
#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

constexpr auto apart = 100'000s;

#ifndef CLONE_NEWTIME
constexpr int CLONE_NEWTIME = 0x80;
#endif

#if defined(__SANITIZE_THREAD__)
constexpr bool watched = true;
#else
constexpr bool watched = false;
#endif

/// While it lives, CLOCK_MONOTONIC of this process's children is `apart` ahead of this process's
/// (time_namespaces(7)). Without the right to create it, or the kernel's support, why() gives the reason.
class OtherClock {
  public:
    OtherClock()
        : before_(::open("/proc/self/ns/time_for_children", O_RDONLY | O_CLOEXEC)),
          made_(before_ && !watched && ::unshare(CLONE_NEWTIME) == 0) {
        if (!made_) {
            why_ = watched ? "setns wants a process of one thread, ThreadSanitizer adds its own"
                           : knurl::test::missing("a time namespace", std::strerror(errno),
                                                  "root has it, with CAP_SYS_ADMIN, on Linux 5.6 or later");
            return;
        }
        std::ofstream offsets("/proc/self/timens_offsets");
        offsets << "monotonic " << std::chrono::seconds(apart).count() << " 0" << std::endl;
        if (!offsets) why_ = "its offset cannot be set";
    }
    ~OtherClock() {
        // The clock must not stay changed for the following tests.
        if (made_ && ::setns(before_.get(), CLONE_NEWTIME) != 0) std::abort();
    }
    OtherClock(const OtherClock&) = delete;
    OtherClock& operator=(const OtherClock&) = delete;

    const std::string& why() const { return why_; }  // the reason why there is none; empty: there is one
    /// Moves this process into it as well. Must be called before the process has threads.
    void enter() const {
        const shm::UniqueFd space(::open("/proc/self/ns/time_for_children", O_RDONLY | O_CLOEXEC));
        ASSERT_EQ(::setns(space.get(), CLONE_NEWTIME), 0) << std::strerror(errno);
    }

  private:
    const shm::UniqueFd before_;
    const bool made_;
    std::string why_;
};

/// The servo's clock is `offset` ahead of ours.
void expect_right(const BridgeProcess& bridge, std::chrono::nanoseconds offset) {
    Client client = connect_to(bridge);
    Claim hand = client.claim("", {.update_interval = 20ms});
    auto force = hand.add(at_once({0.1, 0, 0}));
    hand.arm();
    read_until(hand, [](const HandReport& report) { return is_active(report); });
    for (int i = 0; i < 1000; ++i) {
        const auto report = hand.next_report(10s);
        ASSERT_TRUE(report);
        if (i % 20 == 0) {
            force.set(at_once({0.1, 0, 0}));
            hand.commit();
        }
        ASSERT_EQ(report->scene_force.x, 0.1) << "nobody is silent because his stamps are from another day";
        const auto truth = [&] {
            return std::chrono::nanoseconds(detail::monotonic_ns()) + offset -
                   std::chrono::nanoseconds(report->read_ns);
        };
        const auto least = truth();
        const Age age = hand.age(*report);
        const auto most = truth();
        ASSERT_GE(age.age + age.uncertainty, least);
        ASSERT_LE(age.age - age.uncertainty, most);
    }
    const Network network = hand.network();
    EXPECT_LE(std::chrono::abs(network.clock_offset - offset), network.clock_uncertainty);
    EXPECT_LE(network.clock_uncertainty, 10s) << "far less than what is between the clocks";
    EXPECT_LE(std::abs(network.drift), network.drift_uncertainty) << "they run equally fast";
    EXPECT_EQ(hand.timing().refused, 0u);
    EXPECT_GT(hand.timing().age_at_use, 0ns);
    EXPECT_LT(hand.timing().age_at_use, apart);
}

TEST(FarClock, a_servo_that_has_been_up_for_longer_is_read_right) {
    const OtherClock theirs;
    if (!theirs.why().empty()) GTEST_SKIP() << theirs.why();
    ServoProcess servo;
    BridgeProcess bridge;
    expect_right(bridge, apart);
}

TEST(FarClock, a_servo_that_has_just_come_up_is_read_right) {
    ServoProcess servo;
    BridgeProcess bridge;
    const OtherClock ours;
    if (!ours.why().empty()) GTEST_SKIP() << ours.why();
    ours.enter();
    if (HasFatalFailure()) return;
    expect_right(bridge, -apart);
}

}  // namespace
}  // namespace knurl::bridge::test
