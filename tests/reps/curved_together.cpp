// Curved surfaces that together hold the hand do so at the nearest point that satisfies the surfaces
// themselves.

#include <knurl/reps/curved_contact.hpp>

#include "curved_reference.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

/// Two to four surfaces about the origin, and a loop of the hand through them.
struct Meeting {
    Scene scene = make_scene();
    std::vector<Distances> all;
    SmallLoop loop;

    Meeting(Rng& rng, bool mixed, double size = 0.0015) : loop(rng, Vector(0, 0, -0.001), size) {
        const int count = between(rng, 2, 4);
        for (int i = 0; i < count; ++i)
            all.push_back(add_near_origin(rng, scene, static_cast<std::uint32_t>(i), 0.001,
                                          mixed ? scale(rng, 100, 2000) : 1000, 0.01, 0.05));
        scene.settle();
        for (int i = 0; i <= 100; ++i)  // from above, where a piece is entered from its front
            scene.evaluate(at(Vector(loop.at(0) + Vector(0, 0, 1e-4 * (100 - i)))), dt);
    }
};

/// A groove of two capsules along y: their surfaces meet in x = z = 0 at a right angle or less.
struct Groove {
    double radius = 0.015, apart = 0.0135;  // m: from the middle
    Scene scene = make_scene();

    explicit Groove(double stiffness) {
        for (const double side : {-1.0, 1.0}) {
            const Capsule capsule{.center = {side * apart, 0, -std::sqrt(radius * radius - apart * apart)},
                                  .axis = {0, 1, 0},
                                  .half_length = 0.05,
                                  .radius = radius,
                                  .stiffness = stiffness};
            EXPECT_TRUE(scene.add({side > 0 ? 1u : 0u, 1}, capsule));
        }
        scene.settle();
    }
};

template <class R>
void expect_bend_is_the_normals_derivative(Rng& rng, const R& raw) {
    Evaluated<R> surface(raw);
    for (int i = 0; i < 40; ++i) {
        const Vector p = 0.02 * Vector(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1));
        const auto there = [&](const Vector& x) {
            std::array<CurvedContact, 3> out;
            const Probe probe = at(x);
            EXPECT_GE(curved(surface.params, surface.state, probe, probe, out), 1u);
            return out[0];
        };
        const CurvedContact middle = there(p);
        Eigen::Matrix3d want;
        constexpr double h = 1e-7;
        bool smooth = true;  // not over a rim or at the beginning of a capsule's end
        for (int axis = 0; axis < 3; ++axis) {
            const CurvedContact before = there(p - h * Vector::Unit(axis)),
                                after = there(p + h * Vector::Unit(axis));
            want.col(axis) = (after.normal - before.normal) / (2 * h);
            smooth = smooth && (after.bend - before.bend).norm() < 1e-3 * (1 + middle.bend.norm());
            EXPECT_NEAR((after.height - before.height) / (2 * h), middle.normal[axis], 1e-6);
        }
        if (smooth) {
            EXPECT_LE((want - middle.bend).norm(), 1e-5 * (1 + middle.bend.squaredNorm()));
        }
    }
}

}  // namespace

TEST(CurvedTogether, HoldTheHandAtTheNearestPointThatSatisfiesThem) {
    const std::uint64_t seed = 2601;
    Rng rng(seed);
    long several = 0, cycles = 0, few = 0;
    for (int round = 0; round < (long_form() ? 1000 : 120); ++round) {
        Meeting meeting(rng, false);
        constexpr int steps = 100;
        for (int i = 0; i < steps; ++i) {
            const Vector p = meeting.loop.at(2 * M_PI * i / steps);
            const Vector x = p + meeting.scene.evaluate(at(p), dt).force / 1000;
            const auto want = nearest_of(meeting.all, p.cast<Real>(), 0.05L);
            ASSERT_TRUE(want.has_value()) << "seed " << seed << " round " << round << " cycle " << i;
            ASSERT_LE((x.cast<Real>() - want->x).norm(), 1e-9L)
                << "m; seed " << seed << " round " << round << " cycle " << i;
            several += want->active > 1;
            few += meeting.scene.work().curved_rounds <= 3;
            ++cycles;
        }
    }
    EXPECT_GT(several, cycles / 4);
    EXPECT_GE(few, 0.995 * static_cast<double>(cycles)) << "three steps are enough";
}

