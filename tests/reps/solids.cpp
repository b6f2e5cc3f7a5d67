// Sphere, capsule, cylinder and torus, from outside and from within.

#include <optional>

#include <knurl/reps/capsule.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/torus.hpp>

#include "shape_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

// ---- The reference: the nearest point of the surface, in long double ----

struct Nearest {
    long double height;  // of p, less the probe's radius
    Long normal;
    bool deep = false;  // beyond half way through a hole that the probe plugs
};

Long axis_of(const auto& s) {
    return exact(s.axis).normalized();
}
Nearest from_point(const Long& p, const Long& core, long double reach, bool inside) {
    const Long out = p - core;
    const long double sign = inside ? -1 : 1;
    return {sign * (out.norm() - reach), sign * out.normalized()};
}

Nearest reference(const Sphere& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    return from_point(p, exact(s.center), s.radius + (inside ? -1.0L : 1.0L) * probe, inside);
}
Nearest reference(const Capsule& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    const Long from = exact(s.center) - s.half_length * axis_of(s),
               to = exact(s.center) + s.half_length * axis_of(s);
    const long double share = s.half_length > 0 ? (p - from).dot(to - from) / (to - from).squaredNorm() : 0;
    return from_point(p, from + std::clamp(share, 0.0L, 1.0L) * (to - from),
                      s.radius + (inside ? -1.0L : 1.0L) * probe, inside);
}
Nearest reference(const Torus& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    const Long q = p - exact(s.center), flat = q - axis_of(s).dot(q) * axis_of(s);
    const Long circle = s.radius * flat.normalized();
    const long double size = s.tube + (inside ? -1.0L : 1.0L) * probe;
    const Long foot = circle + size * (q - circle).normalized();
    if (inside || (foot + circle).norm() >= size)
        return from_point(p, exact(s.center) + circle, size, inside);
    // The foot lies in the tube on the other side: free is the axis beyond the point where both circles meet.
    const long double along = axis_of(s).dot(q), seat = std::sqrt(size * size - circle.squaredNorm());
    const Long out = std::copysign(seat, along) * axis_of(s) - q;
    return {-out.norm(), out.normalized(), std::abs(along) < seat / 2};
}
Nearest reference(const Cylinder& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    const Long a = axis_of(s), q = p - exact(s.center), flat = q - a.dot(q) * a;
    const long double along = a.dot(q), grow = inside ? -1.0L : 0.0L;
    const long double radius = s.radius + grow * probe, half = s.half_length + grow * probe;
    const Long on_wall = along * a + radius * flat.normalized();
    const Long on_end = std::copysign(half, along) * a + flat;
    const bool in_wall = flat.norm() <= radius, in_end = std::abs(along) <= half;
    if (inside) {  // the face that is violated most, or the nearest
        const bool wall = radius - flat.norm() <= half - std::abs(along);
        const long double h = wall ? radius - flat.norm() : half - std::abs(along);
        return {h, wall ? Long(-flat.normalized()) : Long(-std::copysign(1.0L, along) * a)};
    }
    if (in_wall && in_end) {
        const bool wall = (q - on_wall).norm() <= (q - on_end).norm();
        const Long out = wall ? Long(on_wall - q) : Long(on_end - q);
        return {-out.norm() - probe, wall ? flat.normalized() : Long(std::copysign(1.0L, along) * a)};
    }
    const Long nearest = in_wall  ? on_end
                         : in_end ? on_wall
                                  : Long(std::copysign(half, along) * a + radius * flat.normalized());
    return {(q - nearest).norm() - probe, (q - nearest).normalized()};
}

// ---- Any of them ----

double least_radius(const Sphere& s) {
    return s.radius;
}
double least_radius(const Capsule& s) {
    return s.radius;
}
double least_radius(const Torus& s) {
    return s.tube;
}
double least_radius(const Cylinder& s) {
    return std::min(s.radius, s.half_length);
}

double largest(const Sphere& s) {
    return s.radius;
}
double largest(const Capsule& s) {
    return s.radius + s.half_length;
}
double largest(const Torus& s) {
    return s.radius + s.tube;
}
double largest(const Cylinder& s) {
    return std::isinf(s.half_length) ? s.radius : s.radius + s.half_length;
}

