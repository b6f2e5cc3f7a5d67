// Pushing, holding and stacking on a virtual clock: servo, hand and engine in step.

#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <trial.hpp>

#include "compare.hpp"

namespace {

using namespace bodies;

constexpr std::size_t slab = 0, cube = 1;

struct AtRate : testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Frames, AtRate, testing::Values(60, 120, 250, 500));

TEST_P(AtRate, ABoxIsPushedAlongTheFloorTakenAndSetOnAnother) {
    World world(usual_bodies());
    const Vector3d at_first = world.after(cube).position;
    double pushed = 0, highest = 0;
    const Trial trial =
        run_trial(world, push_take_and_stack(), {.rate = GetParam()}, [&](const Moment& moment) {
            const Vector3d here = world.after(cube).position;
            if (moment.t < 4) pushed = here.x() - at_first.x();
            highest = std::max(highest, here.z());
        });
    EXPECT_EQ(trial.faults, 0u);
    EXPECT_GT(pushed, 0.01) << "along the floor";
    EXPECT_GT(highest, 0) << "it was lifted";
    const Vector3d end = world.after(cube).position;
    const double on_top =
        world.after(slab).position.z() + world.bodies()[slab].half.z() + world.bodies()[cube].half.z();
    EXPECT_NEAR(end.z(), on_top, 1e-3);
    EXPECT_LT((end - world.after(slab).position).head<2>().norm(), 0.015);
    EXPECT_LT(trial.jump, 1);
    EXPECT_NEAR(trial.gained, world.bodies()[cube].mass * 9.81 * (end.z() - at_first.z()), 1e-3);
    EXPECT_LE(trial.gained, trial.account.hand);
}

TEST(BodiesTrial, TheSameTwiceToTheLastBit) {
    Vector3d ends[2];
    for (Vector3d& end : ends) {
        World world(usual_bodies());
        run_trial(world, push_take_and_stack(), {});
        end = world.after(cube).position;
    }
    EXPECT_EQ(ends[0], ends[1]);
}

Script rough(unsigned seed, double seconds) {
    std::mt19937 random(seed);
    const auto in = [&](double low, double high) {
        return std::uniform_real_distribution<>(low, high)(random);
    };
    Script script({0, 0, 0.02});
    bool holds = false;
    while (script.end() < seconds) {
        script.to({in(-0.08, 0.08), in(-0.08, 0.08), in(-0.06, 0.02)}, in(0.1, 0.6));
        if (in(0, 1) < 0.5) {
            if (holds)
                script.let_go();
            else
                script.take();
            holds = !holds;
        }
    }
    return script;
}

TEST_P(AtRate, RoughlyHandledBodiesHaveNoMoreEnergyThanTheHandPutIn) {
    for (const unsigned seed : {1u, 2u}) {
        World world(usual_bodies());
        const Trial trial = run_trial(world, rough(seed, 15), {.rate = GetParam()});
        SCOPED_TRACE("seed " + std::to_string(seed));
        EXPECT_EQ(trial.faults, 0u);
        EXPECT_GT(trial.account.hand_in, 0.02) << "it was handled";
        EXPECT_GT(trial.short_of, 0u) << "nothing was at stake";
        EXPECT_LE(trial.gained, trial.account.hand);
        EXPECT_LE(trial.account.body, trial.account.hand) << "given to the bodies, and put in by the hand, J";
    }
}

/// The largest excess (J) of the bodies' energy over the hand's input so far, for light bodies that are
/// pushed at random, with high stiffness, at 60 frames a second.
double most_from_nothing(unsigned seed, const CoupledOptions& coupled) {
    World world({{.name = "box", .half = {0.02, 0.02, 0.02}, .mass = 0.05, .position = {0.02, 0, -0.03}},
                 {.name = "other", .half = {0.02, 0.02, 0.02}, .mass = 0.1, .position = {-0.03, 0, -0.03}}});
    std::mt19937 random(seed);
    const auto in = [&](double low, double high) {
        return std::uniform_real_distribution<>(low, high)(random);
    };
    Script script({0, 0, 0.02});
    while (script.end() < 10) script.to({in(-0.06, 0.06), in(-0.05, 0.05), in(-0.035, 0)}, in(0.05, 0.3));
    const double before = world.energy();
    double most = 0;
    run_trial(world, script, {.rate = 60, .coupled = coupled},
              [&](const Moment& moment) { most = std::max(most, world.energy() - before - moment.put_in); });
    return most;
}

