// The stiffness and damping of a scene at the hand. The reference is the scene's own wrench, differentiated
// numerically.

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <knurl/reps/hand_budget.hpp>

#include "scene_tools.hpp"

namespace {

using namespace knurl;
using namespace knurl::test;

const Limits device{
    .max_stiffness = 1000, .max_torsion = 2, .mass = 0.15, .lag = 0.5e-3};  // N/m, N m/rad, kg, s
const double b_max = 0.15 / (4 * (1e-3 + 0.5e-3 + 1 / (2 * M_PI * 100)));   // N s/m

Probe moved(const Probe& from, int axis, double by) {
    Probe probe = from;
    if (axis < 3)
        probe.position[axis] += by;
    else
        probe.orientation =
            Eigen::Quaterniond(Eigen::AngleAxisd(by, Vector::Unit(axis - 3))) * probe.orientation;
    return probe;
}
Probe faster(const Probe& from, int axis, double by) {
    Probe probe = from;
    if (axis < 3) {
        probe.velocity[axis] += by;
        probe.smooth_velocity[axis] += by;
    } else {
        probe.angular_velocity[axis - 3] += by;
    }
    return probe;
}

/// The symmetric part of minus the wrench's derivative, in shares of the device's limits.
template <class Move>
Matrix6 measured(Scene& scene, const Probe& hand, Move move, double step, double translation,
                 double rotation) {
    Matrix6 m;
    for (int axis = 0; axis < 6; ++axis) {
        const Wrench more = scene.evaluate(move(hand, axis, step), 0),
                     less = scene.evaluate(move(hand, axis, -step), 0);
        m.col(axis) << (less.force - more.force) / (2 * step), (less.torque - more.torque) / (2 * step);
    }
    Eigen::Matrix<double, 6, 1> unit;
    unit << Vector::Constant(1 / std::sqrt(translation)), Vector::Constant(1 / std::sqrt(rotation));
    m = unit.asDiagonal() * m * unit.asDiagonal();
    (void)scene.evaluate(hand, 0);  // restores the state
    return 0.5 * (m + m.transpose());
}
Matrix6 stiffness_of(Scene& scene, const Probe& hand) {
    return measured(scene, hand, moved, 1e-7, device.max_stiffness, device.max_torsion);
}
Matrix6 damping_of(Scene& scene, const Probe& hand) {
    return measured(scene, hand, faster, 1e-4, b_max, b_max * device.max_torsion / device.max_stiffness);
}

double largest(const Matrix6& m) {
    return Eigen::SelfAdjointEigenSolver<Matrix6>(m).eigenvalues()(5);
}

Probe some_hand(Rng& rng) {
    Probe hand = at({uniform(rng, -2e-3, 2e-3), uniform(rng, -2e-3, 2e-3), uniform(rng, -3e-3, -1e-3)});
    hand.orientation = turn(rng);
    return hand;
}

std::string text(const Matrix6& m) {
    std::ostringstream out;
    out << m;
    return out.str();
}

}  // namespace