TEST(CurvedTogether, GiveBackTheWorkOfClosedLoopsAndAreNowhereStifferThanOne) {
    // Of unequal stiffness they do so once a circuit ends as it began: how deep the hand lay behind a harder one
    // when it slid on to it is part of the state.
    const std::uint64_t seed = 2602;
    Rng rng(seed);
    for (int round = 0; round < (long_form() ? 1000 : 40); ++round) {
        const bool mixed = round % 4 == 3;
        Meeting meeting(rng, mixed);
        const double k = mixed ? 2000 : 1000;
        constexpr int steps = 20'000;
        double work = 0, stiffest = 0, steepest = 0;
        Vector p = meeting.loop.at(0), last = Vector::Zero(), before = Vector::Zero();
        for (int i = 0; i < (mixed ? 2 : 1) * steps; ++i) {
            if (i == steps) work = 0;
            const Vector next = meeting.loop.at(2 * M_PI * (i + 1) / steps), middle = (p + next) / 2;
            const Vector force = meeting.scene.evaluate(at(middle), dt).force;
            work += force.dot(next - p);
            if (i > 0) {
                const Vector way = middle - before;
                stiffest = std::max(stiffest, -(force - last).dot(way) / way.squaredNorm());
                steepest = std::max(steepest, (force - last).norm() / way.norm());
            }
            last = force;
            before = middle;
            p = next;
        }
        EXPECT_LE(std::abs(work), 1e-8) << "J; seed " << seed << " round " << round;
        EXPECT_LE(stiffest, k * (1 + 1e-6)) << "N/m; seed " << seed << " round " << round;
        EXPECT_LE(steepest, k * (1 + 1e-6)) << "N/m, as a step; seed " << seed << " round " << round;
    }
}

TEST(CurvedTogether, InAGrooveTheHandIsDrawnToItsBottomByOneStiffness) {
    // Planes at the capsules' feet gave up to 3.6 times that.
    Groove groove(std::numeric_limits<double>::infinity());
    for (int i = 0; i < 400; ++i) {
        const double depth = 5e-5 * (i < 200 ? i : 400 - i) / 2, y = 1e-3 * std::sin(0.05 * i);
        const Vector p(0.1 * depth * std::cos(0.3 * i), y, -depth);
        const Vector force = groove.scene.evaluate(at(p), dt).force;
        EXPECT_LE((force + 1000 * Vector(p.x(), 0, p.z())).norm(), 1e-11) << i;
    }
}

TEST(CurvedTogether, PressedDeepIntoAGrooveTheyHoldWithoutAStep) {
    // Through the narrow place between both axes, and out of one capsule below, where its foot is nearer.
    Groove groove(1000);
    for (int i = 0; i < 3000; ++i) {
        const Vector p(1e-6 * i, 0, -5e-6 * i);
        const Vector force = groove.scene.evaluate(at(p), dt).force;
        ASSERT_LE((force + 1000 * p).norm(), 1e-9) << i;
    }
}

TEST(CurvedTogether, OneThatIsDeepInAnotherTakesHoldWithoutAStep) {
    // A wall beside a sphere: half way to its centre the sphere keeps its normal, which belongs to the common
    // point of both and not to the probe's foot.
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Sphere{.center = {0, 0, -0.01}, .radius = 0.01, .stiffness = 1000}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {-1, 0, 0}, .offset = -0.002, .stiffness = 1000}));
    scene.settle();
    Vector last = Vector::Zero(), before = Vector::Zero();
    for (int i = 0; i < 4000; ++i) {
        const Vector p(0.004, 1e-7 * i, -2e-6 * i);
        const Vector force = scene.evaluate(at(p), dt).force;
        if (i > 100) {
            ASSERT_LE((force - last).norm(), 1000 * (p - before).norm() * 1.5) << i;
        }
        last = force;
        before = p;
    }
    EXPECT_GT(last.z(), 7) << "N";
}

TEST(CurvedTogether, OneThatIsDeepTakesHoldWithoutAStepBesideASofterOneToo) {
    // The harder one acts twice: with the other at their common point, and for the rest by itself at the
    // probe's own foot. It keeps both normals.
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Sphere{.center = {0, 0, -0.01}, .radius = 0.01, .stiffness = 3000}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {-1, 0, 0}, .offset = -0.002, .stiffness = 1000}));
    scene.settle();
    Vector last = Vector::Zero(), before = Vector::Zero();
    for (int i = 0; i < 4000; ++i) {
        const Vector p(0.004, 1e-7 * i, -2e-6 * i);
        const Vector force = scene.evaluate(at(p), dt).force;
        if (i > 100) {
            ASSERT_LE((force - last).norm(), 3000 * (p - before).norm() * 1.5) << i;
        }
        last = force;
        before = p;
    }
    EXPECT_GT(last.z(), 14) << "N";
}

