// How a plane that changes under the hand reaches its new place: cross-faded by default; the paper's recovery
// and "last depth" by name. Compared with closed forms; and its short ways with the long one.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

constexpr RepresentationId floor_id{0, 1};

Plane floor_at(double z, double recovery = automatic, PlaneUpdate update = PlaneUpdate::fade) {
    return {.normal = {0, 0, 1}, .offset = z, .stiffness = 1000, .recovery = recovery, .update = update};
}

Scene scene_with(const Plane& plane, const Probe& probe,
                 const FadePolicy& policy = {.automatic = 0.01, .rise_speed = infinity}) {
    Scene scene = make_scene({}, policy);
    EXPECT_TRUE(scene.add(floor_id, plane));
    settled(scene, probe);
    return scene;
}

}  // namespace

TEST(CrossFade, GoesLinearlyFromTheOldForceToTheNewStartingInTheFirstCycle) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0), probe);
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.002, 0.01)));
    for (int i = 1; i <= 15; ++i) {
        const double s = std::min(1.0, i / 10.0);
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), (1 - s) * 1 + s * 3, 1e-12) << "cycle " << i;
    }
}

TEST(CrossFade, AddingAndRemovingAreTheSameCase) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(floor_id, floor_at(0, 0.005)));
    for (int i = 1; i <= 8; ++i)
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), std::min(1.0, i / 5.0), 1e-12);
    ASSERT_TRUE(scene.remove(floor_id));
    for (int i = 1; i <= 8; ++i)
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), std::max(0.0, 1 - i / 5.0), 1e-12);
}

TEST(CrossFade, ZeroRecoveryIsAtOnceAlsoInTheMiddleOfAnother) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0), probe, {.automatic = 0.01, .rise_speed = 0.1});
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.002, 0.05)));
    scene.evaluate(probe, dt);
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.005, 0)));
    EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 6, 1e-12);
}

TEST(CrossFade, AutomaticRecoveryIsThePolicys) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0), probe, {.automatic = 0.02, .rise_speed = infinity});
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.001)));
    EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 1 + 1.0 / 20, 1e-12);
}

TEST(CrossFade, ASurfaceThatRisesUnderTheHandDoesItNoFasterThanTheRiseSpeed) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0), probe, {.automatic = 0.01, .rise_speed = 0.1});
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.005)));  // 5 mm up: 50 ms instead of 10
    for (int i = 1; i <= 60; ++i) {
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 1 + 5 * std::min(1.0, i / 50.0), 1e-11)
            << "cycle " << i;
    }
    ASSERT_TRUE(scene.update(floor_id, floor_at(0)));  // down: no such rule
    for (int i = 1; i <= 12; ++i) {
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 6 - 5 * std::min(1.0, i / 10.0), 1e-11)
            << "cycle " << i;
    }
}

TEST(CrossFade, WhereNothingIsFeltBeforeNorAfterNothingIsFeltBetween) {
    const Probe probe = at({0, 0, 0.01});
    Scene scene = scene_with(floor_at(0), probe);
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.002)));
    for (int i = 0; i < 12; ++i) EXPECT_EQ(scene.evaluate(probe, dt).force.norm(), 0.0);
}

TEST(CrossFade, AnOvertakenFadeGoesOnFromThePresentForce) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0), probe);
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.002, 0.01)));
    Vector present;
    for (int i = 0; i < 5; ++i) present = scene.evaluate(probe, dt).force;
    EXPECT_NEAR(present.z(), 2, 1e-12);
    ASSERT_TRUE(scene.update(
        floor_id, Plane{.normal = {1, 0, 0}, .offset = 0.001, .stiffness = 1000, .recovery = 0.01}));
    for (int i = 1; i <= 12; ++i) {
        const double s = std::min(1.0, i / 10.0);
        const Vector want = (1 - s) * Vector(0, 0, 2) + s * Vector(1, 0, 0);
        EXPECT_LE((scene.evaluate(probe, dt).force - want).norm(), 1e-12) << "cycle " << i;
    }
}

TEST(CrossFade, SettledChangesAreThereFromTheStart) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(floor_id, floor_at(0, 0.05)));
    ASSERT_TRUE(scene.add({1, 1}, floor_at(0.001, 0.05, PlaneUpdate::paper)));
    scene.settle();
    EXPECT_NEAR(scene.evaluate(at({0, 0, -0.001}), dt).force.z(), 2, 1e-12);
}

