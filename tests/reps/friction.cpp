// Friction along a solved contact: the properties that a hand relies on, one at a time.

#include "friction_tools.hpp"

using namespace knurl;
using namespace knurl::test;

// --- Coulomb

TEST(Friction, HoldsElasticallyUntilTheConeThenSlidesWithTheDynamicCoefficient) {
    Tip tip{coulomb(0.8, 0.4)};
    EXPECT_EQ(tip.go(0.0), 0) << "first contact: no force";
    EXPECT_NEAR(tip.go(0.0005), -0.5, 1e-15);
    EXPECT_NEAR(tip.go(0.0008), -0.8, 1e-15) << "on the cone: still held";
    EXPECT_NEAR(tip.go(0.00081), -0.4, 1e-15);
    EXPECT_NEAR(tip.go(0.05), -0.4, 1e-14);
    EXPECT_NEAR(tip.go(0.05, 3), -0.4, 1e-14) << "pressed harder while it stands still: no more stored";
    EXPECT_NEAR(tip.go(0.06, 3), -2.4 + 1.2, 1e-13)
        << "held again by 0.7, so up to the cone and down to sliding";
}

TEST(Friction, SticksAgainBelowSevenTenthsOfSliding) {
    Tip tip{coulomb(0.8, 0.4)};
    for (const double x : {0.0, 0.01}) tip.go(x);
    EXPECT_NEAR(tip.go(0.01 - 0.00011), -0.29, 1e-13);
    EXPECT_TRUE(tip.state.sliding);
    EXPECT_NEAR(tip.go(0.01 - 0.00013), -0.27, 1e-13);
    EXPECT_FALSE(tip.state.sliding);
    EXPECT_NEAR(tip.go(0.01 + 0.0003), -0.7, 1e-13) << "stuck: more than sliding takes";
}

TEST(Friction, WithoutAStaticCoefficientItIsTheDynamicOne) {
    Tip tip{friction_law({.dynamic = 0.3}, {}, 1000, free_limits)};
    tip.go(0.0);
    EXPECT_NEAR(tip.go(0.00029), -0.29, 1e-15);
    EXPECT_NEAR(tip.go(0.00031), -0.3, 1e-15) << "no step";
}

TEST(Friction, IsForgottenWhenTheContactEnds) {
    Tip tip{coulomb(0.8, 0.4)};
    for (const double x : {0.0, 0.0005}) tip.go(x);
    EXPECT_EQ(tip.go(0.0005, 0), 0);
    EXPECT_EQ(tip.go(0.0005), 0);
    EXPECT_NEAR(tip.go(0.0006), -0.1, 1e-15);
}

TEST(Friction, PressingLessLetsItSlide) {
    Tip tip{coulomb(0.8, 0.4)};
    for (const double x : {0.0, 0.0007}) tip.go(x);
    EXPECT_NEAR(tip.go(0.0007, 0.5), -0.2, 1e-15);
    EXPECT_NEAR(tip.go(0.0007, 1), -0.2, 1e-15) << "what it let go does not come back";
}

TEST(Friction, ViscousForceOpposesSlidingAndStaysBelowTheNormalForce) {
    const FrictionLaw law = friction_law({.viscous = 2}, {}, 1000, free_limits);
    FrictionState state;
    Rubbing rubbing = rubbing_at({0, 0, 0}, 3);
    rubbing.velocity = {0.3, 0, -5};
    rubbing.surface_velocity = {0.1, 0.1, 0};
    EXPECT_TRUE(
        friction_force(law, state, {}, rubbing, free_limits, 1e-3).isApprox(Vector(-0.4, 0.2, 0), 1e-15));
    rubbing.velocity = {300, 0, 0};
    EXPECT_NEAR(friction_force(law, state, {}, rubbing, free_limits, 1e-3).norm(), 3, 1e-14);
}

TEST(Friction, NeitherSurfaceNorSnagIsStifferThanTheDevice) {
    const Limits soft{.max_stiffness = 300};
    EXPECT_EQ(friction_law({.dynamic = 1}, {}, 2000, soft).stiffness, 300);
    EXPECT_EQ(friction_law({}, snags, 2000, soft).stiffness, 300);
    Tip paper{friction_law({}, paper_snags, 2000, soft), soft};
    paper.go(0.0, 5);
    EXPECT_NEAR(paper.go(0.0005, 5), -300 * 0.0005, 1e-15) << "800 / m at 5 N would be 4000 N/m";
}