TEST(HandLoad, IsTheDerivativeOfTheWrenchWhereThatIsLinear) {
    const std::uint64_t seed = 811;
    Rng rng(seed);
    for (int i = 0; i < 300; ++i) {
        Scene scene = make_scene(device);
        const auto probes = static_cast<std::uint32_t>(between(rng, 1, 3));
        for (std::uint32_t p = 1; p < probes; ++p)
            ASSERT_TRUE(scene.place_probe(p, {.offset = to_plain(0.02 * direction(rng))}));
        const int parts = between(rng, 1, 6);
        for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(parts); ++s) {
            const AddOptions options{
                .probe = static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(probes) - 1)),
                .feedback = static_cast<std::uint32_t>(between(rng, 0, 1))};
            const double k = scale(rng, 10, 3000), b = between(rng, 0, 1) ? scale(rng, 0.1, 100) : 0;
            switch (between(rng, 0, 3)) {
                case 0:
                    ASSERT_TRUE(scene.add({s, 1},
                                          Spring{.anchor = to_plain(0.01 * direction(rng)),
                                                 .attach = to_plain(uniform(rng, 0, 0.03) * direction(rng)),
                                                 .stiffness = k,
                                                 .damping = b},
                                          options));
                    break;
                case 1: {
                    Constraint c{.origin = to_plain(0.01 * direction(rng)),
                                 .direction = to_plain(direction(rng))};
                    c.shape = static_cast<ConstraintShape>(between(rng, 0, 2));
                    c.stiffness = k;
                    c.damping = b;
                    ASSERT_TRUE(scene.add({s, 1}, c, options));
                    break;
                }
                case 2:
                    ASSERT_TRUE(scene.add(
                        {s, 1}, Viscosity{.damping = b, .angular_damping = scale(rng, 1e-4, 1)}, options));
                    break;
                case 3: {  // a surface that holds: deep enough that its damping does not release it
                    Plane plane{
                        .normal = to_plain(direction(rng)), .offset = 0.05, .stiffness = k, .damping = b};
                    plane.combine = PlaneCombine::sum;
                    ASSERT_TRUE(scene.add({s, 1}, plane, options));
                    break;
                }
            }
        }
        const Probe hand = some_hand(rng);
        (void)settled(scene, hand);
        (void)settled(scene, hand);  // springs are collapsed from the second cycle on
        const SceneLoad load = scene.load();
        const Matrix6 told = load.contacts + load.effects, stiffness = stiffness_of(scene, hand),
                      damping = damping_of(scene, hand);
        ASSERT_LE((told - stiffness).norm(), 1e-5 * (1 + stiffness.norm()))
            << "seed " << seed << " case " << i << "\n"
            << text(told) << "\n\n"
            << text(stiffness);
        ASSERT_LE((load.damping - damping).norm(), 1e-6 * (1 + damping.norm()))
            << "seed " << seed << " case " << i << "\n"
            << text(load.damping) << "\n\n"
            << text(damping);
    }
}

// Radial springs with a rest length are rounded at their middle, magnets weaken beyond their strongest pull,
// Taylor fields end: the stiffness at the hand never exceeds the load.
TEST(HandLoad, IsNowhereLessThanTheDerivativeOfTheWrench) {
    const std::uint64_t seed = 812;
    Rng rng(seed);
    for (int i = 0; i < 2000; ++i) {
        Scene scene = make_scene(device);
        switch (between(rng, 0, 2)) {
            case 0:
                ASSERT_TRUE(scene.add({0, 1}, Spring{.anchor = to_plain(0.02 * direction(rng)),
                                                     .rest_length = uniform(rng, 1e-3, 0.03),
                                                     .stiffness = scale(rng, 10, 3000)}));
                break;
            case 1: {
                Magnet magnet{.position = to_plain(uniform(rng, 0, 0.01) * direction(rng))};
                magnet.stiffness = scale(rng, 50, 3000);
                magnet.max_force = scale(rng, 0.2, 3);
                magnet.max_distance = magnet.max_force / magnet.stiffness * uniform(rng, 1.5, 4);
                if (between(rng, 0, 1)) magnet.radius = uniform(rng, 1e-3, 8e-3);
                ASSERT_TRUE(scene.add({0, 1}, magnet));
                break;
            }
            case 2:
                for (std::uint32_t s = 0; s < 3; ++s)
                    ASSERT_TRUE(scene.add(
                        {s, 1}, Plane{.normal = to_plain((direction(rng) + 2 * Vector::UnitZ()).eval()),
                                      .stiffness = scale(rng, 50, 3000)}));
                break;
        }
        const Probe hand = some_hand(rng);
        (void)settled(scene, hand);
        const double told = largest(scene.load().contacts + scene.load().effects),
                     found = largest(stiffness_of(scene, hand));
        ASSERT_GE(told, found * (1 - 1e-4) - 1e-4) << "seed " << seed << " case " << i;
    }
}

