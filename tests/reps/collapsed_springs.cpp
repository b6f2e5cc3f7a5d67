// Springs collapsed into one: the same wrench as the sum of all, computed in long double.

#include <gtest/gtest.h>

#include <knurl/reps/collapsed_springs.hpp>

#include "../reference/parameters.hpp"
#include "effect_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

exact::Twist sum_of(const std::vector<Spring>& springs, const Probe& probe) {
    exact::Twist sum;
    for (const Spring& s : springs) {
        const exact::Twist one = exact::spring(
            {exact::real(s.anchor), exact::real(s.attach), 0, s.stiffness, 0}, exact::tip_of(probe), {});
        sum.force += one.force;
        sum.torque += one.torque;
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
            const Wrench got = collapsed(springs).evaluate(probe);
            const exact::Twist want = sum_of(springs, probe);
            const Real force = exact::length(exact::real(got.force) - want.force),
                       torque = exact::length(exact::real(got.torque) - want.torque);
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
    const Wrench got = collapsed(springs).evaluate(probe);
    EXPECT_LE((got.force - sum.force).norm(), 1e-12);
    EXPECT_LE((got.torque - sum.torque).norm(), 1e-13);
}

TEST(CollapsedSprings, OfNoneAreNothing) {
    CollapsedSprings none = collapsed({Spring{.anchor = {1, 2, 3}, .attach = {1, 0, 0}, .stiffness = 5}});
    none.clear();
    EXPECT_EQ(none.count(), 0u);
    EXPECT_EQ(none.evaluate(at({1, 2, 3})).force.norm(), 0.0);
}

TEST(CollapsedSprings, AWeightScalesASpring) {
    Rng rng(343);
    const auto springs = random_springs(rng, 3, {0, 0, 0});
    const Probe probe = random_probe(rng, {0, 0, 0});
    CollapsedSprings half;
    for (const Spring& s : springs) half.add(s, s.anchor, 0.5);
    const Wrench whole = collapsed(springs).evaluate(probe), got = half.evaluate(probe);
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