template <class R>
R random_solid(Rng& rng, double size) {
    R s{.center = to_plain(Vector(size * direction(rng))), .stiffness = 1000};
    if constexpr (requires { s.axis; }) s.axis = to_plain(Vector(scale(rng, 0.01, 100) * direction(rng)));
    s.radius = size * scale(rng, 0.2, 1);
    if constexpr (requires { s.half_length; }) s.half_length = size * scale(rng, 0.2, 1);
    if constexpr (requires { s.tube; }) s.tube = s.radius * scale(rng, 0.1, 0.9);
    return s;
}

// A point about its surface: along the axis, around and inside.
template <class R>
Vector some_point(Rng& rng, const R& s, double probe = 0) {
    return to_eigen(s.center) + 1.5 * (largest(s) + probe) * std::cbrt(uniform(rng, 0, 1)) * direction(rng);
}

// Whether another face of the solid comes nearer on the straight way in.
template <class R>
bool straight_in(const R& s, const Vector& surface, const Vector& n, double depth, double probe) {
    return std::abs(reference(s, (surface - depth * n).cast<long double>(), probe).height + depth) < 1e-12L;
}

template <class R>
struct Solids : testing::Test {
    static constexpr std::uint64_t seed = 8101;
    Rng random{seed};
};
using All = testing::Types<Sphere, Capsule, Cylinder, Torus>;
TYPED_TEST_SUITE(Solids, All);

}  // namespace

TYPED_TEST(Solids, HeightAndNormalAreThoseOfTheNearestPointOfTheSurface) {
    Rng& rng = this->random;
    for (int round = 0; round < (long_form() ? 1'000'000 : 40'000); ++round) {
        const double size = round % 4 == 0 ? 1e-6 : round % 4 == 1 ? scale(rng, 1e-3, 10) : 0.03;
        TypeParam s = random_solid<TypeParam>(rng, size);
        if (round % 5 == 0) s.center = to_plain(Vector(1e6 * direction(rng)));
        if (round % 3 == 0) s.side = Side::inside;
        const bool inside = s.side == Side::inside;
        const double probe = round % 2 ? 0 : uniform(rng, 0, 0.99) * least_radius(s);
        const Vector p = some_point(rng, s);
        const Nearest want = reference(s, p.cast<long double>(), probe);
        const double core = inside ? least_radius(s) - probe : least_radius(s) + probe;
        if (want.deep || (!inside && want.height < -core / 2)) continue;  // kept from there on: below
        const Contact c = Asked<TypeParam>(s)(p, probe);
        const double entering = std::max({to_eigen(s.center).norm(), p.norm(), largest(s)});
        ASSERT_NEAR(c.height, static_cast<double>(want.height), 1e-14 * entering)
            << "seed " << this->seed << " round " << round;
        const double away =
            std::max(1e-3 * core, static_cast<double>(std::abs(want.height + (inside ? -core : core))));
        ASSERT_LE((c.normal.cast<long double>() - want.normal).norm(), 1e-14 * (2 + entering / away))
            << "seed " << this->seed << " round " << round;
        ASSERT_NEAR(c.normal.norm(), 1, 5e-15);
    }
}

TYPED_TEST(Solids, TheNormalIsTheHeightsGradient) {
    Rng& rng = this->random;
    int compared = 0;
    for (int round = 0; round < 4000; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.03);
        if (round % 3 == 0) s.side = Side::inside;
        const double probe = round % 2 ? 0 : 0.3 * least_radius(s);
        const Vector p = some_point(rng, s);
        Asked<TypeParam> surface(s);
        const auto height = [&](const Vector& at) { return Asked<TypeParam>(s)(at, probe).height; };
        const double h = height(p);
        if (std::abs(h) < 2e-6 || h < -0.4 * (least_radius(s) + (s.side == Side::inside ? -probe : probe)))
            continue;
        Vector g;
        for (int i = 0; i < 3; ++i) {
            const Vector e = 1e-6 * Vector::Unit(i);
            g[i] = (height(p + e) - height(p - e)) / 2e-6;
        }
        if (g.norm() < 0.99) continue;  // two parts of the surface are equally near
        EXPECT_LE((surface(p, probe).normal - g).norm(), 1e-4 + 1e-6 / least_radius(s)) << "round " << round;
        ++compared;
    }
    EXPECT_GT(compared, 1500);
}

