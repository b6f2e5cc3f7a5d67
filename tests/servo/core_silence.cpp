// When an application counts as silent, and what happens to its force. Virtual time.

#include <knurl/reps/plane.hpp>

#include "core_support.hpp"

namespace knurl::servo {
namespace {

using namespace testing;

/// A hand 1 mm inside a plane of 500 N/m, active; the application commits when told.
struct Held {
    PuppetDevice device;
    Offline servo;
    OfflineClaim* claim = nullptr;

    explicit Held(double stated = 0, OnSilence on_silence = OnSilence::fade,
                  const ServoOptions& options = live_options(), double delay_allowance = 0)
        : servo(device, options) {
        device.tip = {0, 0, -1e-3};
        ClaimTerms terms;
        terms.update_interval = stated;
        terms.delay_allowance = delay_allowance;
        claim = &servo.claim(terms);
        claim->add(Plane{.stiffness = 500}, {.on_silence = on_silence});
        claim->arm();
        claim->commit();
        run(servo, 700);
        EXPECT_EQ(servo.servo().last().state, DeviceState::active);
    }
    double force() { return servo.servo().last().scene_force.z; }
    void commit_every(int cycles, int times) {
        for (int i = 0; i < times; ++i) {
            claim->commit();
            run(servo, cycles);
        }
    }
    /// Cycles without a commit until the force goes down.
    int cycles_until_fading(int limit = 10'000) {
        const double before = force();
        for (int i = 0; i < limit; ++i)
            if (servo.step().scene_force.z < before * 0.999) return i + 1;
        return limit;
    }
};

TEST(Silence, UntilThreeIntervalsWereMeasuredItIsThreeAndAHalfSeconds) {
    Held held;
    const int already = 700;
    EXPECT_NEAR(held.cycles_until_fading() + already, 3500, 5);

    Held two;
    two.commit_every(50, 2);  // with the first commit: two intervals, the first of 700 ms
    EXPECT_NEAR(two.cycles_until_fading() + 50, 3500, 5);
}

TEST(Silence, ComesLaterByWhatANetworkMayDelay) {
    for (const double stated : {0.05, 0.2}) {
        Held near(stated), far(stated, OnSilence::fade, live_options(), 0.2);
        near.commit_every(50, 10);
        far.commit_every(50, 10);
        EXPECT_NEAR(far.cycles_until_fading() - near.cycles_until_fading(), 200, 2);
    }
    Held measured(0, OnSilence::fade, live_options(), 0.2);
    measured.commit_every(50, 40);
    EXPECT_NEAR(measured.cycles_until_fading() + 50, 450, 10);
}

TEST(Silence, CommandsThatWaitBehindUnreadRepliesAreNoSignOfLife) {
    Held held;
    held.commit_every(50, 40);
    // More commands than replies fit: the rest stays in the ring, and its sender hangs.
    for (std::uint32_t i = 0; i < protocol::reply_cells + 500; ++i) held.claim->place_probe(1, {});
    EXPECT_LT(held.cycles_until_fading(), 300);
}

TEST(Silence, SignsOfLifeKeepTheForceAndAreNoCommits) {
    Held held;
    held.commit_every(50, 40);
    const double before = held.force();
    for (int i = 0; i < 100; ++i) {  // 20 s without a commit
        held.claim->keep_alive();
        run(held.servo, 200);
        held.claim->replies();
        ASSERT_EQ(held.force(), before) << i;
    }
    // Had they counted as commits, the interval would be 200 ms by now, and the limit 600.
    EXPECT_NEAR(held.cycles_until_fading() + 200, 250, 5);
}

TEST(Silence, OfAFastApplicationItIsAQuarterOfASecond) {
    Held held;
    held.commit_every(50, 40);
    EXPECT_NEAR(held.cycles_until_fading() + 50, 250, 5);
}

TEST(Silence, OfASlowApplicationItIsThreeMeasuredIntervals) {
    Held held;
    held.commit_every(400, 20);
    EXPECT_NEAR(held.cycles_until_fading() + 400, 1200, 30);
}

TEST(Silence, AStatedIntervalIsUsedInsteadOfAMeasuredOne) {
    Held held(0.5);
    held.commit_every(20, 40);
    EXPECT_NEAR(held.cycles_until_fading() + 20, 1500, 5);

    Held fast(0.01);
    EXPECT_EQ(fast.force(), 0) << "700 ms without a commit, a quarter of a second is allowed";
}

TEST(Silence, AnEmptyCommitIsASignOfLife) {
    Held held;
    held.commit_every(100, 100);
    EXPECT_NEAR(held.force(), 0.5, 1e-12);
    EXPECT_EQ(held.claim->feedback().header.silence, 0);
}

TEST(Silence, TheForceFadesWithinATenthOfASecondAndCommitsBringItBack) {
    Held held;
    held.commit_every(50, 40);
    held.cycles_until_fading();
    run(held.servo, 105);
    EXPECT_EQ(held.force(), 0);
    EXPECT_GT(held.claim->feedback().header.silence, 0);
    EXPECT_NE(held.claim->feedback().entries.at(0).flags & Feedback::silent, 0u);

    held.commit_every(50, 20);
    EXPECT_NEAR(held.force(), 0.5, 1e-9);
    EXPECT_EQ(held.claim->feedback().header.silence, 0);
}

TEST(Silence, OfAClaimWithNothingInItIsSaidOnce) {
    PuppetDevice device;
    Offline servo(device, live_options());
    OfflineClaim& claim = servo.claim(ClaimTerms{});
    claim.commit();
    run(servo, 5000);
    const protocol::FeedbackHeader said = claim.feedback().header;
    EXPECT_GT(said.silence, 0);
    run(servo, 1000);
    EXPECT_EQ(claim.feedback().header.cycle, said.cycle) << "a hundred of them cost nothing";
    claim.commit();
    run(servo, 2);
    EXPECT_EQ(claim.feedback().header.silence, 0);
    EXPECT_GT(claim.feedback().header.cycle, said.cycle);
}

TEST(Silence, AStaticSceneIsHeldIfItsOwnerAskedForThat) {
    Held held(0, OnSilence::hold);
    held.commit_every(50, 40);
    run(held.servo, 10'000);
    EXPECT_NEAR(held.force(), 0.5, 1e-12);
}

TEST(Silence, OneHangDoesNotSpoilTheMeasurement) {
    Held held;
    held.commit_every(50, 40);
    run(held.servo, 60'000);  // a minute in a debugger
    held.commit_every(50, 40);
    EXPECT_NEAR(held.cycles_until_fading() + 50, 250, 5);
}

TEST(Silence, OfflineThereIsNone) {
    PuppetDevice device;
    device.tip = {0, 0, -1e-3};
    Offline servo(device);
    servo.claim().add(Plane{.stiffness = 500});
    run(servo, 20'000);
    EXPECT_NEAR(servo.servo().last().scene_force.z, 0.5, 1e-12);
}

TEST(Silence, TheMeasuredIntervalSetsWhatAutomaticRecoveryMeans) {
    // 20 % of the interval within 2 to 50 ms, and at most the interval: the cycles over which a change
    // reaches the hand.
    const auto cycles_of_fade = [](int interval) {
        ServoOptions options = live_options();
        options.rise_speed = 1e9;
        Held held(0, OnSilence::fade, options);
        const RepresentationId plane{0, 1};
        held.commit_every(interval, 160);  // the mean forgets the beginning
        held.claim->update(plane, Plane{.stiffness = 250});
        held.claim->commit();
        int cycles = 0;
        do {
            held.servo.step();
            ++cycles;
        } while (held.force() > 0.25 + 1e-9 && cycles < 1000);
        return cycles;
    };
    EXPECT_NEAR(cycles_of_fade(50), 10, 1);
    EXPECT_NEAR(cycles_of_fade(5), 2, 1);
    EXPECT_EQ(cycles_of_fade(1), 1);
    EXPECT_NEAR(cycles_of_fade(200), 40, 2);
    EXPECT_NEAR(cycles_of_fade(1000), 50, 2);
}

}  // namespace
}  // namespace knurl::servo