TEST(Friction, IsCarriedByAMovingSurface) {
    Tip tip{coulomb(0.8, 0.4)};
    Rubbing rubbing = rubbing_at({0, 0, 0});
    rubbing.surface_velocity = {0.05, 0, 0.3};
    const auto step = [&](double x, double dt) {
        rubbing.position.x() = x;
        return friction_force(tip.law, tip.state, {}, rubbing, free_limits, dt).x();
    };
    step(0, 1e-3);
    EXPECT_NEAR(step(0, 0.002), 0.1, 1e-15) << "drags the resting tip along";
    EXPECT_NEAR(step(0.0005, 0.008), 0, 1e-15) << "as fast as the surface: no force";
    for (int i = 0; i < 100; ++i) step(0.0005, 1e-3);
    EXPECT_NEAR(step(0.0005, 1e-3), 0.4, 1e-14) << "left behind: slides";
}

// --- Where the tip can slide

TEST(Friction, TheAnchorTurnsWithTheSurface) {
    Tip tip{coulomb(0.8, 0.4)};
    tip.go(Vector(0, 0, 0));
    tip.go(Vector(0.0005, 0.0002, 0));
    tip.tangent.normal = Vector(std::sin(0.5), 0, std::cos(0.5));
    const Vector force = tip.go(Vector(0.0005, 0.0002, 0));
    const Vector whole(-0.5, -0.2, 0);
    EXPECT_TRUE(force.isApprox(whole - tip.tangent.normal.dot(whole) * tip.tangent.normal, 1e-12));
    EXPECT_NEAR(force.dot(tip.tangent.normal), 0, 1e-15);
    tip.tangent.normal = Vector::UnitZ();
    const double back = tip.go(Vector(0.0005, 0.0002, 0)).norm();
    EXPECT_LT(back, force.norm()) << "turned back and forth it does not come back";
}

TEST(Friction, PressingInDoesNotPullOnTheAnchor) {
    Tip tip{coulomb(0.8, 0.4)};
    tip.go(Vector(0, 0, 0));
    for (int i = 0; i < 100; ++i) EXPECT_EQ(tip.go(Vector(0, 0, -1e-4 * i)), Vector(0, 0, 0));
}

TEST(Friction, InACornerItActsAlongTheLineAlone) {
    Tip tip{coulomb(0.8, 0.4)};
    tip.tangent = {.normal = Vector(0, 1, 1).normalized(), .line = Vector::UnitX(), .dimensions = 1};
    tip.go(Vector(0, 0, 0));
    EXPECT_TRUE(tip.go(Vector(0.0003, -0.002, -0.001)).isApprox(Vector(-0.3, 0, 0), 1e-14));
    EXPECT_TRUE(tip.go(Vector(0.02, -0.002, -0.001)).isApprox(Vector(-0.4, 0, 0), 1e-12));
    tip.tangent.dimensions = 0;
    for (int i = 0; i < 20; ++i) tip.go(Vector(0.02, 0, 0));
    EXPECT_EQ(tip.go(Vector(0.03, 0, 0)).norm(), 0) << "a vertex holds the tip without friction";
}

TEST(Friction, RunningIntoACornerLetsGoIn10Milliseconds) {
    for (const std::uint32_t fewer : {1u, 0u}) {
        Tip tip{coulomb(0.8, 0.4)};
        for (int i = 0; i < 50; ++i) tip.go(Vector(0, 2e-4 * i, 0));
        const Vector before = tip.go(Vector(0, 0.01, 0));
        ASSERT_NEAR(before.y(), -0.4, 1e-12);
        tip.tangent.dimensions = fewer;  // along x alone
        for (int i = 0; i <= 10; ++i) {
            const Vector now = tip.go(Vector(0, 0.01, 0));
            EXPECT_NEAR(now.y(), -0.4 * (1 - i / 10.0), 1e-12) << i;
        }
        tip.tangent.dimensions = 2;
        EXPECT_NEAR(tip.go(Vector(0, 0.01, 0)).norm(), 0, 1e-12) << "and nothing comes back";
    }
}

TEST(Friction, FlickeringInACornerNeitherJumpsNorAddsUp) {
    const std::uint64_t seed = 11;
    Rng rng(seed);
    Tip tip{coulomb(0.5, 0.5)};
    Vector x = Vector::Zero(), last = Vector::Zero();
    tip.go(x);
    for (int i = 0; i < 100'000; ++i) {
        const Vector step = 2e-5 * Vector(uniform(rng, -1, 1), uniform(rng, -1, 1), 0);
        x += step;
        tip.tangent.dimensions = static_cast<std::uint32_t>(between(rng, 0, 2));
        tip.tangent.line = Vector(std::cos(1.0), std::sin(1.0), 0);
        const Vector force = tip.go(x);
        // The change by the motion, and at most three residuals that decay.
        ASSERT_LE((force - last).norm(), 1000 * step.norm() + 3 * 0.5 * 0.1 + 1e-12)
            << "seed " << seed << " " << i;
        ASSERT_LE(force.norm(), 0.5 * (1 + 1e-12));
        last = force;
    }
}