TEST(HandLoad, StaysWithinItsBound) {
    const std::uint64_t seed = 813;
    Rng rng(seed);
    for (int i = 0; i < 2000; ++i) {
        Scene scene = make_scene(device);
        for (std::uint32_t p = 1; p < 3; ++p)
            ASSERT_TRUE(scene.place_probe(p, {.offset = to_plain(0.02 * direction(rng))}));
        for (std::uint32_t s = 0; s < 6; ++s) {
            const AddOptions options{.probe = static_cast<std::uint32_t>(between(rng, 0, 2))};
            const double k = scale(rng, 10, 1e4), b = between(rng, 0, 1) ? scale(rng, 0.1, 100) : 0;
            if (between(rng, 0, 1)) {
                Plane plane{.normal = to_plain((direction(rng) + 2 * Vector::UnitZ()).eval()),
                            .stiffness = k,
                            .damping = b};
                plane.friction.dynamic = between(rng, 0, 1);
                if (between(rng, 0, 3) == 0) plane.combine = PlaneCombine::sum;
                ASSERT_TRUE(scene.add({s, 1}, plane, options));
            } else if (between(rng, 0, 1)) {
                ASSERT_TRUE(scene.add({s, 1},
                                      Spring{.anchor = to_plain(0.01 * direction(rng)),
                                             .rest_length = between(rng, 0, 1) * 0.01,
                                             .stiffness = k,
                                             .damping = b},
                                      options));
            } else {
                ASSERT_TRUE(scene.add({s, 1}, Viscosity{.damping = b, .angular_damping = b / 1000}, options));
            }
        }
        for (int cycle = 0; cycle < 30; ++cycle) {
            const Probe hand = some_hand(rng);
            (void)scene.evaluate(hand, dt);
            if (cycle == 10) {
                ASSERT_TRUE(scene.remove({0, 1}));
            }
            const SceneLoad load = scene.load();
            const LoadBound bound = scene.load_bound();
            ASSERT_LE(largest(load.contacts + load.effects),
                      (bound.contacts + bound.effects) * (1 + 1e-9) + 1e-9)
                << "seed " << seed << " case " << i << " cycle " << cycle;
            ASSERT_LE(largest(load.damping), bound.damping * (1 + 1e-9) + 1e-9)
                << "seed " << seed << " case " << i << " cycle " << cycle;
        }
    }
}

TEST(HandLoad, OfOnePlaneIsWhatTheDeviceStandsAndNeedsNoBudget) {
    Scene scene = make_scene(device);
    ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = infinity, .damping = 1e9}));
    (void)settled(scene, at({0, 0, -1e-3}));
    EXPECT_FALSE(scene.load_bound().exceeds());
    EXPECT_NEAR(largest(scene.load().contacts), 1, 1e-12);
    EXPECT_NEAR(largest(scene.load().damping), 1, 1e-12);
}

TEST(HandLoad, OfWhatIsNotTouchedIsNothing) {
    Scene scene = make_scene(device);
    for (std::uint32_t s = 0; s < 5; ++s)
        ASSERT_TRUE(scene.add({s, 1}, Plane{.stiffness = infinity}, {.probe = s}));
    (void)settled(scene, at({0, 0, 1e-3}));
    EXPECT_EQ(scene.load_bound().contacts, 0);
    EXPECT_EQ((scene.load().contacts + scene.load().effects).norm(), 0);
}

TEST(HandLoad, SaysNothingWhereTheDeviceIsNotKnown) {
    Scene scene = make_scene();
    for (std::uint32_t s = 0; s < 5; ++s)
        ASSERT_TRUE(scene.add({s, 1}, Spring{.stiffness = 1e6, .damping = 1e6}));
    (void)settled(scene, at({0, 0, 1e-3}));
    EXPECT_FALSE(scene.load_bound().exceeds());
    EXPECT_EQ((scene.load().contacts + scene.load().effects).norm(), 0);
}