TYPED_TEST(Solids, PressedDeeperThanHalfWayToItsCoreItKeepsTheNormalAndTheDepth) {
    Rng& rng = this->random;
    for (int round = 0; round < 200; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.03);
        if constexpr (requires { s.tube; })
            s.tube = std::min(s.tube, s.radius / 2), s.radius += 0.005;  // nothing plugs its hole
        const double probe = round % 2 ? 0 : 0.005, half = (least_radius(s) + probe) / 2;
        // From outside towards the core, on the straight way through, and out on the other side.
        Vector p;
        Nearest start;
        do {
            p = some_point(rng, s, probe);
            start = reference(s, p.cast<long double>(), probe);
        } while (start.height < 1e-4);
        const Vector n = start.normal.cast<double>();
        const Vector surface = p - static_cast<double>(start.height) * n;
        if (!straight_in(s, surface, n, half, probe)) continue;
        Asked<TypeParam> solid(s);
        solid(p, probe);
        const double last = 2 * (largest(s) + probe) + half;
        bool out = false;
        for (double depth = 0; depth < last && !out; depth += half / 100) {
            const Contact c = solid(surface - depth * n, probe);
            const long double natural = reference(s, (surface - depth * n).cast<long double>(), probe).height;
            if (depth > half && std::abs(natural) < 1e-12L) continue;
            out = depth > half && natural >= 0;
            if (out) {
                EXPECT_GE(c.height, 0) << "released, round " << round;
            } else {
                ASSERT_NEAR(c.height, -std::min(depth, half), 1e-12)
                    << "round " << round << " depth " << depth;
                ASSERT_LE((c.normal - n).norm(), 1e-9) << "round " << round << " depth " << depth;
            }
        }
        EXPECT_TRUE(out);
    }
}

TYPED_TEST(Solids, TheWayBackOutOfTheDepthIsTheWayIn) {
    Rng& rng = this->random;
    for (int round = 0; round < 200; ++round) {
        const TypeParam s = random_solid<TypeParam>(rng, 0.03);
        const double half = least_radius(s) / 2, deepest = 1.5 * half;
        Vector p;
        do {
            p = some_point(rng, s);
        } while (reference(s, p.cast<long double>(), 0).height < 1e-4);
        const Nearest start = reference(s, p.cast<long double>(), 0);
        const Vector n = start.normal.cast<double>(), surface = p - static_cast<double>(start.height) * n;
        if (!straight_in(s, surface, n, half, 0)) continue;
        Asked<TypeParam> solid(s);
        std::vector<double> in;
        for (int i = 0; i <= 100; ++i) in.push_back(solid(surface - deepest * i / 100 * n).height);
        for (int i = 100; i >= 0; --i)
            ASSERT_NEAR(solid(surface - deepest * i / 100 * n).height, in[(std::size_t)i], 1e-12);
        EXPECT_GE(solid(p).height, 0);
    }
}

TYPED_TEST(Solids, NoWayThroughItGivesTheHandMoreThanItPutIn) {
    Rng& rng = this->random;
    for (int round = 0; round < 60; ++round) {
        const TypeParam s = random_solid<TypeParam>(rng, 0.02);
        Asked<TypeParam> solid(s);
        SmallLoop loop(rng, to_eigen(s.center), 0.02);
        double sum = 0, gained = 0;
        Vector p = loop.at(0);
        bool outside = false;
        constexpr int steps = 40'000;
        for (int i = 0; i < 2 * steps; ++i) {
            const Vector next = loop.at(2 * M_PI * (i + 1) / steps);
            const Contact c = solid((p + next) / 2);
            sum += force_of(c).dot(next - p);
            p = next;
            if (c.height >= 0) {  // from one time outside to the next
                if (outside) gained = std::max(gained, sum);
                outside = true;
                sum = 0;
            }
        }
        EXPECT_LE(gained, 5e-5) << "J; round " << round;  // the edges of a cylinder cost the quadrature that
    }
}

