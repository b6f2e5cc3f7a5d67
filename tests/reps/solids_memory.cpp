// A solid's memory of the hand, and the effects of a probe's radius and of the solid's own motion.

#include "solids_reference.hpp"

using namespace knurl;
using namespace knurl::test;

TYPED_TEST(Solids, AskedAgainInTheSameCycleItGivesTheSameBitsAndKeepsNoTraceOfIt) {
    Rng& rng = this->random;
    for (int round = 0; round < 100; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.02);
        s.velocity = to_plain(Vector(0.01 * direction(rng)));
        if (round % 4 == 0) s.side = Side::inside;
        Evaluated<TypeParam> once(s), again(s);
        Vector p = some_point(rng, s);
        for (int i = 0; i < 200; ++i) {
            p = between(rng, 0, 9) == 0 ? some_point(rng, s) : p + 0.001 * direction(rng);
            const Contact a = once(p), b = again(p);
            for (int k = 0; k < 2; ++k) {
                const Contact c = again(p, 0, 0);
                ASSERT_EQ(c.height, a.height) << "round " << round << " cycle " << i;
                ASSERT_EQ(c.normal, a.normal) << "round " << round << " cycle " << i;
            }
            ASSERT_EQ(a.height, b.height);
            again(some_point(rng, s), 0, 0);  // nor from an evaluation elsewhere
        }
    }
}

TYPED_TEST(Solids, OutOfItsBoundItIsNotTouchedAndRemembersNothing) {
    Rng& rng = this->random;
    for (int round = 0; round < 200; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.02);
        if (round % 2) s.velocity = to_plain(Vector(0.05 * direction(rng)));
        Evaluated<TypeParam> always(s), sometimes(s);
        for (int i = 0; i < 200; ++i) {
            Vector p = to_eigen(s.center);
            if (between(rng, 0, 4) != 0)  // else right into the core
                p += 2 * largest(s) * uniform(rng, 0, 1) * direction(rng);
            const Contact a = always(p);
            const std::optional<Bound> ball = bound(always.params, always.state);
            ASSERT_EQ(!ball, always.state.hold.part != 0) << "what it holds it holds wherever that is";
            const Vector moved = to_eigen(s.center) + i * dt * to_eigen(s.velocity);
            EXPECT_LE(ball ? (ball->center - moved).norm() : 0, 1e-15);
            if (ball && (p - ball->center).norm() > ball->radius) {
                ASSERT_GT(a.height, 0) << "round " << round;
                // When it is evaluated again it learns the probe's side.
                out_of_reach(sometimes.params, sometimes.state);
                sometimes.state.motion = {.time = always.state.motion.time, .placed = 1};
                sometimes(p);
            } else {
                const Contact b = sometimes(p);
                ASSERT_EQ(a.height, b.height) << "round " << round << " cycle " << i;
                ASSERT_EQ(a.normal, b.normal) << "round " << round << " cycle " << i;
            }
        }
        s.side = Side::inside;
        EXPECT_FALSE(bound(s, always.state)) << "a hollow one holds from anywhere";
    }
}

TYPED_TEST(Solids, OnItsCoreTheNormalIsTheLastOneOrAnyButNeverNothing) {
    Rng& rng = this->random;
    for (int round = 0; round < 200; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.02);
        if (round % 3 == 0) s.side = Side::inside;
        if (round % 3 == 1) {  // where these sums are exact
            s.center = {};
            if constexpr (requires { s.axis; }) s.axis = {0, 0, 1};
        }
        Vector axis = Vector::Zero(), off = Vector::Zero();
        if constexpr (requires { s.axis; }) axis = to_eigen(s.axis).normalized();
        if constexpr (requires { s.tube; })
            off = s.radius * (round % 3 == 1 ? Vector(1, 0, 0) : axis.unitOrthogonal());
        for (const double along : {0.0, 0.3 * s.radius, 100 * s.radius}) {
            for (const double probe : {0.0, 0.01, 10.0}) {
                for (const Vector& core :
                     {Vector(to_eigen(s.center) + along * axis), Vector(to_eigen(s.center) + off)}) {
                    Evaluated<TypeParam> surface(s);
                    for (int i = 0; i < 3; ++i) {
                        const Contact c = surface(core, probe);
                        ASSERT_TRUE(std::isfinite(c.height));
                        ASSERT_NEAR(c.normal.norm(), 1, 1e-12);
                        for (const double step : {1e-300, 1e-160, 1e-30, 1e-12}) {
                            const Contact d = surface(core + step * direction(rng), probe);
                            ASSERT_TRUE(std::isfinite(d.height));
                            ASSERT_NEAR(d.normal.norm(), 1, 1e-12);
                        }
                    }
                }
            }
        }
    }
}