TEST(CurvedTogether, OneThatTakesHoldAndLetsGoBesideOthersGivesNoEnergy) {
    // Random loops about half way to the core of a solid, beside one or two planes that are softer, as hard
    // or harder: from outside and back. Energy is lost while it holds and lets go, never created.
    const std::uint64_t seed = 2606;
    Rng rng(seed);
    double lost = 0;
    for (int round = 0; round < (long_form() ? 10'000 : 400); ++round) {
        Scene scene = make_scene();
        const double radius = uniform(rng, 0.004, 0.008), k = scale(rng, 300, 3000);
        if (between(rng, 0, 1)) {
            ASSERT_TRUE(
                scene.add({0, 1}, Sphere{.center = {0, 0, -radius}, .radius = radius, .stiffness = k}));
        } else {
            const Vector axis(uniform(rng, -1, 1), uniform(rng, -1, 1), 0);
            ASSERT_TRUE(scene.add({0, 1}, Capsule{.center = {0, 0, -radius},
                                                  .axis = to_plain(axis),
                                                  .half_length = 0.02,
                                                  .radius = radius,
                                                  .stiffness = k}));
        }
        const int planes = between(rng, 1, 2);
        const double others = between(rng, 0, 3) == 0 ? k : scale(rng, 300, 3000);
        for (int i = 0; i < planes; ++i) {
            const double turn = uniform(rng, 0, 2 * M_PI), lean = uniform(rng, 0.2, 1.4);
            const Plane plane{
                .normal = {std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn), std::cos(lean)},
                .offset = uniform(rng, -0.002, 0.001),
                .stiffness = others};
            ASSERT_TRUE(scene.add({1u + static_cast<std::uint32_t>(i), 1}, plane));
        }
        scene.settle();
        const SmallLoop loop(rng, Vector(0, 0, -0.55 * radius), uniform(rng, 0.05, 0.3) * radius);
        constexpr int cycles = 400;
        const Vector above = loop.at(0) + Vector(0, 0, 0.03);
        double work = 0;  // J, on the hand
        Vector p = above;
        const auto go = [&](const Vector& next) {
            work += scene.evaluate(at(0.5 * (p + next)), dt).force.dot(next - p);
            p = next;
        };
        for (int i = 1; i <= 3000; ++i) go(above + (i / 3000.0) * (loop.at(0) - above));
        for (int i = 1; i <= 5 * cycles; ++i) go(loop.at(2 * M_PI * i / cycles));
        for (int i = 1; i <= 3000; ++i) go(loop.at(0) + (i / 3000.0) * (above - loop.at(0)));
        lost = std::min(lost, work);
        EXPECT_LE(work, 1e-5) << "J; seed " << seed << " round " << round;
    }
    EXPECT_LT(lost, -1e-4) << "J: none took hold";
}

TEST(CurvedTogether, AHandAtRestFeelsTheSameToTheBitAndTimeThatDoesNotPassChangesNothing) {
    Rng rng(2603);
    for (int round = 0; round < 20; ++round) {
        Meeting meeting(rng, true);
        const Vector p = meeting.loop.at(1);
        Wrench rest;
        for (int i = 0; i < 5; ++i) rest = meeting.scene.evaluate(at(p), dt);
        for (int i = 0; i < 20; ++i)
            ASSERT_TRUE(same_bits(rest, meeting.scene.evaluate(at(p), i % 3 ? dt : 0)));
    }
}

TEST(CurvedTogether, WhatHoldsAloneTakesNoSteps) {
    Rng rng(2604);
    for (int round = 0; round < 50; ++round) {
        Scene scene = make_scene();
        add_near_origin(rng, scene, 0, 0.001, 1000, 0.01, 0.05);
        ASSERT_TRUE(scene.add({1, 1}, Sphere{.center = {0.3, 0, 0}, .radius = 0.02, .stiffness = 1000}));
        ASSERT_TRUE(scene.add({2, 1}, Plane{.offset = -0.2, .stiffness = 1000}));
        scene.settle();
        const SmallLoop loop(rng, Vector(0, 0, -0.001));
        for (int i = 0; i < 50; ++i) {
            scene.evaluate(at(loop.at(0.1 * i)), dt);
            ASSERT_EQ(scene.work().curved_rounds, 0u);
        }
    }
}

TEST(CurvedTogether, EachKindsBendIsTheDerivativeOfItsNormal) {
    const std::uint64_t seed = 2605;
    Rng rng(seed);
    const Vec3 center{0.03, 0.01, -0.02}, axis{0.3, -0.5, 0.8};
    for (const Side side : {Side::outside, Side::inside}) {
        const double grow = side == Side::inside ? 4 : 1;  // else it would hold a probe by a plane
        expect_bend_is_the_normals_derivative(rng,
                                              Sphere{.center = center, .radius = 0.001 * grow, .side = side});
        expect_bend_is_the_normals_derivative(
            rng,
            Capsule{
                .center = center, .axis = axis, .half_length = 0.02, .radius = 0.001 * grow, .side = side});
        expect_bend_is_the_normals_derivative(
            rng, Torus{.center = center, .axis = axis, .radius = 0.02, .tube = 0.0004 * grow, .side = side});
        expect_bend_is_the_normals_derivative(rng, Cylinder{.center = center,
                                                            .axis = axis,
                                                            .radius = 0.001 * grow,
                                                            .half_length = infinity,
                                                            .side = side});
    }
    for (const double curvature : {-30.0, 12.0}) {
        expect_bend_is_the_normals_derivative(
            rng, Cap{.normal = {0.2, 0.1, 1}, .curvature = curvature, .rim = 0.3});
        expect_bend_is_the_normals_derivative(rng, Cap{.normal = {0.2, 0.1, 1},
                                                       .curvature = curvature,
                                                       .curvature2 = 8,
                                                       .axis = {1, 0, 0},
                                                       .rim = 0.3});
    }
}