TEST(Friction, WhatOthersReleaseIsLetGoInTheSameWay) {
    Tip tip{friction_law({}, {}, 1000, free_limits)};
    tip.go(0.0);
    tip.state.released = {0.3, 0, 0.1};
    tip.state.residual_time = residual_decay;
    for (int i = 1; i <= 12; ++i) {
        const Vector want = std::max(0.0, 1 - i / 10.0) * Vector(0.3, 0, 0.1);
        EXPECT_LE((tip.go(Vector(0, 0, 0)) - want).norm(), 1e-15) << i;
    }
}

// --- Snags

TEST(Friction, ASnagHoldsLetsGoAndComesAgainAtItsDistance) {
    Snag snag = snags;
    snag.d_spread = 0;
    for (const SnagLaw law : {SnagLaw::passive, SnagLaw::paper}) {
        snag.law = law;
        Tip tip{snag_law(snag)};
        for (int i = 0; i <= 90; ++i) tip.go(1e-5 * i);
        EXPECT_NEAR(tip.go(0.00099), -0.792, 1e-12);
        EXPECT_NEAR(tip.go(0.00101), -0.4, 1e-12) << "let go";
        EXPECT_NEAR(tip.go(0.0049), -0.4, 1e-12);
        // Passive: the anchor lies half a millimetre behind the tip, and the anchor is what sticks at 5 mm.
        const double sticks = law == SnagLaw::passive ? 0.0055 : 0.005;
        tip.go(sticks - 1e-5);
        EXPECT_TRUE(tip.state.sliding);
        EXPECT_NEAR(tip.go(sticks + 2e-4), law == SnagLaw::passive ? -0.56 : -0.16, 1e-12)
            << "stuck at 5 mm, not where the cycle found it";
        EXPECT_FALSE(tip.state.sliding);
    }
}

TEST(Friction, SnagsTakeThePlaceOfCoulombFrictionWhereTheyAreInUse) {
    const Friction rough{.static_ = 2, .dynamic = 1.5};
    const auto law = [&](const Snag& snag) { return friction_law(rough, snag, 1000, free_limits); };
    EXPECT_EQ(law({}).static_, 2);
    EXPECT_EQ(law({.k_stick = 800}).dynamic, 1.5) << "without d_snap";
    EXPECT_EQ(law({.d_snap = 1e-3}).dynamic, 1.5) << "without k_stick";
    EXPECT_EQ(law(snags).static_, 0.8);
    EXPECT_EQ(law(snags).dynamic, 0.4);
    Snag strong = snags;
    strong.k_kinetic = 3;
    EXPECT_EQ(law(strong).dynamic, 0.8) << "never more than it holds";
    EXPECT_EQ(law({.k_kinetic = 0.3}).static_, 0.3) << "kinetic only";
    EXPECT_EQ(law({.k_kinetic = 0.3}).dynamic, 0.3);
}

TEST(Friction, WithoutADistanceASnagIsStaticFrictionWithoutASnapItIsKinetic) {
    for (const SnagLaw which : {SnagLaw::passive, SnagLaw::paper}) {
        Snag always = snags;
        always.d_mean = 0;
        always.law = which;
        Tip tip{snag_law(always)};
        for (int i = 0; i < 100; ++i) tip.go(1e-4 * i);
        EXPECT_NEAR(tip.go(0.02), -0.8, 1e-12) << "dragged by what a snag holds";
        EXPECT_NEAR(tip.go(0.02 - 0.0005), -0.4, 1e-12) << "stuck all the time";

        Snag kinetic = snags;
        kinetic.d_snap = 0;
        kinetic.law = which;
        Tip other{snag_law(kinetic)};
        for (int i = 0; i < 100; ++i) other.go(1e-4 * i);
        EXPECT_NEAR(other.go(0.02), -0.4, 1e-12);
        EXPECT_NEAR(other.go(0.03), -0.4, 1e-12);
    }
}