TEST(BodiesTrial, ThereIsNeverMuchFromNothingAndWithoutTheAccountThereIs) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        CoupledOptions kept;
        kept.touch.stiffness = 2000;
        EXPECT_LE(most_from_nothing(seed, kept), kept.touch.reserve);
        CoupledOptions without = kept;
        without.touch.softness = 0;
        EXPECT_LE(most_from_nothing(seed, without), 3 * kept.touch.reserve) << "the account alone";
        without.touch.keep_account = false;
        EXPECT_GT(most_from_nothing(seed, without), 3 * kept.touch.reserve) << "nothing was at stake";
    }
}

TEST(BodiesTrial, SurfacesStandMoreStiffnessThanForcesFromTheEnginesLoop) {
    for (const Stiffest& row : compare(60)) {
        SCOPED_TRACE(row.what);
        EXPECT_GT(row.in_loop, 0);
        EXPECT_GE(row.as_wished.wish, 2 * row.in_loop);
        EXPECT_GE(row.as_wished.felt, 1.5 * row.in_loop);
        EXPECT_EQ(row.held_to.wish, row.most) << "whatever is wished";
        EXPECT_GE(row.held_to.felt, 1.5 * row.in_loop) << "and still stiffer";
    }
}

TEST(BodiesTrial, WhatLiesOnTheFloorGivesWayOnlyWhereItCan) {
    const World world({{.name = "box", .half = {0.02, 0.02, 0.02}, .mass = 0.2, .position = {0, 0, -0.03}}});
    EXPECT_NEAR(world.mobility(0, {0, 0, -0.01}, {0, 0, -1}), 0, 1e-3) << "pressed on the floor";
    EXPECT_NEAR(world.mobility(0, {0, 0, -0.03}, {0, 0, 1}), 5, 0.05) << "lifted: 1 / 0.2 kg";
    EXPECT_NEAR(world.mobility(0, {-0.02, 0, -0.03}, {1, 0, 0}), 5, 0.05)
        << "pushed: the floor has no friction here";
    EXPECT_GT(world.mobility(0, {-0.02, 0.02, -0.03}, {1, 0, 0}), 8) << "beside its middle it turns as well";
}

TEST(BodiesTrial, ASimulationThatStopsIsFeltAsThingsAtRestAndGoesOn) {
    for (const double stop_at : {2.2, 7.5}) {  // while it pushes, and while it carries
        World world(usual_bodies());
        double force = -1;
        const Trial trial = run_trial(world, push_take_and_stack(), {.stop_at = stop_at, .stop_for = 1.2},
                                      [&](const Moment& moment) {
                                          if (moment.t < stop_at + 1.15)
                                              force = knurl::to_eigen(moment.report.scene_force).norm();
                                      });
        EXPECT_EQ(trial.faults, 0u);
        EXPECT_LT(trial.jump, 1) << "stopped at " << stop_at;
        if (stop_at > 5) {
            EXPECT_EQ(force, 0) << "springs let go of a simulation that does not answer";
        }
        EXPECT_GT(trial.frames, 300u);
        EXPECT_LE(trial.gained, trial.account.hand + 0.005);
    }
}

TEST(BodiesTrial, ABodyIsLiftedAlikeHoweverSlowTheSimulationIs) {
    const double floor = Tray{}.floor;
    for (const double slower : {1.0, 2.0, 3.0, 6.0, 12.0}) {
        SCOPED_TRACE(slower);
        World world(usual_bodies());
        const Vector3d at = world.after(cube).position;
        Script script({at.x(), at.y(), 0.02});
        script.to({at.x(), at.y(), at.z() + 0.02}, 0.1);
        double highest = floor;
        for (int times = 0; times < 4; ++times) {
            script.rest(2).take().to({at.x(), at.y(), at.z() + 0.045}, 0.6).rest(2).let_go();
            script.to({at.x(), at.y(), at.z() + 0.02}, 0.1);
        }
        const Trial trial = run_trial(world, script, {.slower = slower}, [&](const Moment&) {
            highest = std::max(highest, world.after(cube).position.z());
        });
        EXPECT_EQ(trial.faults, 0u);
        EXPECT_GT(highest - floor, 0.030) << "m: it was lifted, by 0.025";
        EXPECT_LT(highest - floor, 0.045) << "m: it was not thrown";
        EXPECT_LT(trial.jump, 0.5) << "N in a cycle";
        EXPECT_LE(trial.gained, trial.account.hand);
    }
}