TEST(PaperRecovery, LowersThePlaneToTheProbeAndRaisesItLinearly) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0, 0.01, PlaneUpdate::paper), probe);
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.002, 0.01, PlaneUpdate::paper)));
    // Depth in the new plane 3 mm; it starts at the probe, without force, whatever acted before (figure 7).
    for (int i = 1; i <= 13; ++i) {
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 3 * std::min(1.0, i / 10.0), 1e-12) << "cycle " << i;
    }
}

TEST(PaperRecovery, DropsAtOnceWhenItLeavesTheProbeOutside) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0, 0.01, PlaneUpdate::paper), probe);
    ASSERT_TRUE(scene.update(floor_id, floor_at(-0.002, 0.01, PlaneUpdate::paper)));
    EXPECT_EQ(scene.evaluate(probe, dt).force.norm(), 0.0);
    EXPECT_NEAR(scene.evaluate(at({0, 0, -0.003}), dt).force.z(), 1, 1e-12) << "and stands at its new place";
}

TEST(LastDepth, StartsWithTheDepthThatWasFelt) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = scene_with(floor_at(0, 0.01, PlaneUpdate::last_depth), probe);
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.002, 0.01, PlaneUpdate::last_depth)));
    for (int i = 1; i <= 13; ++i) {
        EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 1 + 2 * std::min(1.0, i / 10.0), 1e-12)
            << "cycle " << i;
    }
    // Again in the middle of a recovery: the present force counts, not the plane's target.
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.004, 0.01, PlaneUpdate::last_depth)));
    for (int i = 1; i <= 5; ++i) scene.evaluate(probe, dt);
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.006, 0.01, PlaneUpdate::last_depth)));
    EXPECT_NEAR(scene.evaluate(probe, dt).force.z(), 4 + 3.0 / 10, 1e-12);
}

TEST(LastDepth, LeavesTheCrossFadeOfOtherPlanesAlone) {
    // A wall fades in x while the floor recovers in z by itself.
    const Probe probe = at({-0.001, 0, -0.001});
    Scene scene = scene_with(floor_at(0, 0.005, PlaneUpdate::last_depth), probe);
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {1, 0, 0}, .stiffness = 1000, .recovery = 0.01}));
    ASSERT_TRUE(scene.update(floor_id, floor_at(0.002, 0.005, PlaneUpdate::last_depth)));
    for (int i = 1; i <= 14; ++i) {
        const Vector want(std::min(1.0, i / 10.0), 0, 1 + 2 * std::min(1.0, i / 5.0));
        EXPECT_LE((scene.evaluate(probe, dt).force - want).norm(), 1e-11) << "cycle " << i;
    }
}

// The second record, into which the plane moves next, may be older. An update that changes no force must not
// mark the two records as equal.
TEST(PlaneUpdates, FrictionThatHasGoneComesBackAfterUpdatesThatChangedNothing) {
    Plane plane{.stiffness = 1000, .recovery = 0.005, .friction = {.dynamic = 0.3}};
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(floor_id, plane));
    double x = 0;
    const auto drag = [&] {
        Vector force = Vector::Zero();
        for (int i = 0; i < 50; ++i)
            force = scene.evaluate(at({x += 5e-5, 0, -0.001}, {0.05, 0, 0}), dt).force;
        return force.x();
    };
    const double rough = drag();
    EXPECT_LT(rough, -0.2);
    plane.friction = {};
    ASSERT_TRUE(scene.update(floor_id, plane));
    EXPECT_EQ(drag(), 0);
    plane.recovery = 0.004;
    ASSERT_TRUE(scene.update(floor_id, plane));
    drag();
    plane.offset = 1e-6;
    ASSERT_TRUE(scene.update(floor_id, plane));
    drag();
    plane.friction = {.dynamic = 0.3};
    ASSERT_TRUE(scene.update(floor_id, plane));
    EXPECT_NEAR(drag(), rough, 1e-3);  // 1 um deeper
}

TEST(PlaneUpdates, WhoComesAfterAnotherInItsSlotIsSilentInItsOwnWay) {
    Plane plane{.stiffness = 1000, .recovery = 0.005};
    Scene scene = make_scene();
    const auto press = [&] {
        Vector force = Vector::Zero();
        for (int i = 0; i < 50; ++i) force = scene.evaluate(at({0, 0, -0.001}), dt).force;
        return force.z();
    };
    ASSERT_TRUE(scene.add({0, 1}, plane, {.on_silence = OnSilence::hold}));
    press();
    ASSERT_TRUE(scene.remove({0, 1}));
    ASSERT_TRUE(scene.add({0, 2}, plane, {.on_silence = OnSilence::fade, .silence_time = 0.01}));
    press();
    for (const double stated : {0.004, 0.003}) {
        plane.recovery = stated;
        ASSERT_TRUE(scene.update({0, 2}, plane));
        press();
        plane.offset += 1e-6;
        ASSERT_TRUE(scene.update({0, 2}, plane));
        press();
    }
    EXPECT_NEAR(press(), 1, 0.01);
    scene.set_silence(1);
    for (int i = 0; i < 3; ++i) press();  // 150 ms; it fades in 100
    EXPECT_EQ(press(), 0);
}

