// The simulated hand: its behaviour with a motion, a push, a grip and a tremor.

#include <cmath>

#include <gtest/gtest.h>

#include <knurl/drivers/sim_device.hpp>

namespace knurl::drivers::sim_hand_tests {
namespace {

using Eigen::Vector3d;

constexpr Nanoseconds millisecond = 1'000'000;

/// A device and its clock.
struct Bench {
    SimDevice device;
    Nanoseconds now = 0;
    JointSample sample = {};

    explicit Bench(const std::string& address, const std::optional<Motion>& hand = {})
        : device(sim_profile(address), hand) {
        device.read(0, sample);
    }
    const SimState& run(double seconds) {
        for (const Nanoseconds end = now + std::llround(seconds * 1e9); now < end;) {
            device.read(now += millisecond, sample);
        }
        return device.state();
    }
};

Motion stroke() {
    return parse_motion("0,0.02,0,0.01\n1,0.06,0.02,0.01\n1.5,0.06,0.02,-0.01\n", "stroke");
}

TEST(Hand, WithoutAMotionHoldsTheTipInTheCentre) {
    for (const std::string& profile : sim_profile_names()) {
        Bench bench(profile);
        bench.device.notify(Notice::claim_active);  // has nothing to play
        EXPECT_LT(bench.run(1).position.norm(), 1e-12) << profile;
    }
}

TEST(Hand, RestsAtTheStartOfItsMotionUntilAClaimIsActive) {
    Bench bench("premium15", stroke());
    EXPECT_LT((bench.device.state().position - Vector3d(0.02, 0, 0.01)).norm(), 1e-9);
    EXPECT_LT((bench.run(1).position - Vector3d(0.02, 0, 0.01)).norm(), 1e-9);
    bench.device.notify(Notice::enabled);
    EXPECT_LT((bench.run(1).position - Vector3d(0.02, 0, 0.01)).norm(), 1e-9);
    bench.device.notify(Notice::claim_active);
    EXPECT_GT((bench.run(0.5).position - Vector3d(0.02, 0, 0.01)).norm(), 0.015);
}

TEST(Hand, FollowsItsMotionWithinWhatItsSpringsAllow) {
    Bench bench("cartesian3,coulomb=0", stroke());
    bench.device.notify(Notice::claim_active);
    bench.run(0.9);
    // At constant speed on a straight line the spring must overcome only the device's own damping, 0.2 N s/m.
    const Vector3d wanted = bench.device.state().hand_wants;
    EXPECT_LT((wanted - stroke().sample(0.8999).position).norm(), 1e-6);
    const Vector3d velocity(0.04, 0.02, 0);
    EXPECT_LT((bench.device.state().position - (wanted - 0.2 * velocity / 200)).norm(), 2e-5);
    EXPECT_LT((bench.run(2).position - Vector3d(0.06, 0.02, -0.01)).norm(), 1e-6) << "stays at the last row";
}

TEST(Hand, PlaysFromItsStartEachTimeThatAClaimBecomesActive) {
    Bench bench("cartesian3,push=1.5", stroke());
    double farthest = 0;
    Vector3d middle[3];
    for (Vector3d& at : middle) {
        bench.device.notify(Notice::claim_active);
        at = bench.run(0.7).position;
        bench.run(1);
        bench.device.notify(Notice::disabled);
        const Vector3d before = bench.device.state().hand_wants;
        EXPECT_LT((bench.run(0.001).hand_wants - before).norm(), 1e-3) << "goes back without a jump";
        EXPECT_LT((bench.run(2).hand_wants - Vector3d(0.02, 0, 0.01)).norm(), 1e-12);
        farthest = std::max(farthest, (at - middle[0]).norm());
    }
    EXPECT_LT(farthest, 1e-5) << "equal claims are equal strokes";
}

TEST(Hand, ThatIsAwayFromTheStartWhenItBeginsDoesNotJump) {
    Bench bench("cartesian3", stroke());
    bench.device.notify(Notice::claim_active);
    bench.run(1.5);
    const Vector3d before = bench.device.state().hand_wants;
    bench.device.notify(Notice::claim_active);  // again, at once, from the end
    Vector3d last = before;
    double fastest = 0;
    for (int i = 0; i < 400; ++i) {
        const Vector3d now = bench.run(0.001).hand_wants;
        fastest = std::max(fastest, (now - last).norm() / 1e-3);
        last = now;
    }
    EXPECT_LT(fastest, 0.35) << "m/s: 50 mm by minimum jerk in 0.4 s";
    EXPECT_LT((bench.run(0.1).hand_wants - stroke().sample(0.4999).position).norm(), 1e-5)
        << "and catches up";
}

TEST(Hand, PushesDownWhileItPlays) {
    Bench bench("cartesian3,push=1.5,coulomb=0", parse_motion("0,0,0,0\n9,0,0,0\n", "still"));
    EXPECT_LT(std::abs(bench.run(0.5).position.z()), 1e-12);
    bench.device.notify(Notice::claim_active);
    // Nothing below: 1.5 N against 60 N/m along z.
    EXPECT_NEAR(bench.run(3).position.z(), -1.5 / 60, 1e-5);
    // A floor that holds it at its path gets the 1.5 N.
    for (int i = 0; i < 3000; ++i) {
        const double z = bench.device.state().position.z(), v = bench.device.state().velocity.z();
        bench.device.write(bench.now, {0, 0, std::max(0.0, -2000 * z - 5 * v)});
        bench.run(0.001);
    }
    EXPECT_NEAR(bench.device.state().hand_force.z(), -1.5 - 60 * bench.device.state().position.z(), 1e-3);
    EXPECT_NEAR(bench.device.state().position.z(), -1.5 / 2060, 3e-5);
    bench.device.write(bench.now, {});
    bench.device.notify(Notice::disabled);
    EXPECT_NEAR(bench.run(2).position.z(), 0, 1e-5) << "the push goes with the claim";
}

TEST(Hand, GripScalesItAndItsDampingIsStatedWhileItHolds) {
    Bench bench("cartesian3,grip=0.5");
    EXPECT_EQ(bench.device.link().grip_damping, 1.5);
    bench.device.set_grip(0);
    EXPECT_EQ(bench.device.link().grip_damping, 0);
    bench.device.place({0.02});
    EXPECT_EQ(bench.run(0.5).position.x(), 0.02) << "nobody holds it";
    bench.device.set_grip(1);
    EXPECT_EQ(bench.device.link().grip_damping, 3);
    EXPECT_LT(std::abs(bench.run(2).position.x()), 0.05 / 200 + 1e-6) << "back, but for dry friction";
}

TEST(Hand, TremblesAtTheStatedSizeBetweenEightAndTwelveHertz) {
    // A heavy tip hardly moves: then the force is the tremor.
    Bench bench("cartesian3,mass=5,hand=0,hand_damping=0,tremor=0.2,seed=9,damping=20");
    double square = 0, sine[20] = {}, cosine[20] = {};
    constexpr int samples = 20000;
    for (int i = 0; i < samples; ++i) {
        const double f = bench.run(0.001).hand_force.x();
        square += f * f;
        for (int hz = 1; hz < 20; ++hz) {
            sine[hz] += f * std::sin(2 * M_PI * hz * i * 1e-3);
            cosine[hz] += f * std::cos(2 * M_PI * hz * i * 1e-3);
        }
    }
    EXPECT_NEAR(std::sqrt(square / samples), 0.2, 0.02);
    double inside = 0, outside = 0;
    for (int hz = 1; hz < 20; ++hz) {
        (hz >= 8 && hz <= 12 ? inside : outside) += std::hypot(sine[hz], cosine[hz]);
    }
    EXPECT_GT(inside, outside);
}

TEST(Hand, TremorRepeatsWithItsSeedAlone) {
    const auto digest = [](const std::string& seed) {
        Bench bench("cartesian3,tremor=0.3,seed=" + seed);
        bench.run(0.3);
        return bench.device.digest();
    };
    EXPECT_EQ(digest("7"), digest("7"));
    EXPECT_NE(digest("7"), digest("8"));
}

TEST(Hand, TurnsATipThatHasOrientation) {
    Bench bench("generic6");
    const Eigen::Quaterniond rest = bench.device.state().orientation;
    const Eigen::Quaterniond goal = Eigen::AngleAxisd(0.4, Vector3d(1, 1, 0).normalized()) * rest;
    const Motion turn({{.t = 0, .orientation = rest}, {.t = 1, .orientation = goal}}, true);
    Bench turning("generic6", turn);
    EXPECT_LT(turning.device.state().orientation.angularDistance(rest), 1e-9);
    turning.device.notify(Notice::claim_active);
    EXPECT_LT(turning.run(3).orientation.angularDistance(goal), 1e-3);
    EXPECT_LT(turning.device.state().position.norm(), 1e-3);

    // A motion that starts with a rotation: the device does, too.
    Bench turned("generic6", Motion({{.t = 0, .position = {0.02, 0.01, 0}, .orientation = goal}}, true));
    EXPECT_LT(turned.device.state().orientation.angularDistance(goal), 1e-6);
    EXPECT_LT(turned.run(0.5).orientation.angularDistance(goal), 1e-3);
}

}  // namespace
}  // namespace knurl::drivers::sim_hand_tests