TEST(BodiesTrial, WhatRestsInADebtThatItCannotPaySlipsAndIsTakenAnewWithoutOne) {
    constexpr double dt = 1.0 / 60;
    World world(usual_bodies());
    Hold hold(HoldOptions{});
    knurl::Report report;
    report.orientation = {1, 0, 0, 0};
    report.position = knurl::to_plain(world.after(cube).position);
    const auto frame = [&] {
        const std::vector<Pull> pulls = hold.pulls(world);
        world.step(dt, {}, pulls);
        hold.stepped(world, dt);
        return pulls.at(0).stiffness;
    };
    hold.feel(report, {});
    hold.take(world, cube);
    EXPECT_EQ(frame(), HoldOptions{}.stiffness);
    // The four springs push the hand up, and give it 40 mJ.
    Hold::SpringFeedback feedback;
    feedback.fill(knurl::HandFeedback{});
    for (auto& felt : feedback) felt->force = {0, 0, 1};
    hold.feel(report, feedback);
    report.position.z += 0.01;
    hold.feel(report, feedback);
    world.kick(cube, {0, 0, 0.5});
    EXPECT_EQ(frame(), 0) << "N/m";
    EXPECT_FALSE(hold.slips()) << "it flies";
    for (int frames = 0; frames < 120 && !hold.slips(); ++frames) EXPECT_EQ(frame(), 0) << "N/m";
    ASSERT_TRUE(hold.slips());
    EXPECT_EQ(hold.account().left(), 0) << "J";
    EXPECT_GT(hold.account().most_created, 0.035) << "J";
    hold.let_go(3);
    EXPECT_FALSE(hold.slips());
    hold.feel(report, {});
    hold.take(world, cube);
    EXPECT_EQ(frame(), HoldOptions{}.stiffness);
}

TEST_P(AtRate, BodiesThatJumpAreNoStepInTheHandAndNoWork) {
    for (const double reset_at : {2.2, 4.9, 6.0, 7.5}) {  // pushing, above it, just taken, carrying
        SCOPED_TRACE("reset at " + std::to_string(reset_at));
        World world(usual_bodies());
        const Vector3d at_first = world.after(cube).position;
        double before = 0, after = 0, step = 0;
        Vector3d last = Vector3d::Zero();
        const Trial trial = run_trial(world, push_take_and_stack(),
                                      {.rate = GetParam(), .reset_at = reset_at}, [&](const Moment& moment) {
                                          const Vector3d force = knurl::to_eigen(moment.report.scene_force);
                                          if (moment.t > reset_at)
                                              step = std::max(step, (force - last).norm());
                                          last = force;
                                          if (moment.t < reset_at) before = force.norm();
                                          if (moment.t < reset_at + 0.4) after = force.norm();
                                      });
        EXPECT_EQ(trial.faults, 0u);
        EXPECT_GE(trial.jumps, 1u);
        if (reset_at < 3 || reset_at > 7) {
            EXPECT_GT(before, 0.3) << "N: there was something to step";
        }
        EXPECT_LT(step, 0.1) << "N in a cycle";
        EXPECT_LE(trial.gained, trial.account.hand + 1e-3);
        EXPECT_LE(trial.account.most_created, 0.01);
        if (reset_at > 7) {
            EXPECT_LT(after, 1e-6) << "N: it is no longer held";
            EXPECT_LT((world.after(cube).position - at_first).norm(), 1e-3);
        }
    }
}

TEST(BodiesTrial, ABodyThatJumpsOntoTheHandIsMetAnewAndDoesNotPushItOut) {
    World world(usual_bodies());
    // Pushes the cube away, and then waits at the cube's first place.
    const Vector3d there = world.after(cube).position;
    Script script({-0.06, 0, 0});
    script.rest(0.3).to({-0.06, 0, -0.035}, 0.1).to(there + Vector3d(0.005, 0, 0), 0.06).rest(1.5);
    const double reset_at = script.end() - 0.5;
    double most = 0, step = 0;
    Vector3d last = Vector3d::Zero();
    const Trial trial = run_trial(world, script, {.reset_at = reset_at}, [&](const Moment& moment) {
        const Vector3d force = knurl::to_eigen(moment.report.scene_force);
        if (moment.t > reset_at) step = std::max(step, (force - last).norm());
        if (moment.t > reset_at + 0.1) most = std::max(most, force.norm());
        last = force;
    });
    EXPECT_EQ(trial.jumps, 1u);
    EXPECT_LT(world.distance(cube, script.motion().rows().back().position), 0) << "the hand is in it";
    EXPECT_LT(step, 0.1) << "N in a cycle";
    EXPECT_LT(most, 0.1) << "N";
}

