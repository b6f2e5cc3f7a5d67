// A hand with six degrees of freedom, on a virtual clock: what it holds turns it, and several fingers push.

#include <gtest/gtest.h>
#include <trial.hpp>

namespace {

using namespace bodies;

constexpr double g = 9.81;  // m/s^2

/// Takes a bar off its middle, lifts it, and rests.
Script lifted(const Vector3d& at) {
    Script script(at + Vector3d(0, 0, 0.02));
    script.rest(0.3).to(at, 0.05).rest(0.2).take().rest(0.2).to(at + Vector3d(0, 0, 0.04), 0.05).rest(3);
    return script;
}

TEST(BodiesTorque, ABarThatIsHeldBesideItsMiddleTurnsTheHandByItsWeightTimesTheLever) {
    for (const double side : {0.02, -0.015}) {  // m, from its middle to where it is taken
        SCOPED_TRACE(side);
        const double mass = 0.1, floor = Tray{}.floor;
        World world(
            {{.name = "bar", .half = {0.03, 0.01, 0.01}, .mass = mass, .position = {0, 0, floor + 0.01}}});
        Vector3d force = Vector3d::Zero(), torque = force, hand = force;
        const Trial trial = run_trial(world, lifted({side, 0, floor + 0.025}), {.device = "generic6"},
                                      [&](const Moment& moment) {
                                          force = knurl::to_eigen(moment.report.scene_force);
                                          torque = knurl::to_eigen(moment.report.scene_torque);
                                          hand = knurl::to_eigen(moment.report.position);
                                      });
        EXPECT_EQ(trial.faults, 0u);
        ASSERT_GT(world.after(0).position.z(), floor + 0.015) << "it hangs";
        const Vector3d weight(0, 0, -mass * g);
        const Vector3d turning = (world.after(0).position - hand).cross(weight);
        ASSERT_GT(std::abs(turning.y()), 0.01) << "N m: there is something to be seen";
        EXPECT_LT((force - weight).norm(), 0.02 * weight.norm());
        EXPECT_LT((torque - turning).norm(), 0.05 * turning.norm())
            << torque.transpose() << " and " << turning.transpose();
        EXPECT_LT(torque.y() * side, 0) << "held right of its middle it goes down on the left";
    }
}

TEST(BodiesTorque, ThreeFingersPushLiftAndStack) {
    constexpr std::size_t slab = 0, cube = 1;
    for (const char* device : {"premium15", "generic6"}) {
        SCOPED_TRACE(device);
        World world(usual_bodies());
        const Vector3d at_first = world.after(cube).position;
        double pushed = 0, torque = 0;
        CoupledOptions coupled;
        coupled.fingers = {{0, 0, 0}, {0, 0.012, 0}, {0, -0.012, 0}};
        const Trial trial = run_trial(
            world, push_take_and_stack(), {.coupled = coupled, .device = device}, [&](const Moment& moment) {
                if (moment.t < 4) pushed = world.after(cube).position.x() - at_first.x();
                torque = std::max(torque, knurl::to_eigen(moment.report.sent_torque).norm());
            });
        EXPECT_EQ(trial.faults, 0u);
        EXPECT_GT(pushed, 0.01);
        const Vector3d end = world.after(cube).position, on = world.after(slab).position;
        EXPECT_NEAR(end.z(), on.z() + world.bodies()[slab].half.z() + world.bodies()[cube].half.z(), 1e-3);
        EXPECT_LT(trial.jump, 1.5);
        EXPECT_LE(trial.gained, trial.account.hand);
        if (device == std::string("generic6")) {
            EXPECT_GT(torque, 1e-3) << "N m";
        } else {
            EXPECT_EQ(torque, 0) << "it has no motors for that";
        }
    }
}

/// A block beside the hand: only the hand's other finger touches it.
TEST(BodiesTorque, AFingerBesideTheMiddleTurnsTheHandByItsForceTimesItsLever) {
    World world({{.name = "block", .half = {0.02, 0.01, 0.02}, .mass = 0.5, .position = {0, 0.02, -0.03}}});
    Script script({-0.04, 0, -0.03});
    script.rest(0.3).to({-0.017, 0, -0.03}, 0.03).rest(1);
    Vector3d force = Vector3d::Zero(), torque = force, lever = force;
    CoupledOptions coupled;
    coupled.fingers = {{0, 0, 0}, {0, -0.02, 0}};  // -0.02: this device's hand is rotated by half a turn
    coupled.touch.friction = 0;
    const TrialOptions options{.coupled = coupled, .device = "generic6"};
    const Trial trial = run_trial(world, script, options, [&](const Moment& moment) {
        force = knurl::to_eigen(moment.report.scene_force);
        torque = knurl::to_eigen(moment.report.scene_torque);
        lever = knurl::to_eigen(moment.report.orientation) * coupled.fingers[1];
    });
    EXPECT_EQ(trial.faults, 0u);
    ASSERT_GT(lever.y(), 0.015) << "m: the finger is before the block";
    ASSERT_LT(force.x(), -0.3) << "N: it is pushed back by what it presses on";
    EXPECT_LT((torque - lever.cross(force)).norm(), 0.05 * torque.norm());
    EXPECT_GT(torque.z(), 0.005) << "N m: its finger on the left is pushed back, so it turns to the left";
}

}  // namespace
