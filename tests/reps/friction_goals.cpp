// Friction's goals: no drift, independence of the rate, no energy, and its formula for any parameters.

#include "../reference/parameters.hpp"
#include "friction_tools.hpp"

using namespace knurl;
using namespace knurl::test;

// --- Goals

namespace {

double rounded(double x, double step) {
    return std::round(x / step) * step;
}

/// The hand is 0.15 kg, the device 0.2 N s/m, and both feel friction through an encoder of 30 um.
double drift_of_a_held_tip(const FrictionLaw& law, double servo_rate) {
    Tip tip{law};
    const int steps = static_cast<int>(10'000 / servo_rate);
    double x = 0, v = 0, force = 0, first = 0, last = 0;
    for (int i = 0; i < 600'000; ++i) {  // 60 s at 10 kHz
        const double t = i * 1e-4;
        if (i % steps == 0) force = tip.go(rounded(x, 3e-5), 1, 1 / servo_rate);
        v += 1e-4 / 0.15 * (0.2 + 0.1 * std::sin(2 * 3.14159265358979 * 10 * t) + force - 3.2 * v);
        x += 1e-4 * v;
        if (i >= 10'000 && i < 20'000) first += x / 10'000;
        if (i >= 590'000) last += x / 10'000;
    }
    return std::abs(last - first);
}

struct Sweep {
    double mean = 0;  // N
    int snags = 0;
};

/// 200 mm at 0.1 m/s, a third of it back and forth.
Sweep sweep(const FrictionLaw& law, double rate) {
    Tip tip{law};
    Sweep result;
    bool sliding = false;
    const int cycles = static_cast<int>(2 * rate);
    for (int i = 0; i < cycles; ++i) {
        const double t = i / rate, phase = std::fmod(t, 0.6);
        const double x = 0.1 * (std::floor(t / 0.6) * 0.2 + (phase < 0.4 ? phase : 0.8 - phase));
        result.mean += std::abs(tip.go(rounded(x, 3e-5), 1, 1 / rate)) / cycles;
        result.snags += sliding && !tip.state.sliding;
        sliding = tip.state.sliding;
    }
    return result;
}

}  // namespace

TEST(Friction, AHeldTipDoesNotDrift) {
    for (const double rate : {1000.0, 10'000.0}) {
        EXPECT_LT(drift_of_a_held_tip(coulomb(0.8, 0.4, 800), rate), 1e-6);
        EXPECT_LT(drift_of_a_held_tip(snag_law(snags), rate), 1e-6);
        EXPECT_LT(drift_of_a_held_tip(snag_law(paper_snags), rate), 1e-6);
    }
}

TEST(Friction, IsTheSameAtEveryRate) {
    const FrictionLaw laws[] = {coulomb(0.8, 0.4, 800), coulomb(0.5, 0.5, 2000), snag_law(snags),
                                snag_law(paper_snags)};
    for (const FrictionLaw& law : laws) {
        const Sweep one = sweep(law, 1000), four = sweep(law, 4000), ten = sweep(law, 10'000);
        EXPECT_NEAR(one.mean, ten.mean, 0.02 * ten.mean) << static_cast<int>(law.kind);
        EXPECT_NEAR(four.mean, ten.mean, 0.02 * ten.mean) << static_cast<int>(law.kind);
        EXPECT_EQ(one.snags, ten.snags) << static_cast<int>(law.kind);
        EXPECT_EQ(four.snags, ten.snags) << static_cast<int>(law.kind);
    }
}

namespace {

/// The energy that the hand gains (J) over random moves of tip and normal force. Between cycles the anchor
/// stands still, so a move of dx takes F.dx - k |dx|^2 / 2 along the surface.
struct Harvest {
    double most = 0, whole = 0;
};

Harvest harvest(Rng& rng, Tip tip, int moves, bool turning, bool mixing) {
    Harvest harvest;
    Vector x = Vector::Zero();
    double n = 1;
    Vector force = tip.go(x, n);
    const FrictionLaw first = tip.law;
    for (int i = 0; i < moves; ++i) {
        const Vector step = scale(rng, 1e-6, 2e-3) * direction(rng) - 0.01 * x;
        const Vector along = tip.tangent.along(step);
        harvest.whole += force.dot(step) - 0.5 * tip.state.stiffness * along.squaredNorm();
        harvest.most = std::max(harvest.most, harvest.whole);
        x += step;
        n = std::clamp(n * scale(rng, 0.8, 1.25), 0.02, 8.0);
        if (turning && between(rng, 0, 3) == 0)
            tip.tangent.normal = (tip.tangent.normal + scale(rng, 1e-4, 1) * direction(rng)).normalized();
        if (mixing) {
            tip.law = {};
            double leading = 0;
            const double share = uniform(rng, 0, 1);
            add_share(tip.law, leading, first, share);
            add_share(tip.law, leading, coulomb(0.6, 0.3, 3000), 1 - share);
        }
        force = tip.go(x, n);
    }
    return harvest;
}

}  // namespace

TEST(Friction, GivesBackNoMoreThanItStored) {
    const std::uint64_t seed = 21;
    Rng rng(seed);
    const int moves = 1'000'000;
    for (const FrictionLaw& law : {coulomb(0.8, 0.4), coulomb(0.3, 0.3, 300), snag_law(snags)}) {
        const Harvest flat = harvest(rng, {law}, moves, false, false);
        EXPECT_LT(flat.most, 1e-9) << "seed " << seed;
        EXPECT_LT(flat.whole, -1) << "and most of it is lost";
        EXPECT_LT(harvest(rng, {law}, moves / 4, true, false).most, 1e-9) << "while the surface turns";
        EXPECT_LT(harvest(rng, {law}, moves / 4, true, true).most, 1e-9) << "while laws are mixed";
    }
}

TEST(Friction, AStiffnessThatRisesAndFallsGainsNothing) {
    // Pulled out while soft, returned while hard: the shares of two surfaces could pump energy like this.
    for (const double ratio : {1.2, 4.0}) {
        Tip tip{coulomb(0.8, 0.4, 500)};
        double got = 0, x = 0, force = tip.go(0.0);
        const auto move = [&](double to, double stiffness) {
            got += force * (to - x) - 0.5 * tip.state.stiffness * (to - x) * (to - x);
            tip.law.stiffness = stiffness;
            force = tip.go(x = to);
        };
        for (int loop = 0; loop < 100; ++loop) {
            move(0.0004, 500);
            move(0.0004, 500 * ratio);
            move(0, 500 * ratio);
            move(0, 500);
        }
        EXPECT_LE(got, 1e-12) << ratio;
    }
}

TEST(Friction, ThePapersLawGeneratesEnergyWhenTheNormalForceChangesWhileStuck) {
    // Pull .9 mm out at 1 N, press with 5 N, come back: each loop gains 1/2 k_stick 4 N (.9 mm)^2, without
    // limit.
    for (const SnagLaw law : {SnagLaw::paper, SnagLaw::passive}) {
        Snag snag = snags;
        snag.law = law;
        Tip tip{snag_law(snag)};
        double got = 0, x = 0, force = tip.go(0.0, 1);
        const auto move = [&](double to, double n) {
            got += force * (to - x) - 0.5 * tip.state.stiffness * (to - x) * (to - x);
            x = to;
            force = tip.go(x, n);
        };
        for (int loop = 0; loop < 100; ++loop) {
            move(0.0009, 1);
            move(0.0009, 5);
            move(0, 5);
            move(0, 1);
        }
        if (law == SnagLaw::paper) {
            EXPECT_NEAR(got, 100 * 0.5 * 800 * 4 * 0.0009 * 0.0009, 1e-9);
        } else {
            EXPECT_NEAR(got, 0, 1e-12);
        }
    }
}

// --- For any parameters

TEST(Friction, AgreesWithTheTextWhileTheSurfaceTurnsAndTheTipIsLifted) {
    const std::uint64_t seed = 31;
    Rng rng(seed);
    for (int run = 0; run < (long_form() ? 4000 : 200); ++run) {
        const int kind = between(rng, 0, 2);
        const Limits limits{.max_stiffness = between(rng, 0, 3) == 0 ? scale(rng, 100, 2000) : 1e12,
                            .resolution = between(rng, 0, 1) ? 3e-5 : 0};
        const double dynamic = between(rng, 0, 9) ? uniform(rng, 0, 1) : 0, k = scale(rng, 50, 5000);
        const Friction friction{.static_ = dynamic + uniform(rng, 0, 0.5), .dynamic = dynamic};
        Snag snag{.k_kinetic = dynamic,
                  .k_stick = scale(rng, 100, 3000),
                  .d_snap = scale(rng, 1e-4, 2e-3),
                  .d_mean = scale(rng, 1e-4, 1e-2),
                  .d_spread = scale(rng, 1e-4, 1e-2),
                  .seed = static_cast<std::uint32_t>(between(rng, 0, 1000)),
                  .law = kind == 1 ? SnagLaw::passive : SnagLaw::paper};
        if (kind == 0) snag = {};
        const FrictionLaw law = friction_law(friction, snag, k, limits);
        const exact::Law text = exact::law_of(friction, snag, k, limits);
        exact::Friction model;
        FrictionState state;
        Tangent tangent;
        Rubbing rubbing = rubbing_at((between(rng, 0, 4) ? 0.1 : 1e3) * direction(rng));
        if (between(rng, 0, 2) == 0) rubbing.surface_velocity = 0.05 * direction(rng);
        tangent.normal = direction(rng);
        Vector velocity = Vector::Zero();
        for (int i = 0; i < 2000; ++i) {
            const double dt = scale(rng, 1e-5, 3e-3);
            velocity += std::min(1.0, dt / 0.1) * (0.2 * direction(rng) - velocity) + 0.02 * direction(rng);
            rubbing.position += dt * velocity;
            rubbing.normal_force =
                between(rng, 0, 300) ? std::clamp(rubbing.normal_force * scale(rng, 0.9, 1.1), 0.1, 5.0) : 0;
            if (between(rng, 0, 20) == 0)
                tangent.normal = (tangent.normal + 0.05 * direction(rng)).normalized();
            const Vector got = friction_force(law, state, tangent, rubbing, limits, dt);
            const exact::V want =
                model.step(text, {exact::real(tangent.normal), {}, false}, exact::real(rubbing.position), {},
                           exact::real(rubbing.surface_velocity), rubbing.normal_force, dt);
            const double size = std::max(law.stiffness, law.stiffness_per_newton * rubbing.normal_force) *
                                    rubbing.position.norm() +
                                std::max(law.static_, law.dynamic) * rubbing.normal_force;
            // Rounding adds up along the way, and a snag's place is only as exact as the tip's.
            ASSERT_LE(exact::length(exact::real(got) - want), 1e-12L * size * 100)
                << "seed " << seed << " run " << run << " cycle " << i << " kind " << kind << "\ngot "
                << got.transpose() << "\nwant " << exact::rounded(want).transpose();
            if (rubbing.normal_force == 0) rubbing.normal_force = 1;
        }
    }
}

namespace {

bool same_bytes(const FrictionState& a, const FrictionState& b) {
    return a.anchor == b.anchor && a.snag == b.snag && a.last == b.last && a.residual == b.residual &&
           a.released == b.released && a.viscous == b.viscous && a.viscous_residual == b.viscous_residual &&
           a.line == b.line && a.cone == b.cone && a.released_per_newton == b.released_per_newton &&
           a.residual_time == b.residual_time && a.stiffness == b.stiffness && a.next == b.next &&
           a.farthest == b.farthest && a.generator == b.generator && a.seed == b.seed &&
           a.dimensions == b.dimensions && a.held == b.held && a.sliding == b.sliding;
}

double legal(Rng& rng, double most) {
    switch (between(rng, 0, 5)) {
        case 0:
            return 0;
        case 1:
            return most;
        default:
            return std::min(most, scale(rng, 1e-9, 1e9));
    }
}

FrictionLaw legal_law(Rng& rng, const Limits& limits) {
    Friction friction{.dynamic = legal(rng, 100), .viscous = legal(rng, 1e6)};
    friction.static_ = between(rng, 0, 1) ? automatic : std::max(friction.dynamic, legal(rng, 100));
    Snag snag{.k_kinetic = legal(rng, 100),
              .k_stick = legal(rng, 1e9),
              .d_snap = legal(rng, 1e3),
              .d_mean = legal(rng, 1e3),
              .d_spread = legal(rng, 1e3),
              .seed = static_cast<std::uint32_t>(rng()),
              .law = between(rng, 0, 1) ? SnagLaw::passive : SnagLaw::paper};
    if (between(rng, 0, 1)) snag = {};
    return friction_law(friction, snag, legal(rng, 1e9), limits);
}

}  // namespace

TEST(Friction, IsFiniteAndBoundedForAnyLegalParameters) {
    const std::uint64_t seed = 41;
    Rng rng(seed);
    for (int run = 0; run < (long_form() ? 20'000 : 1000); ++run) {
        const Limits limits{.max_stiffness =
                                between(rng, 0, 1) ? free_limits.max_stiffness : scale(rng, 1, 1e4)};
        Tip tip{legal_law(rng, limits), limits};
        const double reach = scale(rng, 1e-6, 1e12);
        for (int i = 0; i < 200; ++i) {
            if (between(rng, 0, 50) == 0) tip.law = legal_law(rng, limits);
            const bool near = between(rng, 0, 3) > 0;
            Rubbing rubbing = rubbing_at((near ? scale(rng, 1e-9, 1) : 1) * reach * direction(rng));
            if (near) rubbing.position += tip.state.anchor;
            if (rubbing.position.norm() > 1e12) rubbing.position.setZero();
            rubbing.normal_force = legal(rng, 1e21);
            rubbing.velocity = legal(rng, 1e12) * direction(rng);
            rubbing.surface_velocity = legal(rng, 1e3) * direction(rng);
            tip.tangent.normal = direction(rng);
            tip.tangent.line = tip.tangent.normal.unitOrthogonal();
            tip.tangent.dimensions = static_cast<std::uint32_t>(between(rng, 0, 2));
            const double dt = between(rng, 0, 5) ? uniform(rng, 0, 0.05) : 0;
            const Vector force = friction_force(tip.law, tip.state, tip.tangent, rubbing, limits, dt);
            ASSERT_TRUE(force.allFinite()) << "seed " << seed << " run " << run << " cycle " << i;
            const double speed = (rubbing.velocity - rubbing.surface_velocity).norm();
            const double most = std::max(tip.law.static_, tip.law.dynamic) * rubbing.normal_force +
                                std::min(rubbing.normal_force, tip.law.viscous * speed);
            ASSERT_LE(force.norm(), most * (1 + 1e-12))
                << "seed " << seed << " run " << run << " cycle " << i;

            const FrictionState before = tip.state;
            const Vector again = friction_force(tip.law, tip.state, tip.tangent, rubbing, limits, 0);
            if (dt > 0) {
                ASSERT_EQ(again, force)
                    << "evaluated again in the same cycle: seed " << seed << " run " << run << " " << i;
            }
            ASSERT_TRUE(same_bytes(before, tip.state)) << "dt = 0 advanced something";
        }
    }
}