// An update of only a plane's place, stiffness, damping or recovery takes a shorter way than other updates.
// The reference also changes something without effect each time: the seed of snags that it does not have.
TEST(PlaneUpdates, APlaneThatIsPutElsewhereIsFeltAsOneThatIsDescribedAnew) {
    for (std::uint64_t seed = 1; seed <= (long_form() ? 20'000 : 300); ++seed) {
        Rng rng(seed);
        Limits limits;
        if (seed % 3 == 0) limits.max_stiffness = 900;
        Scene put = make_scene(limits), described = make_scene(limits);
        std::array<Plane, 6> planes;
        std::array<std::uint32_t, 6> generation{};
        std::uint32_t seeds = 1;
        const auto each = [&](auto act) {
            act(put, 0u);
            act(described, ++seeds);
        };
        const auto shape = [&](Plane& plane) {
            plane.normal = to_plain(scale(rng, 0.1, 10) * direction(rng));
            plane.offset = uniform(rng, -0.002, 0.001);
            plane.stiffness = between(rng, 0, 5) == 0 ? infinity : 400.0 * between(rng, 0, 3);
            plane.damping = between(rng, 0, 1);
            plane.recovery = between(rng, 0, 2) == 0 ? automatic : 0.002 * between(rng, 0, 3);
        };
        for (int i = 0; i < 120; ++i) {
            for (std::uint32_t k = 0; k < planes.size(); ++k) {
                Plane& plane = planes[k];
                const int what = between(rng, 0, 29);
                if (generation[k] % 2 == 0) {  // not there
                    if (what > 4) continue;
                    plane = {};
                    shape(plane);
                    ++generation[k];
                    const AddOptions options{.probe = between(rng, 0, 1) == 0 ? 0u : 1u};
                    each([&](Scene& scene, std::uint32_t s) {
                        plane.snag.seed = s;
                        ASSERT_TRUE(scene.add({k, generation[k]}, plane, options));
                    });
                    continue;
                }
                if (what == 0) {
                    each([&](Scene& scene, std::uint32_t) { ASSERT_TRUE(scene.remove({k, generation[k]})); });
                    ++generation[k];
                    continue;
                }
                if (what > 12) continue;
                shape(plane);
                if (what == 1) plane.velocity = {0, 0, 0.01 * between(rng, 0, 1)};
                if (what == 2) plane.friction.dynamic = 0.3 * between(rng, 0, 1);
                if (what == 3) plane.update = PlaneUpdate(between(rng, 0, 2));
                if (what == 4) plane.combine = PlaneCombine(between(rng, 0, 1));
                each([&](Scene& scene, std::uint32_t s) {
                    plane.snag.seed = s;
                    ASSERT_TRUE(scene.update({k, generation[k]}, plane));
                });
            }
            if (between(rng, 0, 40) == 0) {
                limits.max_stiffness = 900 - limits.max_stiffness > 0 ? 2000 : 700;
                each([&](Scene& scene, std::uint32_t) { scene.set_limits(limits); });
            }
            const double silent = between(rng, 0, 20) == 0 ? 0.02 : 0;
            each([&](Scene& scene, std::uint32_t) { scene.set_silence(silent); });
            const Probe probe = at(uniform(rng, 0, 0.002) * direction(rng), 0.05 * direction(rng));
            const Wrench want = described.evaluate(probe, dt), got = put.evaluate(probe, dt);
            ASSERT_EQ(got.force, want.force) << "seed " << seed << " cycle " << i;
            std::array<Feedback, 6> one, other;
            const std::size_t count = described.feedback(other);
            ASSERT_EQ(put.feedback(one), count);
            for (std::size_t f = 0; f < count; ++f) {
                ASSERT_EQ(one[f].id, other[f].id);
                ASSERT_EQ(one[f].flags, other[f].flags) << "seed " << seed << " cycle " << i;
                ASSERT_EQ(one[f].stiffness, other[f].stiffness);
                ASSERT_EQ(one[f].wrench.force, other[f].wrench.force);
            }
        }
    }
}
