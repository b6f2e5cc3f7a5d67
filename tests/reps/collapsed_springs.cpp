// Springs collapsed to one: the same wrench as all of them, summed in long double.

#include <gtest/gtest.h>

#include <knurl/reps/collapsed_springs.hpp>

#include "effect_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

struct Sum {
    RealVector force = RealVector::Zero(), torque = RealVector::Zero();
    Real torsion = 0;  // N m/rad, sum of k |b| |a - p|
};

Sum sum_of(const std::vector<Spring>& springs, const Probe& probe) {
    const Eigen::Quaternion<Real> q(Real(probe.orientation.w()), Real(probe.orientation.x()),
                                    Real(probe.orientation.y()), Real(probe.orientation.z()));
    const Eigen::Matrix<Real, 3, 3> turn = q.toRotationMatrix();
    Sum sum;
    for (const Spring& s : springs) {
        const RealVector arm = turn * wide(s.attach), to_anchor = wide(s.anchor) - wide(probe.position);
        const RealVector force = Real(s.stiffness) * (to_anchor - arm);
        sum.force += force;
        sum.torque += arm.cross(force);
        sum.torsion += Real(s.stiffness) * arm.norm() * to_anchor.norm();
    }
    return sum;
}

CollapsedSprings collapsed(const std::vector<Spring>& springs) {
    CollapsedSprings out;
    for (const Spring& s : springs) out.add(prepared(s, {}), s.anchor);
    return out;
}

std::vector<Spring> random_springs(Rng& rng, int count, const Vector& about) {
    std::vector<Spring> springs;
    for (int i = 0; i < count; ++i) {
        springs.push_back({.anchor = to_plain(about + 0.1 * direction(rng)),
                           .attach = between(rng, 0, 3) ? to_plain(0.03 * direction(rng)) : Vec3{},
                           .stiffness = scale(rng, 1, 200)});
    }
    return springs;
}

Probe random_probe(Rng& rng, const Vector& about) {
    Probe probe = at(about + 0.1 * direction(rng));
    probe.orientation = turn(rng);
    return probe;
}

}  // namespace

TEST(CollapsedSprings, AreExactlyTheSumAlsoAThousandOfThemAndAKilometreAway) {
    const std::uint64_t seed = 341;
    Rng rng(seed);
    Real worst_force = 0, worst_torque = 0;
    for (const int count : {1, 2, 6, 100, 1000}) {
        for (int i = 0; i < (long_form() ? 2000 : 50); ++i) {
            const Vector about = (i % 2 ? 1000 : 0.1) * direction(rng);
            const auto springs = random_springs(rng, count, about);
            const Probe probe = random_probe(rng, about);
            const Wrench got = collapsed(springs).evaluate(probe, {});
            const Sum want = sum_of(springs, probe);
            const Real force = (wide(got.force) - want.force).norm(),
                       torque = (wide(got.torque) - want.torque).norm();
            ASSERT_LE(force, 1e-10L) << "seed " << seed << " count " << count << " case " << i;
            ASSERT_LE(torque, 1e-11L) << "seed " << seed << " count " << count << " case " << i;
            worst_force = std::max(worst_force, force), worst_torque = std::max(worst_torque, torque);
        }
    }
    RecordProperty("worst_N", std::to_string(worst_force));
    std::printf("worst of all: %.2Lg N, %.2Lg N m\n", worst_force, worst_torque);
}

TEST(CollapsedSprings, AreWhatTheSpringsThemselvesFeel) {
    Rng rng(342);
    const auto springs = random_springs(rng, 5, {0, 0, 0});
    const Probe probe = random_probe(rng, {0, 0, 0});
    Wrench sum;
    for (const Spring& s : springs) sum += felt(s, probe);
    const Wrench got = collapsed(springs).evaluate(probe, {});
    EXPECT_LE((got.force - sum.force).norm(), 1e-12);
    EXPECT_LE((got.torque - sum.torque).norm(), 1e-13);
}

