// Solids at their limits: without radius, length or ends, and holes that a probe plugs.

#include "solids_reference.hpp"

using namespace knurl;
using namespace knurl::test;

TEST(Cylinder, WithoutEndsIsTheSameAllAlongItsAxis) {
    Rng rng(8103);
    for (const Side side : {Side::outside, Side::inside}) {
        const Cylinder endless{.axis = {1, 1, 0}, .radius = 0.01, .half_length = infinity, .side = side};
        const Cylinder finite{.axis = {1, 1, 0}, .radius = 0.01, .half_length = 1e3, .side = side};
        EXPECT_FALSE(bound(prepared(endless, {}), {}));
        for (int round = 0; round < 1000; ++round) {
            const Vector p = 0.015 * direction(rng);
            Evaluated<Cylinder> a(endless), b(finite);
            const double probe = round % 2 ? 0.002 : 0;
            EXPECT_EQ(a(p, probe).height, b(p, probe).height);
            const Vector along = uniform(rng, -1000, 1000) * Vector(1, 1, 0).normalized();
            EXPECT_NEAR(a(p + along, probe).height, b(p, probe).height, 1e-12);
        }
        Contact out[2];
        Evaluated<Cylinder> a(endless);
        EXPECT_EQ(contacts(a.params, a.state, at({0, 0.1, 0}), dt, out), 1u);
    }
}

TEST(Cylinder, OfNoLengthIsADiscThatAProbeWithARadiusFeelsFromEitherSide) {
    for (const double side : {1.0, -1.0}) {
        Evaluated<Cylinder> disc({.radius = 0.02, .half_length = 0});
        for (double z = 0.006; z > -0.0199; z -= 0.0001) {
            const Contact c = disc({0.003, 0, side * z}, 0.005);
            EXPECT_NEAR(c.height, z - 0.005, 1e-15);
            EXPECT_EQ(c.normal.z(), side) << "also behind it";
        }
    }
}

TEST(Cylinder, TheHollowHoldsAtWallAndEndAtOnce) {
    Evaluated<Cylinder> tin({.radius = 0.03, .half_length = 0.05, .side = Side::inside});
    Contact out[2];
    Probe probe = at({0.029, 0, -0.048});
    probe.radius = 0.004;
    ASSERT_EQ(contacts(tin.params, tin.state, probe, dt, out), 2u);
    EXPECT_NEAR(out[0].height, 0.026 - 0.029, 1e-16);
    EXPECT_EQ(out[0].normal, Vector(-1, 0, 0));
    EXPECT_NEAR(out[1].height, 0.046 - 0.048, 1e-16);
    EXPECT_EQ(out[1].normal, Vector(0, 0, 1));
    EXPECT_EQ(contact(tin.params, tin.state, probe, dt).height, out[0].height) << "alone: the deeper";
    EXPECT_EQ(contacts(tin.params, tin.state, probe, dt, std::span(out, 1)), 1u);
}

TEST(Torus, WithoutAHoleIsRefused) {
    const Torus torus{.radius = 0.02, .tube = 0.02};
    const Verdict verdict = Describe<Torus>::check(torus);
    EXPECT_EQ(verdict.code, Verdict::Code::contradiction);
    EXPECT_EQ(Describe<Torus>::fields[verdict.field].name, "tube");
    EXPECT_EQ(Describe<Torus>::contradictions[verdict.reason],
              "leaves no hole in the ring; give less than radius");
}

// Where a ball larger than the hole rests in it: the nearest point of both circles, 0.012^2 = 0.01^2 +
// seat^2.
TEST(Torus, AProbeThatPlugsTheHoleIsDrawnBackToItsSeatOnTheAxis) {
    const double seat = std::sqrt(0.012 * 0.012 - 0.01 * 0.01);
    for (const double side : {1.0, -1.0}) {
        for (const double x : {-1e-3, -1e-12, 0.0, 1e-12, 1e-3}) {
            Evaluated<Torus> ring({.radius = 0.01, .tube = 0.002});
            const Vector p(x, 0, side * 0.005), to = Vector(0, 0, side * seat) - p;
            const Contact c = ring({x, 0, side * 0.02}, 0.01), in = ring(p, 0.01);
            EXPECT_GT(c.height, 0);
            EXPECT_NEAR(in.height, -to.norm(), 1e-15);
            EXPECT_LE((in.normal - to.normalized()).norm(), 1e-12);
        }
    }
    EXPECT_GT(Evaluated<Torus>({.radius = 0.01, .tube = 0.002})({0, 0, 0}, 0.007).height, 0)
        << "a smaller one goes through";
}

TEST(Torus, AProbeThatIsPushedThroughTheHoleThatItPlugsIsHeldFromHalfWayOn) {
    Evaluated<Torus> ring({.radius = 0.01, .tube = 0.002});
    const double seat = std::sqrt(0.012 * 0.012 - 0.01 * 0.01);
    ring({1e-6, 0, 0.01}, 0.01);
    for (double z = seat - 1e-4; z > -2 * seat; z -= 1e-4) {
        const Contact c = ring({1e-6, 0, z}, 0.01);
        EXPECT_GT(c.normal.z(), 0.9) << "back to where it came from, at " << z;
        EXPECT_NEAR(c.height, -(seat - z), 1e-6) << z;
    }
    EXPECT_GE(ring({1e-6, 0, seat + 1e-4}, 0.01).height, 0) << "back";
}