TEST(HandLoad, TheDampingScaleIsTheVelocitysShareOfEveryForce) {
    const std::uint64_t seed = 814;
    Rng rng(seed);
    for (int i = 0; i < 200; ++i) {
        Scene scene = make_scene(device);
        ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 800, .damping = 3}));
        ASSERT_TRUE(scene.add({1, 1}, Plane{.stiffness = 800, .damping = 3, .combine = PlaneCombine::sum}));
        ASSERT_TRUE(scene.add({2, 1}, Spring{.anchor = {0.01, 0, 0}, .stiffness = 100, .damping = 2}));
        ASSERT_TRUE(scene.add({3, 1}, Viscosity{.damping = 1, .angular_damping = 0.01}));
        ASSERT_TRUE(scene.add({4, 1},
                              Plane{.normal = {1, 0, 0},
                                    .offset = -0.01,
                                    .stiffness = 500,
                                    .friction = {.dynamic = 0, .viscous = 1}},
                              {.probe = 1}));
        const double share = uniform(rng, 0, 3);
        Probe hand = at({0, 0, -5e-3});
        (void)settled(scene, hand);
        const Wrench still = scene.evaluate(hand, 0);
        hand.velocity = hand.smooth_velocity = 0.05 * direction(rng);
        hand.angular_velocity = direction(rng);
        const Wrench whole = scene.evaluate(hand, 0);
        scene.set_scales({.damping = share});
        const Wrench part = scene.evaluate(hand, 0);
        ASSERT_LE((part.force - (still.force + share * (whole.force - still.force))).norm(), 1e-12)
            << "seed " << seed;
        ASSERT_LE((part.torque - (still.torque + share * (whole.torque - still.torque))).norm(), 1e-12)
            << "seed " << seed;
    }
}

TEST(HandLoad, TheScalesAreOfSurfacesAndOfEffects) {
    Scene scene = make_scene(device);
    ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 800}));
    ASSERT_TRUE(scene.add({1, 1}, Spring{.anchor = {0.01, 0, 0}, .stiffness = 100, .damping = 2}));
    Probe hand = at({0, 0, -5e-3}, {0.1, 0, 0});
    (void)settled(scene, hand);
    scene.set_scales({.contacts = 0.5, .effects = 0.25, .damping = 0.75});
    const Wrench got = scene.evaluate(hand, 0);
    // The spring's own axis is (2, 0, 1): it feels 2 N s/m of 0.1 m/s along that.
    const double square = 0.01 * 0.01 + 5e-3 * 5e-3, braking = 0.75 * 2 * 0.1 * 0.01 / square;
    EXPECT_NEAR(got.force.z(), 0.5 * 4 + 0.25 * 0.5 - braking * 5e-3, 1e-12);
    EXPECT_NEAR(got.force.x(), 0.25 * 1 - braking * 0.01, 1e-12);
}

// The work of the scene on a hand that is led between two places, by the trapezoidal rule.
namespace {

double work_along(Scene& scene, Probe hand, const Vector& to) {
    constexpr int steps = 4000;
    const Vector step = (to - hand.position) / steps;
    double work = 0;
    Vector before = scene.evaluate(hand, 0).force;
    for (int i = 0; i < steps; ++i) {
        hand.position += step;
        const Vector after = scene.evaluate(hand, 0).force;
        work += 0.5 * (before + after).dot(step);
        before = after;
    }
    return work;
}
double held(const Scene& scene) {
    const SceneLoad load = scene.load();
    return load.in_contacts.held + load.in_effects.held;
}
Vector near_middle(Rng& rng) {
    return uniform(rng, 0, 3e-3) * direction(rng) - Vector(0, 0, 4e-3);
}

/// A representation that holds energy near the middle. True: only a bound of its energy is known.
bool add_something(Scene& scene, Rng& rng, std::uint32_t slot) {
    const double k = scale(rng, 10, 900);
    switch (between(rng, 0, 5)) {
        case 0: {
            Plane plane{.normal = to_plain((direction(rng) + 2 * Vector::UnitZ()).eval()), .stiffness = k};
            if (between(rng, 0, 2) == 0) plane.combine = PlaneCombine::sum;
            EXPECT_TRUE(scene.add({slot, 1}, plane));
            break;
        }
        case 1:
            EXPECT_TRUE(scene.add({slot, 1}, Spring{.anchor = to_plain(0.02 * direction(rng)),
                                                    .rest_length = between(rng, 0, 1) * 5e-3,
                                                    .stiffness = k,
                                                    .duration = 0}));
            break;
        case 2: {
            Constraint c{.origin = to_plain(0.01 * direction(rng)), .direction = to_plain(direction(rng))};
            c.shape = static_cast<ConstraintShape>(between(rng, 0, 2));
            c.stiffness = k;
            EXPECT_TRUE(scene.add({slot, 1}, c));
            break;
        }
        case 3: {
            Magnet magnet{.position = to_plain(near_middle(rng))};
            magnet.stiffness = k;
            magnet.max_force = k * uniform(rng, 1e-3, 4e-3);
            magnet.max_distance = 0.02;
            if (between(rng, 0, 2) == 0) magnet.radius = 6e-3;
            EXPECT_TRUE(scene.add({slot, 1}, magnet));
            return magnet.radius > 0;
        }
        default: {
            Taylor taylor{.origin = to_plain(near_middle(rng)),
                          .force = to_plain(uniform(rng, 0, 1) * direction(rng))};
            Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
            for (int i = 0; i < 3; ++i) {
                const Vector u = direction(rng);
                j -= scale(rng, 10, 300) * u * u.transpose();
            }
            taylor.jacobian = to_mat3(j);
            taylor.radius = 0.02;
            taylor.edge = static_cast<TaylorEdge>(between(rng, 0, 1));
            EXPECT_TRUE(scene.add({slot, 1}, taylor));
            break;
        }
    }
    return false;
}

}  // namespace

