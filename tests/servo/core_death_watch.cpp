// The thread that sees clients die: what a connection held fades when it hangs up, and nothing else does.

#include <array>
#include <thread>

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <knurl/reps/plane.hpp>
#include <knurl/servo/death_watch.hpp>

#include "../eventually.hpp"
#include "core_support.hpp"

namespace knurl::servo::core_death_watch_tests {
namespace {

using namespace testing;
using test::eventually;

struct Connection {
    shm::UniqueFd ours, theirs;
    Connection() {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
        ours = shm::UniqueFd(ends[0]);
        theirs = shm::UniqueFd(ends[1]);
    }
    void hang_up() { theirs.reset(); }
};

/// A servo with claims of which each has a plane of 500 N/m, the hand 1 mm deep.
class DeathWatched : public ::testing::Test {
  protected:
    ~DeathWatched() override { deaths.stop(); }

    std::size_t add_claim() {
        ClaimTerms terms;
        terms.capacity = {.representations = 1, .batch_bytes = 512};
        terms.frame = frame_for(device.link(), {});
        terms.limits = limits_for(device.link(), 1000, terms.frame);
        terms.shared = true;
        claims.push_back(std::make_unique<OfflineClaim>(terms));
        EXPECT_TRUE(servo.adopt(&claims.back()->servo_side()));
        claims.back()->add(Plane{.stiffness = 500, .recovery = 0});
        claims.back()->arm();
        run(600);
        return claims.size() - 1;
    }
    Claim& claim(std::size_t i) { return claims[i]->servo_side(); }
    void run(int cycles) {
        for (int i = 0; i < cycles; ++i) {
            clock.time += 1'000'000;
            servo.step(clock.time, clock.time);
        }
    }
    /// Planes that are felt.
    double felt() { return device.force().z() / 0.5; }
    bool soon(double planes) {
        return eventually([&] {
            run(60);  // a fade takes 50
            return std::abs(felt() - planes) < 1e-9;
        });
    }

    struct FixedClock final : Clock {
        Nanoseconds time = 0;
        Nanoseconds now() noexcept override { return time; }
    };
    static ServoOptions without_silence() {
        ServoOptions options = live_options();
        options.silence = false;
        return options;
    }
    PuppetDevice device = at_depth();
    static PuppetDevice at_depth() {
        PuppetDevice device;
        device.tip = {0, 0, -1e-3};
        return device;
    }
    FixedClock clock;
    OfflineMemory memory{protocol::device_layout().total};
    Servo servo{device, clock, memory.data(), without_silence()};
    std::vector<std::unique_ptr<OfflineClaim>> claims;
    DeathWatch deaths;
    std::jthread thread{[this] { deaths.run(); }};
};

TEST_F(DeathWatched, WhatAConnectionHeldFadesWhenItHangsUp) {
    Connection one, other;
    deaths.watch(1, one.ours.get());
    deaths.watch(2, other.ours.get());
    deaths.hold(1, servo, claim(add_claim()));
    deaths.hold(2, servo, claim(add_claim()));
    deaths.hold(1, servo, claim(add_claim()));
    EXPECT_TRUE(soon(3));
    one.hang_up();
    EXPECT_TRUE(soon(1)) << felt();
    EXPECT_EQ(servo.released(), &claim(0));
    EXPECT_EQ(servo.released(), &claim(2));
    EXPECT_EQ(servo.released(), nullptr);

    // The broker was busy while its owner died, and serves one more claim of it.
    deaths.hold(1, servo, claim(add_claim()));
    EXPECT_TRUE(soon(1)) << felt();
    EXPECT_EQ(servo.released(), &claim(3));
}

TEST_F(DeathWatched, WhatItHasGivenBackDoesNot) {
    Connection one, other;
    deaths.watch(1, one.ours.get());
    deaths.watch(2, other.ours.get());
    const std::size_t kept = add_claim(), dropped = add_claim();
    deaths.hold(1, servo, claim(kept));
    deaths.hold(1, servo, claim(dropped));
    deaths.release(1, claim(kept));
    deaths.hold(2, servo, claim(kept));
    one.hang_up();
    EXPECT_TRUE(soon(1)) << felt();
    EXPECT_EQ(servo.released(), &claim(dropped));
    deaths.forget(2, other.ours.get());
    other.hang_up();
    // A third one's death shows that the second's would have been seen by now.
    Connection third;
    deaths.watch(3, third.ours.get());
    const std::size_t last = add_claim();
    deaths.hold(3, servo, claim(last));
    third.hang_up();
    EXPECT_TRUE(eventually([&] {
        run(60);
        return servo.released() == &claim(last);
    }));
    EXPECT_TRUE(soon(1)) << "nobody watches the one that is kept";
}

}  // namespace
}  // namespace knurl::servo::core_death_watch_tests