TEST(CurvedTogether, EachStepSquaresTheError) {
    // Two spheres alone: no scene, no start from an earlier cycle.
    const Vector centers[] = {{-0.02, 0.003, -0.01}, {0.025, 0, -0.012}};
    const double radii[] = {0.024, 0.029};
    const Vector p(0.001, 0.002, -0.004);
    std::vector<Distances> all;
    for (int i = 0; i < 2; ++i)
        all.push_back(distances_of(Sphere{.center = to_plain(centers[i]), .radius = radii[i]}));
    const auto want = nearest_of(all, p.cast<Real>(), 0.05L);
    ASSERT_TRUE(want && want->active == 2);
    Vector dx(0, 0.002, 0.003);  // sideways: curvature has no effect in the plane of p and both centres
    double pushes[] = {0, 0}, error = 1;
    std::vector<double> errors;
    for (int round = 0; round < 6; ++round) {
        std::array<NearSurface, 2> near;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vector q = p + dx - centers[i], n = q.normalized();
            near[i].at = {n, q.norm() - radii[i],
                          (Eigen::Matrix3d::Identity() - n * n.transpose()) / q.norm()};
            near[i].pushes = pushes[i];
        }
        const CurvedStep step = solve_curved_step(near, dx);
        ASSERT_TRUE(step.found);
        dx += step.step;
        pushes[0] = pushes[1] = 0;
        for (std::uint32_t k = 0; k < step.active.count; ++k)
            pushes[step.active.plane[k]] = step.multiplier[k];
        error = static_cast<double>(((p + dx).cast<Real>() - want->x).norm());
        errors.push_back(error);
    }
    EXPECT_LE(error, 1e-16);
    // The first step has no multipliers, so it ignores curvature.
    for (std::size_t i = 2; i < errors.size(); ++i)
        EXPECT_LE(errors[i], 300 * errors[i - 1] * errors[i - 1] + 1e-16) << i << ": " << errors[i - 1];
}

// A hollow and a solid, or two hollows, that leave no point free: no steps lead to their meeting. The
// feedback of each surface must be finite and in proportion to the force; they push against each other by
// much more where they are nearly opposed.
TEST(CurvedTogether, OfSurfacesThatContradictEachOtherEachIsToldItsPartOfTheForce) {
    const std::uint64_t seed = 2613;
    Rng rng(seed);
    int told = 0;
    for (int round = 0; round < 200; ++round) {
        Scene scene = make_scene();
        const auto place = [&] { return to_plain(Vector(scale(rng, 0.01, 1) * direction(rng))); };
        for (std::uint32_t i = 0; i < 3; ++i) {
            const Side side = i == 0 || between(rng, 0, 1) ? Side::inside : Side::outside;
            const double radius = scale(rng, 0.003, 0.3);
            const Sphere sphere{.center = place(), .radius = radius, .side = side, .stiffness = 20};
            const Capsule capsule{.center = place(),
                                  .axis = to_plain(direction(rng)),
                                  .half_length = scale(rng, 0.01, 1),
                                  .radius = radius,
                                  .side = side,
                                  .stiffness = 20};
            ASSERT_TRUE(i % 2 == 0 ? scene.add({i, 1}, sphere) : scene.add({i, 1}, capsule));
        }
        scene.settle();
        Vector p = 0.03 * direction(rng);
        const Vector way = 1e-4 * direction(rng);
        std::array<Feedback, 3> entries;
        for (int cycle = 0; cycle < 2000; ++cycle, p += way) {
            const Vector force = scene.evaluate(at(p), dt).force;
            ASSERT_EQ(scene.feedback(entries), 3u);
            for (const Feedback& entry : entries) {
                told += (entry.flags & Feedback::touching) != 0;
                ASSERT_LE(entry.wrench.force.norm(), 1e6 * force.norm())
                    << "seed " << seed << " round " << round << " cycle " << cycle;
            }
        }
    }
    EXPECT_GT(told, 100000);
}