TYPED_TEST(Solids, JumpedRightIntoItsCoreItKeepsTheNormalOfLastCycle) {
    TypeParam s{};
    Vector core = Vector::Zero();
    if constexpr (requires { s.tube; }) core.x() = s.radius;
    for (const Vector& normal : {Vector(1, 0, 0), Vector(-1, 0, 0)}) {
        Evaluated<TypeParam> solid(s);
        solid(core + 0.9 * least_radius(s) * normal);
        const Contact c = solid(core);
        EXPECT_LE((c.normal - normal).norm(), 1e-13);
        EXPECT_EQ(c.height, -least_radius(s));
    }
}

TYPED_TEST(Solids, AProbeLargerThanTheHollowIsHeldInItsMiddle) {
    Rng& rng = this->random;
    TypeParam s = random_solid<TypeParam>(rng, 0.02);
    s.side = Side::inside;
    Vector core = to_eigen(s.center);
    if constexpr (requires { s.tube; }) core += s.radius * to_eigen(s.axis).normalized().unitOrthogonal();
    Evaluated<TypeParam> surface(s);
    EXPECT_NEAR(surface(core, 1.0).height, 0, 1e-15);
    for (int i = 0; i < 1000; ++i) {
        const double away = scale(rng, 1e-9, 1e-3);
        const Contact c = surface(core + away * direction(rng), 1.0);
        EXPECT_LE(-c.height, away * (1 + 1e-6)) << "no jump at the middle";
    }
}

TYPED_TEST(Solids, MovesOnWithItsVelocityUntilItIsPlacedAgain) {
    TypeParam s{.velocity = {0.1, 0, 0}};
    Evaluated<TypeParam> solid(s), still(TypeParam{});
    const Vector p(0.04, 0.001, 0.002);
    EXPECT_EQ(solid(p).height, still(p).height) << "the cycle that places it";
    for (int i = 1; i <= 5; i += 2) {  // two calls, two cycles
        EXPECT_NEAR(solid(p).height, still(p - 0.1 * i * dt * Vector::UnitX()).height, 1e-15);
        EXPECT_EQ(solid(p).velocity, Vector(0.1, 0, 0));
    }
    s.radius = 0.011;
    if constexpr (requires { s.tube; }) s.radius = 0.02, s.tube = 0.006;
    solid.update(s);
    EXPECT_NEAR(solid(p).height + 0.001, still(p - 0.1 * 7 * dt * Vector::UnitX()).height, 1e-15)
        << "only larger";
    s.center = {0.0001, 0, 0};
    solid.update(s);
    EXPECT_NEAR(solid(p).height + 0.001, still(p - 0.0001 * Vector::UnitX()).height, 1e-15);
}

TYPED_TEST(Solids, AKeptNormalStaysWithTheSolidThatMovesAndIsForgottenByOneTurnedInsideOut) {
    TypeParam s{};
    Vector core = Vector::Zero();
    if constexpr (requires { s.tube; }) core.x() = s.radius;
    Evaluated<TypeParam> solid(s);
    const double r = least_radius(s);
    for (double depth = -0.1 * r; depth < 0.8 * r; depth += 0.01 * r)
        solid(core + (r - depth) * Vector::UnitX());
    const Vector p = core + 0.2 * r * Vector::UnitX();
    EXPECT_NEAR(solid(p).height, -0.8 * r, 1e-15);
    s.center.x = -0.7 * r;  // now nearer to the surface over it
    solid.update(s);
    EXPECT_NEAR(solid(p).height, -0.1 * r, 1e-15);
    EXPECT_NEAR(solid(p).normal.x(), 1, 1e-15);
    s.side = Side::inside;
    solid.update(s);
    EXPECT_EQ(solid.state.hold.normal, Vec3{});
    EXPECT_NEAR(solid(p).height, 0.1 * r, 1e-15);
    EXPECT_NEAR(solid(p).normal.x(), -1, 1e-15);
}