TYPED_TEST(Solids, GivesBackTheWorkOfEveryClosedLoopInItsSurface) {
    Rng& rng = this->random;
    for (int round = 0; round < 60; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.05);
        s.radius = 0.03;
        if constexpr (requires { s.tube; }) s.tube = 0.012;
        if constexpr (requires { s.half_length; }) s.half_length = 0.02;
        if (round % 3 == 0) s.side = Side::inside;
        const bool inside = s.side == Side::inside;
        const double probe = 0.004 + (inside ? 0 : 0.002);  // loops of a cylinder go round its rounded edge
        Vector p;
        Nearest on;
        do {
            p = some_point(rng, s, probe);
            on = reference(s, p.cast<long double>(), probe);
        } while (std::abs(on.height) > 0.02 || (inside && on.height > 0.007));
        p -= static_cast<double>(on.height + 0.001L) * on.normal.cast<double>();
        if (reference(s, p.cast<long double>(), probe).height > 0) continue;
        Asked<TypeParam> solid(s);
        const SmallLoop loop(rng, p, 0.0008);
        const double sum = work_along(loop, 40'000, [&](const Vector& at) -> Vector {
            if constexpr (requires { TypeParam::max_contacts; }) {
                Contact out[2];
                Probe hand = knurl::test::at(at);
                hand.radius = probe;
                const std::uint32_t count = contacts(solid.params, solid.state, hand, dt, out);
                Vector f = Vector::Zero();  // two faces of a corner are at right angles: each as if alone
                for (std::uint32_t i = 0; i < count; ++i) f += force_of(out[i]);
                return f;
            } else {
                return force_of(solid(at, probe));
            }
        });
        EXPECT_LE(std::abs(sum), 1e-8) << "J; seed " << this->seed << " round " << round;
    }
}

TYPED_TEST(Solids, AskedAgainInTheSameCycleItGivesTheSameBitsAndKeepsNoTraceOfIt) {
    Rng& rng = this->random;
    for (int round = 0; round < 100; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.02);
        s.velocity = to_plain(Vector(0.01 * direction(rng)));
        if (round % 4 == 0) s.side = Side::inside;
        Asked<TypeParam> once(s), again(s);
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
            again(some_point(rng, s), 0, 0);  // nor of a look elsewhere
        }
    }
}

TYPED_TEST(Solids, OutOfItsBoundItIsNotTouchedAndRemembersNothing) {
    Rng& rng = this->random;
    for (int round = 0; round < 200; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.02);
        if (round % 2) s.velocity = to_plain(Vector(0.05 * direction(rng)));
        Asked<TypeParam> always(s), sometimes(s);
        for (int i = 0; i < 200; ++i) {
            Vector p = to_eigen(s.center);
            if (between(rng, 0, 4) != 0)  // else right into the core
                p += 2 * largest(s) * uniform(rng, 0, 1) * direction(rng);
            const Contact a = always(p);
            const std::optional<Bound> ball = bound(always.params, always.state);
            ASSERT_TRUE(ball);
            EXPECT_LE((ball->center - to_eigen(s.center) - i * dt * to_eigen(s.velocity)).norm(), 1e-15);
            if ((p - ball->center).norm() > ball->radius) {
                ASSERT_GT(a.height, 0) << "round " << round;
                out_of_reach(sometimes.params, sometimes.state);
                sometimes.state.motion = always.state.motion;
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
                    Asked<TypeParam> surface(s);
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
        Asked<TypeParam> solid(s);
        solid(core + 0.9 * least_radius(s) * normal);
        const Contact c = solid(core);
        EXPECT_LE((c.normal - normal).norm(), 1e-13);
        EXPECT_EQ(c.height, -least_radius(s) / 2);
    }
}

TYPED_TEST(Solids, AProbeWithARadiusMakesTheSolidLargerAndTheHollowSmaller) {
    Rng& rng = this->random;
    for (int round = 0; round < 1000; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.02);
        if (round % 2) s.side = Side::inside;
        double probe = uniform(rng, 0, 0.9) * least_radius(s);
        if constexpr (requires { s.tube; })
            probe = std::min(probe, 0.9 * (s.radius - s.tube));  // passes the hole
        const Vector p = some_point(rng, s);
        if (reference(s, p.cast<long double>(), 0).height < 0) continue;
        EXPECT_NEAR(Asked<TypeParam>(s)(p, probe).height, Asked<TypeParam>(s)(p).height - probe, 1e-16);
    }
}