TEST(HandLoad, EnergyIsTheWorkThatIsStillInIt) {
    const std::uint64_t seed = 817;
    Rng rng(seed);
    for (int i = 0; i < 300; ++i) {
        Scene scene = make_scene(device);
        const int parts = between(rng, 1, 5);
        bool bounded = false;
        for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(parts); ++s)
            bounded = add_something(scene, rng, s) || bounded;
        const Probe from = at(near_middle(rng)), to = at(near_middle(rng));
        (void)settled(scene, from);
        const double before = held(scene), work = work_along(scene, from, to.position);
        (void)scene.evaluate(to, 0);
        // For a magnet that pulls to a sphere it is a bound, since the pull is rounded off at its middle.
        if (bounded) {
            ASSERT_LE(work, before + 1e-8) << "seed " << seed << " case " << i;
        } else {
            ASSERT_NEAR(work, before - held(scene), 1e-8 + 1e-5 * before) << "seed " << seed << " case " << i;
        }
        ASSERT_GE(held(scene), 0) << "seed " << seed << " case " << i;
    }
}

TEST(HandLoad, EnergyIsTheDevicesInWorldsOfAnyScale) {
    const auto held_in = [](double metre, double newton) {
        Limits limits = device;
        limits.metre = metre, limits.newton = newton;
        limits.max_stiffness *= newton / metre;
        Scene scene = make_scene(limits);
        EXPECT_TRUE(scene.add({0, 1}, Plane{.stiffness = 500 * newton / metre}));
        EXPECT_TRUE(scene.add({1, 1}, Spring{.stiffness = 100 * newton / metre}));
        (void)settled(scene, at({0, 0, -2e-3 * metre}));
        return held(scene);
    };
    EXPECT_NEAR(held_in(1, 1), 0.5 * 600 * 4e-6, 1e-12);
    EXPECT_NEAR(held_in(1000, 1), 0.5 * 600 * 4e-6, 1e-12);
    EXPECT_NEAR(held_in(0.01, 50), 0.5 * 600 * 4e-6, 1e-12);
}

// All that a fade removes at the hand's place, and nothing that it adds.
TEST(HandLoad, FadesFreeWhatTheyTakeAway) {
    for (const bool surface : {true, false}) {
        Scene scene = make_scene(device);
        const Probe hand = at({0, 0, -2e-3});
        if (surface) {
            ASSERT_TRUE(scene.add({0, 1}, Plane{.stiffness = 500}));
        } else {
            ASSERT_TRUE(scene.add({0, 1}, Spring{.stiffness = 500, .duration = 0.02}));
        }
        double freed = 0;
        const auto pass = [&] {
            for (int cycle = 0; cycle < 30; ++cycle) {
                (void)scene.evaluate(hand, dt);
                const SceneLoad load = scene.load();
                freed += load.in_contacts.freed + load.in_effects.freed;
            }
        };
        pass();
        EXPECT_EQ(freed, 0) << "what comes takes nothing away";
        ASSERT_TRUE(scene.remove({0, 1}));
        pass();
        EXPECT_NEAR(freed, 0.5 * 500 * 4e-6, 1e-12) << (surface ? "plane" : "spring");
    }
}