TEST(BodiesTrial, WhatIsTakenAndLetGoAtOnceWhileItIsTouchedIsNoStep) {
    World world(usual_bodies());
    Script script(Vector3d(-0.02, 0, 0));
    script.rest(0.3).to({-0.02, 0, -0.025}, 0.05).rest(0.3);
    const double pressed = script.end();
    script.take().rest(0.03).let_go().rest(0.2).take().rest(0.2).let_go().rest(1);
    double most = 0, step = 0, last = 0;
    run_trial(world, script, {}, [&](const Moment& moment) {
        const double force = knurl::to_eigen(moment.report.scene_force).norm();
        if (moment.t > pressed) step = std::max(step, std::abs(force - last));
        last = force;
        most = std::max(most, force);
    });
    EXPECT_GT(most, 0.5) << "N: it was pressed";
    EXPECT_LT(step, 0.1) << "N in a cycle";
}

/// The largest change of the force per cycle (N), from the time `from` on.
struct Step {
    double from, most = 0, force = 0;
    Vector3d last = Vector3d::Zero();
    void operator()(const Moment& moment) {
        const Vector3d now = knurl::to_eigen(moment.report.scene_force);
        if (moment.t > from) most = std::max(most, (now - last).norm());
        last = now;
        force = now.norm();
    }
};

TEST_P(AtRate, WhatIsTakenAnewWhileTheSpringsStillFadeIsNoStep) {
    for (const double lift : {0.0015, 0.06})  // m: the cube still lies there, and is in the air
        for (const double after : {0.005, 0.02, 0.05, 0.1, 0.18, 0.3}) {  // s
            SCOPED_TRACE("lifted by " + std::to_string(lift) + ", after " + std::to_string(after));
            World world(usual_bodies());
            const Vector3d above = world.after(cube).position + Vector3d(0, 0, 0.02);
            Script script(above + Vector3d(0, 0, 0.04));
            script.rest(0.3).to(above, 0.1).take().rest(0.2).to(above + Vector3d(0, 0, lift), 0.1).rest(0.3);
            Step step{.from = script.end()};
            for (int i = 0; i < 2; ++i) script.let_go().rest(after).take().rest(0.4);
            double before = 0;
            const Trial trial = run_trial(world, script, {.rate = GetParam()}, [&](const Moment& moment) {
                step(moment);
                if (moment.t < step.from) before = step.force;
            });
            EXPECT_EQ(trial.faults, 0u);
            EXPECT_GT(before, 0.15) << "N: there was something to step";
            EXPECT_LT(step.most, 0.1) << "N in a cycle";
            if (lift > 0.01 && after < 0.01) {
                EXPECT_GT(step.force, 0.5) << "N: it was caught again";
            }
            EXPECT_LE(trial.account.most_created, 0.01);
        }
}

TEST_P(AtRate, ABodyThatTheEngineLosesIsLetGoAndNeverSent) {
    for (const double at : {2.2, 7.5}) {  // while it is pushed, and carried
        SCOPED_TRACE("at " + std::to_string(at));
        World world(usual_bodies());
        Step step{.from = at};
        double before = 0;
        const Trial trial = run_trial(world, push_take_and_stack(),
                                      {.rate = GetParam(),
                                       .kick_at = at,
                                       .kicked = cube,
                                       .kick = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()),
                                       .seconds = at + 0.4},
                                      [&](const Moment& moment) {
                                          step(moment);
                                          if (moment.t < at) before = step.force;
                                      });
        EXPECT_EQ(world.lost(), cube);
        EXPECT_TRUE(world.after(cube).is_one());
        EXPECT_EQ(trial.faults, 0u);
        EXPECT_GT(before, 0.3) << "N: there was something to step";
        EXPECT_LT(step.most, 0.1) << "N in a cycle";
        EXPECT_LT(step.force, 1e-6) << "N, in the end";
    }
}

TEST_P(AtRate, ABodyThatLeapsWithinAStepIsLetGo) {
    for (const double at : {2.2, 7.5}) {
        SCOPED_TRACE("at " + std::to_string(at));
        World world(usual_bodies());
        Step step{.from = at};
        double before = 0;
        const Trial trial = run_trial(
            world, push_take_and_stack(),
            {.rate = GetParam(), .kick_at = at, .kicked = cube, .kick = {0, 50, 20}, .seconds = at + 0.3},
            [&](const Moment& moment) {
                step(moment);
                if (moment.t < at) before = step.force;
            });
        EXPECT_EQ(trial.faults, 0u);
        EXPECT_GE(trial.jumps, 1u);
        EXPECT_GT(before, 0.3) << "N: there was something to step";
        EXPECT_LT(step.most, 0.1) << "N in a cycle";
        EXPECT_LT(step.force, 1e-6) << "N, in the end";
    }
}

}  // namespace
