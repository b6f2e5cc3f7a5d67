// Viscosity, gravity, constraints and vibration. tests/reference/fields.cpp has their formulas for any parameters.

#include <gtest/gtest.h>

#include <knurl/reps/constraint.hpp>
#include <knurl/reps/gravity.hpp>
#include <knurl/reps/vibration.hpp>
#include <knurl/reps/viscosity.hpp>

#include "effect_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {
constexpr RepresentationId id{0, 1};
}

TEST(Viscosity, IsNoThickerThanTheDeviceStands) {
    const Viscosity honey{.damping = 1e6, .angular_damping = 1e6};
    EXPECT_EQ(prepared(honey, {}).damping, 1e6) << "no device, no bound";
    // m / (4 (T + tau + tau_f)), tau_f = 1 / (2 pi 100 Hz)
    const Limits light{.max_stiffness = 2000, .mass = 0.05, .lag = 0.5e-3, .period = 1e-3};
    EXPECT_NEAR(prepared(honey, light).damping, 0.05 / (4 * (1.5e-3 + 1.5915494e-3)), 1e-6);
    EXPECT_EQ(prepared(honey, {.max_stiffness = 2000}).damping, 10) << "its mass is not known";
    EXPECT_EQ(prepared(Viscosity{.damping = 2}, light).damping, 2);
    EXPECT_EQ(prepared(honey, {.max_stiffness = 2000, .max_torsion = 1}).angular_damping, 10 * 1.0 / 2000);
}

TEST(Gravity, IsMassTimesAccelerationAndFadesInOverATenthOfASecond) {
    const Wrench w = felt(Gravity{.mass = 0.2}, at({1, 2, 3}, {4, 5, 6}));
    EXPECT_LE((w.force - Vector(0, 0, -1.962)).norm(), 1e-15);
    EXPECT_EQ(w.torque.norm(), 0.0);
    EXPECT_LE((felt(Gravity{.acceleration = {1, 2, 3}, .mass = 2}, {}).force - Vector(2, 4, 6)).norm(),
              1e-15);
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(id, Gravity{.mass = 1}));
    for (int i = 1; i <= 120; ++i)
        ASSERT_NEAR(scene.evaluate({}, dt).force.z(), -9.81 * std::min(1.0, i / 100.0), 1e-12) << i;
}

TEST(Constraint, HasNeitherADeadZoneNorAnEnd) {
    for (const double x : {1e-12, 1e-6, 0.05, 0.2, 1e3, 1e12}) {
        const Vector force = felt(Constraint{.stiffness = 500}, at({x, 0, 0})).force;
        EXPECT_NEAR(force.x() / (-500 * x), 1, 1e-15) << x;
    }
}

TEST(Constraint, IsAsStiffAsTheDeviceAllowsAndDampedAsMuchAsItStands) {
    const Constraint held =
        prepared(Constraint{.stiffness = infinity, .damping = 1e9}, {.max_stiffness = 1700});
    EXPECT_EQ(held.stiffness, 1700);
    EXPECT_EQ(held.damping, 10);
    EXPECT_EQ(prepared(Constraint{.stiffness = infinity}, {}).stiffness, 1000);
}

TEST(Vibration, IsASineOfTheTimeThatTheServoHasRun) {
    for (const double step : {1e-4, 2.5e-4, 1e-3}) {
        Vibration::State state;
        const Vibration buzz =
            prepared(Vibration{.direction = {0, 3, 4}, .amplitude = 2, .frequency = 83}, {.period = step});
        adopt(buzz, nullptr, state, {});
        for (int i = 1; i <= 100'000; ++i) {
            const Wrench w = evaluate(buzz, state, {}, step);
            const double want =
                static_cast<double>(2 * std::sin(2 * std::numbers::pi_v<Real> * 83 * Real(step) * i));
            ASSERT_LE((w.force - want * Vector(0, 0.6, 0.8)).norm(), 1e-9)
                << "step " << step << " cycle " << i;
        }
    }
}

TEST(Vibration, BendsAndDoesNotBreakWhenItsFrequencyChanges) {
    Scene scene = make_scene();
    Vibration buzz{.amplitude = 1, .frequency = 30, .recovery = 0};
    ASSERT_TRUE(scene.add(id, buzz));
    Rng rng(323);
    double last = 0;
    for (int i = 0; i < 5000; ++i) {
        if (i % 7 == 3) {
            buzz.frequency = uniform(rng, 1, 100);
            ASSERT_TRUE(scene.update(id, buzz));
        }
        const double force = scene.evaluate({}, dt).force.z();
        ASSERT_LE(std::abs(force - last), 2 * M_PI * 100 * dt * (1 + 1e-9)) << i;
        last = force;
    }
}

TEST(Vibration, IsNoFasterThanAQuarterOfTheServosRate) {
    EXPECT_EQ(prepared(Vibration{.frequency = 300}, {.period = 1e-3}).frequency, 250);
    EXPECT_EQ(prepared(Vibration{.frequency = 300}, {.period = 2.5e-4}).frequency, 300);
}

TEST(Vibration, StandsStillWhileNoTimePasses) {
    Vibration::State state;
    const Vibration buzz = prepared(Vibration{.amplitude = 2, .frequency = 83}, {});
    adopt(buzz, nullptr, state, {});
    for (int i = 0; i < 100; ++i) {
        const Wrench w = evaluate(buzz, state, {}, dt);
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(same_bits(w, evaluate(buzz, state, {}, 0)));
    }
}