TYPED_TEST(Solids, AProbeLargerThanTheHollowIsHeldInItsMiddle) {
    Rng& rng = this->random;
    TypeParam s = random_solid<TypeParam>(rng, 0.02);
    s.side = Side::inside;
    Vector core = to_eigen(s.center);
    if constexpr (requires { s.tube; }) core += s.radius * to_eigen(s.axis).normalized().unitOrthogonal();
    Asked<TypeParam> surface(s);
    EXPECT_NEAR(surface(core, 1.0).height, 0, 1e-15);
    for (int i = 0; i < 1000; ++i) {
        const double away = scale(rng, 1e-9, 1e-3);
        const Contact c = surface(core + away * direction(rng), 1.0);
        EXPECT_LE(-c.height, away * (1 + 1e-6)) << "no jump at the middle";
    }
}

TYPED_TEST(Solids, MovesOnWithItsVelocityUntilItIsPlacedAgain) {
    TypeParam s{.velocity = {0.1, 0, 0}};
    Asked<TypeParam> solid(s), still(TypeParam{});
    const Vector p(0.04, 0.001, 0.002);
    EXPECT_EQ(solid(p).height, still(p).height) << "the cycle that places it";
    for (int i = 1; i <= 5; ++i) {
        EXPECT_NEAR(solid(p).height, still(p - 0.1 * i * dt * Vector::UnitX()).height, 1e-15);
        EXPECT_EQ(solid(p).velocity, Vector(0.1, 0, 0));
        i = i + 1;  // two calls, two cycles
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
    Asked<TypeParam> solid(s);
    const double r = least_radius(s);
    for (double depth = -0.1 * r; depth < 0.8 * r; depth += 0.01 * r)
        solid(core + (r - depth) * Vector::UnitX());
    const Vector p = core + 0.2 * r * Vector::UnitX();
    EXPECT_NEAR(solid(p).height, -r / 2, 1e-15);
    s.center.x = -0.7 * r;  // now nearer to the surface over it
    solid.update(s);
    EXPECT_NEAR(solid(p).height, -0.1 * r, 1e-15);
    EXPECT_NEAR(solid(p).normal.x(), 1, 1e-15);
    s.side = Side::inside;
    solid.update(s);
    EXPECT_EQ(solid.state.core.normal, Vec3{});
    EXPECT_NEAR(solid(p).height, 0.1 * r, 1e-15);
    EXPECT_NEAR(solid(p).normal.x(), -1, 1e-15);
}

TEST(Sphere, OfNoRadiusIsAPointThatAProbeWithARadiusFeels) {
    Asked<Sphere> point({.center = {0.1, 0, 0}, .radius = 0});
    EXPECT_NEAR(point({0.1, 0, 0.004}, 0.005).height, -0.001, 1e-16);
    EXPECT_EQ(point({0.1, 0, 0}, 0).height, 0) << "one without does not";
}

TEST(Capsule, OfNoLengthIsASphereAndOfNoRadiusANeedle) {
    Rng rng(8102);
    for (int round = 0; round < 1000; ++round) {
        const Vector p = 0.02 * direction(rng);
        Asked<Capsule> capsule({.axis = {1, 2, 3}, .half_length = 0, .radius = 0.01});
        Asked<Sphere> sphere({.radius = 0.01});
        EXPECT_EQ(capsule(p).height, sphere(p).height);
    }
    Asked<Capsule> needle({.half_length = 0.02, .radius = 0});
    EXPECT_NEAR(needle({0.004, 0, 0.01}, 0.005).height, -0.001, 1e-16);
    EXPECT_EQ(needle({0, 0, 0.01}, 0).height, 0);
}

TEST(Cylinder, WithoutEndsIsTheSameAllAlongItsAxis) {
    Rng rng(8103);
    for (const Side side : {Side::outside, Side::inside}) {
        const Cylinder endless{.axis = {1, 1, 0}, .radius = 0.01, .half_length = infinity, .side = side};
        const Cylinder finite{.axis = {1, 1, 0}, .radius = 0.01, .half_length = 1e3, .side = side};
        EXPECT_FALSE(bound(prepared(endless, {}), {}));
        for (int round = 0; round < 1000; ++round) {
            const Vector p = 0.015 * direction(rng);
            Asked<Cylinder> a(endless), b(finite);
            const double probe = round % 2 ? 0.002 : 0;
            EXPECT_EQ(a(p, probe).height, b(p, probe).height);
            const Vector along = uniform(rng, -1000, 1000) * Vector(1, 1, 0).normalized();
            EXPECT_NEAR(a(p + along, probe).height, b(p, probe).height, 1e-12);
        }
        Contact out[2];
        Asked<Cylinder> a(endless);
        EXPECT_EQ(contacts(a.params, a.state, at({0, 0.1, 0}), dt, out), 1u);
    }
}

TEST(Cylinder, OfNoLengthIsADiscThatAProbeWithARadiusFeelsFromEitherSide) {
    Asked<Cylinder> disc({.radius = 0.02, .half_length = 0});
    for (const double side : {1.0, -1.0}) {
        for (double z = 0.006; z > -0.0049; z -= 0.0001) {
            const Contact c = disc({0.003, 0, side * z}, 0.005);
            EXPECT_NEAR(c.height, std::max(z - 0.005, -0.0025), 1e-15);
            EXPECT_EQ(c.normal.z(), side) << "also behind its middle";
        }
        disc({0.003, 0, -side * 0.006}, 0.005);
    }
}

TEST(Cylinder, TheHollowHoldsAtWallAndEndAtOnce) {
    Asked<Cylinder> tin({.radius = 0.03, .half_length = 0.05, .side = Side::inside});
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

// Where a ball larger than the hole comes to rest in it: both circles' nearest point, 0.012^2 = 0.01^2 +
// seat^2.
TEST(Torus, AProbeThatPlugsTheHoleIsDrawnBackToItsSeatOnTheAxis) {
    Asked<Torus> ring({.radius = 0.01, .tube = 0.002});
    const double seat = std::sqrt(0.012 * 0.012 - 0.01 * 0.01);
    for (const double side : {1.0, -1.0}) {
        for (const double x : {-1e-3, -1e-12, 0.0, 1e-12, 1e-3}) {
            const Vector p(x, 0, side * 0.005), to = Vector(0, 0, side * seat) - p;
            const Contact c = ring({x, 0, side * 0.02}, 0.01), in = ring(p, 0.01);
            EXPECT_GT(c.height, 0);
            EXPECT_NEAR(in.height, -to.norm(), 1e-15);
            EXPECT_LE((in.normal - to.normalized()).norm(), 1e-12);
        }
    }
    EXPECT_GT(ring({0, 0, 0}, 0.007).height, 0) << "a smaller one goes through";
}

TEST(Torus, AProbeThatIsPushedThroughTheHoleThatItPlugsIsHeldFromHalfWayOn) {
    Asked<Torus> ring({.radius = 0.01, .tube = 0.002});
    const double seat = std::sqrt(0.012 * 0.012 - 0.01 * 0.01);
    ring({1e-6, 0, 0.01}, 0.01);
    for (double z = seat - 1e-4; z > -seat; z -= 1e-4) {
        const Contact c = ring({1e-6, 0, z}, 0.01);
        EXPECT_GT(c.normal.z(), 0.9) << "back to where it came from, at " << z;
        EXPECT_NEAR(c.height, -std::min(seat - z, seat / 2), 1e-7) << z;
    }
    EXPECT_GE(ring({1e-6, 0, -seat - 1e-4}, 0.01).height, 0) << "through";
}
