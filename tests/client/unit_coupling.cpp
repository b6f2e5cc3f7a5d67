// A hand in its own springs, a spring in a Scene as in the servo, and a body in water: heavy, slow and never
// still, like an atom. All on a virtual clock.

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <knurl/client/coupling.hpp>
#include <knurl/reps/scene.hpp>

namespace unit_coupling_tests {
namespace {

using namespace knurl;
using Eigen::Vector3d;

constexpr double cycle = 1e-3;  // s

Report report_at(const Vec3& hand) {
    Report report;
    report.position = hand;
    return report;
}

HandFeedback felt_as(const Vec3& force) {
    return {.force = force, .torque = {}, .contact_point = {}, .stiffness = 200};
}

/// Langevin dynamics, in the hand's units: an atom of water at 300 K, 3 ps in a second, 5 cm for 1 nm, 10 mN
/// for 1 pN.
struct Atom {
    explicit Atom(unsigned seed) : random(seed) {}
    void advance(const Vector3d& force) {
        const double keep = std::exp(-friction / mass * cycle);
        const Vector3d heat(normal(random), normal(random), normal(random));
        velocity =
            keep * velocity + (1 - keep) / friction * force + std::sqrt(kt / mass * (1 - keep * keep)) * heat;
        position += cycle * velocity;
        work += cycle * force.dot(velocity);
    }
    static constexpr double mass = 0.68, friction = 68, kt = 2.05e-3;  // kg, N s/m, J
    std::mt19937 random;
    std::normal_distribution<double> normal;
    Vector3d position = Vector3d::Zero(), velocity = Vector3d::Zero();
    double work = 0;  // J, actually received
};

/// How a hand pulls: to another place within `reach`, every `least` s or up to `more` s later.
struct Handling {
    double reach = 0.06, least = 0.5, more = 0.8;
    int cycles = 60'000;
    int regrip_every = 0;          // cycles; 0: it is held all the time
    int burst = 1;                 // frames that the client gets at once, because it is delayed
    double metre = 1, newton = 1;  // of the claim's world, per unit of the hand's
};

struct Hand {
    Hand(unsigned seed, const Handling& how) : handling(how), random(seed) {}
    void advance(double t, const Vector3d& force) {
        if (t >= begin + time) {
            from = to;
            begin = t;
            time = handling.least + handling.more * uniform(random);
            do {
                to = handling.reach *
                     (2 * Vector3d(uniform(random), uniform(random), uniform(random)) - Vector3d::Ones());
            } while (to.norm() > handling.reach);
        }
        const double s = (t - begin) / time;
        const Vector3d wanted = from + s * s * s * (10 - 15 * s + 6 * s * s) * (to - from);
        const Vector3d speed = 30 * s * s * (1 - s) * (1 - s) / time * (to - from);
        for (int i = 0; i < 10; ++i) {
            velocity += cycle / 10 / 0.15 * (200 * (wanted - position) + 3 * (speed - velocity) + force);
            position += cycle / 10 * velocity;
        }
    }
    Handling handling;
    std::mt19937 random;
    std::uniform_real_distribution<double> uniform;
    double begin = 0, time = 0;
    Vector3d position = Vector3d::Zero(), velocity = Vector3d::Zero(), from = position, to = position;
};

struct Outcome {
    Coupling::Account account;
    Coupling::Counts counts;
    double work = 0;        // J that the body actually received
    double step = 0;        // N, largest in a cycle
    double end_step = 0;    // N, the part that the hand's motion does not explain
    double felt = 0;        // N rms
    double spring_law = 0;  // N rms, of a spring of that stiffness from the hand to the body
};

Outcome pull(double rate, bool keep_account, unsigned seed, const Handling& handling = {}) {
    Atom atom(seed);
    Hand hand(seed + 1, handling);
    const double metre = handling.metre, newton = handling.newton;
    Coupling coupling({.scale = {.length = metre, .force = newton},
                       .stiffness = 200 * newton / metre,
                       .interval = 1 / rate,
                       .frames_late = 1,
                       .keep_account = keep_account,
                       .metre = metre,
                       .newton = newton});
    Scene scene({.representations = 1, .probes = 1},
                {.max_force = 8.5 * newton, .metre = metre, .newton = newton});
    const auto there = [&](const Vector3d& of_the_hand) { return to_plain(metre * of_the_hand); };
    const RepresentationId id{0, 1};
    scene.add(id, coupling.spring());
    scene.settle();
    coupling.hold({}, {});

    Outcome outcome;
    Vector3d last = Vector3d::Zero(), acting = last, sent = last, before = last;
    double next = 1 / rate, felt = 0, law = 0;
    const int cycles = handling.cycles;
    std::vector<Vec3> waiting;
    for (int i = 0; i < cycles; ++i) {
        const double t = i * cycle;
        // Released for two seconds, in which the spring fades out completely.
        const int held_for = handling.regrip_every > 0 ? i % handling.regrip_every : 1;
        if (held_for == 0) coupling.hold(to_plain(atom.position), there(hand.position));
        if (held_for + 2000 == handling.regrip_every) {
            coupling.let_go(t);
            acting = sent = Vector3d::Zero();  // released at once
        }
        Probe probe;
        probe.position = metre * hand.position;
        const Vector3d felt_there = scene.evaluate(probe, cycle).force, force = felt_there / newton;
        const double own = 200 * (hand.position - before).norm();
        outcome.end_step = std::max(outcome.end_step, (force - last).norm() - own);
        before = hand.position;
        outcome.step = std::max(outcome.step, (force - last).norm());
        last = force;
        HandFeedback spring = felt_as(to_plain(felt_there));
        spring.stiffness *= newton / metre;
        coupling.feel(report_at(there(hand.position)), spring);
        if (t >= next) {
            next += 1 / rate;
            acting = sent;  // like GROMACS: read at the next frame
            waiting.push_back(to_plain(atom.position));
            if (std::ssize(waiting) >= handling.burst) {
                for (std::size_t n = 0; n + 1 < waiting.size(); ++n) coupling.superseded(waiting[n]);
                sent = to_eigen(coupling.frame(waiting.back(), t));
                waiting.clear();
            }
        }
        coupling.watch(t);
        scene.update(id, coupling.spring());
        atom.advance(acting);
        hand.advance(t, force);
        felt += force.squaredNorm();
        law += 200.0 * 200.0 * (atom.position - hand.position).squaredNorm();
    }
    outcome.account = coupling.account();
    outcome.counts = coupling.counts();
    outcome.work = atom.work;
    outcome.felt = std::sqrt(felt / cycles);
    outcome.spring_law = std::sqrt(law / cycles);
    return outcome;
}

class CouplingRates : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(FramesPerSecond, CouplingRates, testing::Values(400, 100, 20, 5, 2, 1),
                         [](const auto& rate) {
                             return "At" + std::to_string(static_cast<int>(rate.param));
                         });

TEST_P(CouplingRates, AMinuteOfRandomPullingMakesNoEnergyAndNoSteps) {
    for (const unsigned seed : {1u, 2u}) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Outcome outcome = pull(GetParam(), true, seed);
        const Coupling::Account& account = outcome.account;
        EXPECT_GT(account.hand_in, 1) << "J: the hand has worked";
        EXPECT_GT(account.body, 0.2) << "J: the body was pulled";
        EXPECT_LE(account.created, 0.01 * account.hand_in);
        EXPECT_LE(outcome.step, 0.1) << "N in a cycle";
        EXPECT_LT(outcome.felt, 1.05 * outcome.spring_law);
        // A frame covers all of the force's work, except that of the frame under way.
        if (GetParam() >= 20) {
            EXPECT_NEAR(account.body, outcome.work, 0.01 * outcome.work);
        }
    }
}

TEST_P(CouplingRates, WhoTakesHoldAgainAndAgainIsChargedForAllOfIt) {
    for (const unsigned seed : {1u, 2u}) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Outcome outcome = pull(GetParam(), true, seed, {.regrip_every = 10'000});
        EXPECT_EQ(outcome.counts.jumps, 0u);
        EXPECT_LE(outcome.end_step, 0.055) << "N, wherever the hand went meanwhile";
        EXPECT_GT(outcome.account.body, 0.1) << "J: the body was pulled";
        EXPECT_LE(outcome.account.created, 0.01 * outcome.account.hand_in);
        // The frame under way at the end of a hold, of eight seconds, is never reported.
        EXPECT_NEAR(outcome.account.body, outcome.work, (0.01 + 1.5 / (8 * GetParam())) * outcome.work);
    }
}

TEST_P(CouplingRates, WhoIsHeldUpIsChargedForWhatReallyActed) {
    for (const unsigned seed : {1u, 2u}) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Outcome outcome = pull(GetParam(), true, seed, {.burst = 10});
        EXPECT_LE(outcome.account.created, 0.01 * outcome.account.hand_in);
        EXPECT_NEAR(outcome.account.body, outcome.work, 0.02 * outcome.work);
    }
}

TEST(Coupling, ASimulationThatIsSlowerThanExpectedIsLearntAndHeld) {
    Coupling coupling({.interval = 0.01, .frames_late = 1});
    coupling.hold({}, {});
    std::uint64_t stops = 0;
    for (int frame = 0; frame < 60; ++frame) {
        for (int ms = 0; ms < 800; ms += 10) coupling.watch(0.8 * frame + 1e-3 * ms);
        coupling.frame({}, 0.8 * (frame + 1));
        if (frame == 50) stops = coupling.counts().stops;
    }
    EXPECT_NEAR(coupling.interval(), 0.8, 0.1);
    EXPECT_EQ(coupling.counts().stops, stops) << "it stops no more";
    EXPECT_EQ(coupling.state(), Coupling::State::holding);
}

TEST(Coupling, StaysSoThroughTenMinutesOfRoughHandling) {
    for (const double rate : {400.0, 60.0, 20.0, 10.0, 4.0, 2.0, 1.0}) {
        SCOPED_TRACE(rate);
        const Outcome outcome =
            pull(rate, true, 3, {.reach = 0.09, .least = 0.15, .more = 0.3, .cycles = 600'000});
        EXPECT_LE(outcome.account.created, 0.01 * outcome.account.hand_in);
        EXPECT_LE(outcome.account.most_created, 0.01 * outcome.account.hand_in);
        EXPECT_LT(outcome.felt, 1.05 * outcome.spring_law);
        EXPECT_LE(outcome.account.body, outcome.account.hand);
        EXPECT_LE(outcome.end_step, 0.055)
            << "N: 0.25 m/s, and a tenth for frames that fall between cycles; the rest is the hand's own";
    }
}

TEST(Coupling, IsTheSpringItselfWhereFramesAreFrequent) {
    for (const double rate : {400.0, 100.0, 20.0}) {
        SCOPED_TRACE(rate);
        const Outcome outcome = pull(rate, true, 1);
        EXPECT_NEAR(outcome.felt, outcome.spring_law, 0.06 * outcome.spring_law);
        EXPECT_GT(outcome.account.body, 0.85 * outcome.account.hand);
    }
}

TEST(Coupling, InAWorldOfAnySizeTheHandFeelsTheSame) {
    for (const bool regrips : {false, true}) {
        const Handling here{.cycles = 30'000, .regrip_every = regrips ? 10'000 : 0};
        const Outcome want = pull(20, true, 5, here);
        for (const auto& [metre, newton] : {std::pair{0x1p-7, 1.0}, {0x1p10, 1.0}, {0x1p3, 0x1p-2}}) {
            SCOPED_TRACE(metre);
            Handling there = here;
            there.metre = metre;
            there.newton = newton;
            const Outcome got = pull(20, true, 5, there);
            EXPECT_EQ(got.step, want.step);
            EXPECT_EQ(got.felt, want.felt);
            EXPECT_EQ(got.work, want.work);
            EXPECT_EQ(got.account.lost, want.account.lost * metre * newton);
            EXPECT_EQ(got.counts.short_of, want.counts.short_of);
            EXPECT_EQ(got.counts.jumps, want.counts.jumps);
        }
    }
}

TEST(Coupling, WithoutItsAccountSlowFramesMakeEnergy) {
    // Shows that the tests above can fail.
    const Outcome outcome = pull(1, false, 1);
    EXPECT_GT(outcome.account.created, 0.5 * outcome.account.hand_in);
}

/// Held at the origin, the hand drawn away along x by 1 cm in ten cycles, frames every 10 ms until 0.2 s.
Coupling drawn(CouplingOptions options = {}) {
    options.interval = 0.01;
    Coupling coupling(options);
    coupling.hold({}, {});
    for (int i = 0; i <= 10; ++i) {
        const double x = 0.001 * i;
        coupling.feel(report_at({x, 0, 0}), felt_as({-200 * x, 0, 0}));
    }
    for (int i = 0; i <= 20; ++i) coupling.frame({}, 0.01 * i);
    return coupling;
}

TEST(Coupling, TurnsUnitsIntoTheSimulationsOwn) {
    Coupling coupling = drawn({.scale = {.length = 0.005, .force = 0.5}});
    const double energy = 0.5 * 200 * 0.01 * 0.01;  // J
    EXPECT_NEAR(coupling.account().hand, energy, 1e-12);
    EXPECT_NEAR(coupling.account().spring, energy, 1e-12);
    const Vec3 push = coupling.frame({}, 0.21);
    EXPECT_LE(push.x, 2 / 0.5 + 1e-9) << "2 N are 4 units";
    EXPECT_GE(push.x, 0.79 * 2 / 0.5)
        << "a fifth less while the reserve is empty; a little for a body that may yield";
    EXPECT_EQ(push.y, 0);
    EXPECT_NEAR(coupling.to_simulation({0.01, 0, 0}).x, 2, 1e-12);
    EXPECT_NEAR(coupling.to_hand({2, 0, 0}).x, 0.01, 1e-12);
    EXPECT_NEAR(coupling.energy_scale(), 1 / 0.0025, 1e-9);
}

TEST(Coupling, CountsOfAForceWhatReachesTheHand) {
    Coupling coupling({});
    coupling.hold({}, {});
    for (int i = 0; i <= 10; ++i) {
        HandFeedback felt = felt_as({-0.2 * i, 0, 0});
        felt.share = 0.5;  // the device cannot render this spring and another claim's wall together
        coupling.feel(report_at({0.001 * i, 0, 0}), felt);
    }
    EXPECT_NEAR(coupling.account().hand, 0.25 * 200 * 0.01 * 0.01, 1e-12);
    EXPECT_NEAR(coupling.account().spring, 0.25 * 200 * 0.01 * 0.01, 1e-12);
    EXPECT_LE(coupling.account().created, 1e-12);
}

TEST(Coupling, BoundsTheForceOnTheBodyAndSaysHowOften) {
    Coupling coupling = drawn({.greatest_force = 0.5});
    EXPECT_NEAR(coupling.frame({}, 0.21).x, 0.5, 1e-12);
    EXPECT_GT(coupling.counts().bounded, 0u);
}

TEST(Coupling, ALateSimulationIsWaitedForAndAStoppedOneFadesAndComesBackWithoutAForce) {
    Coupling coupling = drawn();
    EXPECT_EQ(coupling.watch(0.21), Coupling::State::holding);
    EXPECT_EQ(coupling.watch(0.25), Coupling::State::late);
    EXPECT_EQ(coupling.spring().stiffness, 200) << "it waits";
    EXPECT_EQ(coupling.watch(0.69), Coupling::State::late);
    EXPECT_EQ(coupling.watch(0.75), Coupling::State::stopped);
    EXPECT_EQ(coupling.watch(1.0), Coupling::State::stopped);
    EXPECT_NEAR(coupling.spring().stiffness, 100, 1e-9);
    EXPECT_EQ(coupling.watch(1.3), Coupling::State::stopped);
    EXPECT_EQ(coupling.spring().stiffness, 0);
    EXPECT_EQ(coupling.counts().stops, 1u);
    EXPECT_LE(coupling.account().created, 1e-12);

    coupling.feel(report_at({0.03, 0, 0}), felt_as({}));  // meanwhile the hand moved elsewhere
    const Vec3 push = coupling.frame({}, 2);
    EXPECT_EQ(push, Vec3{}) << "nothing is in the spring";
    EXPECT_EQ(coupling.watch(2.01), Coupling::State::holding);
    EXPECT_EQ(coupling.spring().stiffness, 200);
    EXPECT_NEAR(coupling.spring().anchor.x, 0.03, 1e-12);
}

TEST(Coupling, FollowsABodyThatJumpsAtItsRateAndTakesItForNoWork) {
    Coupling coupling = drawn();
    const Coupling::Account before = coupling.account();
    coupling.frame({-0.2, 0, 0}, 0.21);
    EXPECT_EQ(coupling.counts().jumps, 1u);
    EXPECT_EQ(coupling.account().body, before.body);
    const Spring spring = coupling.spring();
    const double way = std::abs(spring.anchor.x - 0.0);
    EXPECT_LE(way, 1e-6) << "m: the spring's energy pays for the centimetre that it is long, and no more";

    Coupling unpaid = drawn({.keep_account = false});
    unpaid.frame({-0.2, 0, 0}, 0.21);
    EXPECT_NEAR(unpaid.spring().anchor.x, -0.2, 1e-12);
    EXPECT_GE(unpaid.spring().duration, 0.2 / 0.25 - 1e-9);
}

TEST(Coupling, LetGoItFadesAndPushesNoMore) {
    Coupling coupling = drawn();
    coupling.let_go(0.3);
    coupling.watch(0.55);
    EXPECT_NEAR(coupling.spring().stiffness, 100, 1e-9);
    coupling.watch(1);
    EXPECT_EQ(coupling.spring().stiffness, 0);
    EXPECT_EQ(coupling.frame({}, 1.1), Vec3{});
}

TEST(Coupling, TakesHoldAgainAsIfForTheFirstTime) {
    Coupling coupling = drawn();
    coupling.let_go(0.3);
    coupling.watch(5);
    coupling.feel(report_at({0.01, 0, 0}), felt_as({}));
    coupling.hold({7, 0, 0}, {0.01, 0, 0});
    EXPECT_EQ(coupling.watch(20), Coupling::State::holding) << "no frame is due yet";
    EXPECT_EQ(coupling.spring().stiffness, 200);
    EXPECT_NEAR(coupling.spring().anchor.x, 0.01, 1e-12);
    EXPECT_EQ(coupling.frame({7, 0, 0}, 20.01), Vec3{});
    EXPECT_LE(coupling.account().created, 1e-12);
    EXPECT_EQ(coupling.watch(21), Coupling::State::stopped);
    coupling.hold({7, 0, 0}, {0.01, 0, 0});
    coupling.watch(22);
    EXPECT_EQ(coupling.watch(23), Coupling::State::stopped)
        << "a simulation that stands still when it is taken hold of";
}

TEST(Coupling, LeavesWhatFadesItsTimeWhenItTakesHoldAgainOrTheSimulationComesBack) {
    Coupling coupling = drawn();
    const double end = coupling.spring().anchor.x;
    coupling.let_go(0.3);
    coupling.watch(0.4);
    coupling.hold({7, 0, 0}, {0.01, 0, 0});
    EXPECT_NEAR(coupling.spring().stiffness, 160, 1e-9);
    EXPECT_EQ(coupling.frame({7, 0, 0}, 0.45), Vec3{});
    coupling.watch(0.5);
    EXPECT_NEAR(coupling.spring().stiffness, 120, 1e-9) << "no step";
    EXPECT_EQ(coupling.spring().anchor.x, end);
    coupling.watch(0.85);
    coupling.feel(report_at({0.01, 0, 0}), felt_as({-0.3, 0, 0}));
    EXPECT_EQ(coupling.frame({7, 0, 0}, 0.855), Vec3{});
    EXPECT_EQ(coupling.watch(0.856), Coupling::State::stopped) << "sent, but not yet felt";
    coupling.feel(report_at({0.01, 0, 0}), felt_as({}));
    coupling.frame({7, 0, 0}, 0.86);
    EXPECT_EQ(coupling.watch(0.87), Coupling::State::holding);
    EXPECT_EQ(coupling.spring().stiffness, 200);
    EXPECT_NEAR(coupling.spring().anchor.x, 0.01, 1e-12) << "without a force";

    Coupling paused = drawn();
    paused.watch(0.75);
    paused.watch(0.85);
    EXPECT_EQ(paused.frame({}, 0.9), Vec3{});
    paused.watch(0.95);
    EXPECT_NEAR(paused.spring().stiffness, 120, 1e-9);
}

TEST(Coupling, RefusesWhatMakesNoSense) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Coupling({.scale = {.length = 0}}), Error);
    EXPECT_THROW(Coupling({.scale = {.force = -1}}), Error);
    EXPECT_THROW(Coupling({.stiffness = nan}), Error);
    EXPECT_THROW(Coupling({.interval = 0}), Error);
    EXPECT_THROW(Coupling({.frames_late = 3}), Error);
    Coupling coupling = drawn();
    EXPECT_THROW(coupling.frame({nan, 0, 0}, 0.21), Error);
}

}  // namespace

}  // namespace unit_coupling_tests