TEST(Friction, ThePapersLawSeesForwardMotionCeaseOnlyBeyondTwoCountsOfTheEncoder) {
    Snag snag = paper_snags;
    const Limits encoder{.resolution = 3e-5};
    Tip tip{snag_law(snag), encoder};
    for (const double x : {0.0, 0.0011, 0.003}) tip.go(x);
    EXPECT_NEAR(tip.go(0.003 - 5.9e-5), -0.4, 1e-12) << "noise";
    EXPECT_EQ(tip.go(0.003 - 6.1e-5), 0) << "a new snag, here";
    EXPECT_NEAR(tip.go(0.003 - 6.1e-5 - 1e-4), 0.08, 1e-12);
}

TEST(Friction, DistancesAreDrawnEvenlyFromTheirSpreadAndNeverBelowZero) {
    Snag snag = snags;
    snag.d_mean = 3e-3;
    snag.d_spread = 4e-3;
    Tip tip{snag_law(snag)};
    double sum = 0, least = 1, most = 0, last_snag = 0;
    int count = 0;
    bool was_sliding = false;
    for (int i = 0; i < 2'000'000; ++i) {
        tip.go(1e-5 * i);
        if (was_sliding && !tip.state.sliding) {
            const double distance = tip.state.anchor.x() - last_snag;
            if (count++ > 0)
                sum += distance, least = std::min(least, distance), most = std::max(most, distance);
            last_snag = tip.state.anchor.x();
        }
        was_sliding = tip.state.sliding;
    }
    // The anchor is dragged over the first half millimetre at once when a snag lets go.
    EXPECT_NEAR(sum / (count - 1), 3e-3, 5e-5) << count;
    EXPECT_GE(least, 1e-3 - 1e-12);
    EXPECT_LE(most, 5e-3 + 1e-12);
    EXPECT_NEAR(most - least, 4e-3, 1e-4);
}

TEST(Friction, ReplaysExactlyFromItsSeed) {
    const auto trace = [](std::uint32_t seed) {
        Snag snag = snags;
        snag.seed = seed;
        Tip tip{snag_law(snag)};
        std::vector<double> forces;
        for (int i = 0; i < 5000; ++i) forces.push_back(tip.go(5e-5 * i));
        return forces;
    };
    EXPECT_EQ(trace(1), trace(1));
    EXPECT_NE(trace(1), trace(2));
    EXPECT_NE(trace(0), trace(1));
}

// --- Several surfaces

TEST(Friction, SurfacesThatPushTogetherAreMixedByTheirShare) {
    FrictionLaw sum;
    double leading = 0;
    add_share(sum, leading, friction_law({.static_ = 1, .dynamic = 0.5, .viscous = 2}, {}, 1000, free_limits),
              0.75);
    add_share(sum, leading, friction_law({.dynamic = 0.1}, {}, 200, free_limits), 0.25);
    EXPECT_NEAR(sum.static_, 0.775, 1e-15);
    EXPECT_NEAR(sum.dynamic, 0.4, 1e-15);
    EXPECT_NEAR(sum.viscous, 1.5, 1e-15);
    EXPECT_NEAR(sum.stiffness, 800, 1e-12);
    EXPECT_EQ(sum.kind, FrictionLaw::Kind::coulomb);

    FrictionLaw both;
    leading = 0;
    add_share(both, leading, snag_law(snags), 0.4);
    EXPECT_EQ(both.kind, FrictionLaw::Kind::snag);
    add_share(both, leading, coulomb(1, 1), 0.6);
    EXPECT_EQ(both.kind, FrictionLaw::Kind::coulomb) << "the larger share says how it lets go";
    EXPECT_NEAR(both.static_, 0.4 * 0.8 + 0.6, 1e-15);
}

TEST(Friction, SharesThatFlickerDoNotMakeAHeldTipCreep) {
    // In a corner of a soft and a hard wall the shares follow the encoder's noise.
    Tip tip{coulomb(0.8, 0.8, 1000)};
    tip.go(0.0);
    tip.go(0.0005);
    double softest = 1;
    for (int i = 0; i < 60'000; ++i) {
        tip.law.stiffness = 1000 * (1 - 0.15 * ((i * 7919 % 100) / 100.0));
        softest = std::min(softest, -tip.go(0.0005));
    }
    EXPECT_NEAR(softest, 0.5 * 0.85, 0.005) << "not less than the softest spring holds";
}

TEST(Friction, ASurfaceThatFadesInGrips) {
    Tip tip{coulomb(0.8, 0.8, 0)};
    for (int i = 0; i <= 100; ++i) {
        tip.law.stiffness = 10 * i;
        tip.go(1e-6 * i);
    }
    EXPECT_NEAR(tip.go(0.0006), -0.5, 0.1);
}