TEST(CollapsedSprings, OfNoneAreNothing) {
    CollapsedSprings none = collapsed({Spring{.anchor = {1, 2, 3}, .attach = {1, 0, 0}, .stiffness = 5}});
    none.clear();
    EXPECT_EQ(none.count(), 0u);
    EXPECT_EQ(none.evaluate(at({1, 2, 3}), {}).force.norm(), 0.0);
}

TEST(CollapsedSprings, AWeightScalesASpring) {
    Rng rng(343);
    const auto springs = random_springs(rng, 3, {0, 0, 0});
    const Probe probe = random_probe(rng, {0, 0, 0});
    CollapsedSprings half;
    for (const Spring& s : springs) half.add(s, s.anchor, 0.5);
    const Wrench whole = collapsed(springs).evaluate(probe, {}), got = half.evaluate(probe, {});
    EXPECT_LE((2 * got.force - whole.force).norm(), 1e-12);
    EXPECT_LE((2 * got.torque - whole.torque).norm(), 1e-13);
}

TEST(CollapsedSprings, TakeOnlySpringsThatAreLinearAndAtRest) {
    const Spring plain{.stiffness = 100};
    Spring::State still;
    settle(plain, still);
    EXPECT_TRUE(CollapsedSprings::takes(plain, still));
    EXPECT_FALSE(CollapsedSprings::takes({.rest_length = 0.1}, still));
    EXPECT_FALSE(CollapsedSprings::takes({.damping = 1}, still));
    Spring::State moving = still;
    moving.remaining = 0.1;
    EXPECT_FALSE(CollapsedSprings::takes(plain, moving));
    moving = still;
    moving.rest_length = 0.1;
    EXPECT_FALSE(CollapsedSprings::takes(plain, moving));
}

TEST(CollapsedSprings, HoldTheTorquesStiffnessBelowWhatTheDeviceStands) {
    // Two of 200 N/m at 30 mm to either side: no net force, and 12 N m/rad per metre of stretch.
    const auto pair = [](double stretch) {
        return collapsed(
            {Spring{.anchor = {0.03 + stretch, 0, 0}, .attach = {0.03, 0, 0}, .stiffness = 200},
             Spring{.anchor = {-0.03 - stretch, 0, 0}, .attach = {-0.03, 0, 0}, .stiffness = 200}});
    };
    const Limits limits{.max_torsion = 0.5};
    for (const double stretch : {0.0, 0.01, 0.03, 0.1, 1.0}) {
        const CollapsedSprings springs = pair(stretch);
        Probe probe;
        constexpr double angle = 1e-6;
        probe.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector::UnitZ()));
        const double stiffness = -springs.evaluate(probe, limits).torque.z() / angle;
        const double unbounded = 2 * 200 * 0.03 * (0.03 + stretch);
        EXPECT_NEAR(-springs.evaluate(probe, {}).torque.z() / angle, unbounded, 1e-6 * unbounded) << stretch;
        EXPECT_LE(stiffness, 0.5 * (1 + 1e-6)) << stretch;
        if (unbounded < 0.5 / std::sqrt(2)) {
            EXPECT_NEAR(stiffness, unbounded, 1e-6) << stretch;
        }
        EXPECT_LE(springs.evaluate(probe, limits).force.norm(), 1e-9);
    }
}

TEST(CollapsedSprings, NeverBoundMoreThanTheSumOfTheSinglesWould) {
    // |M'| <= sum k |b| |a - p|: where that is within the limit, nothing is scaled.
    Rng rng(344);
    for (int i = 0; i < 2000; ++i) {
        const auto springs = random_springs(rng, between(rng, 1, 8), {0, 0, 0});
        const Probe probe = random_probe(rng, {0, 0, 0});
        const Sum want = sum_of(springs, probe);
        const Limits limits{.max_torsion = static_cast<double>(want.torsion) * (1 + 1e-9)};
        ASSERT_LE((wide(collapsed(springs).evaluate(probe, limits).torque) - want.torque).norm(), 1e-12L);
    }
}
