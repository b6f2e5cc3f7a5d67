// Handles and generations; refusals that change nothing; a batch that takes effect as one.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;
using Code = Verdict::Code;

TEST(SceneSlots, AHandleOfAnOlderGenerationNamesNothing) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({5, 1}, Plane{.stiffness = 100}));
    EXPECT_EQ(scene.add({5, 2}, Plane{.stiffness = 100}).code, Code::slot_in_use);
    EXPECT_EQ(scene.update({5, 2}, Plane{.stiffness = 100}).code, Code::no_such_slot);
    ASSERT_TRUE(scene.remove({5, 1}));
    EXPECT_EQ(scene.remove({5, 1}).code, Code::no_such_slot);
    ASSERT_TRUE(scene.add({5, 2}, Plane{.stiffness = 100}));
    EXPECT_EQ(scene.update({5, 1}, Plane{.stiffness = 300}).code, Code::no_such_slot);
    EXPECT_EQ(scene.remove({5, 1}).code, Code::no_such_slot);
    EXPECT_EQ(scene.size(), 1u);
}

TEST(SceneSlots, EveryRefusalSaysWhatAndChangesNothing) {
    Scene scene({.representations = 8, .probes = 1}, {});
    const Plane plane{.stiffness = 100};
    EXPECT_EQ(scene.add({8, 1}, plane).code, Code::too_many);
    EXPECT_EQ(scene.add({0, 1}, Kind{99}, &plane, sizeof plane, {}).code, Code::unknown_kind);
    EXPECT_EQ(scene.add({0, 1}, kind_of<Plane>, &plane, sizeof plane - 8, {}).code, Code::wrong_size);
    EXPECT_EQ(scene.add({0, 1}, plane, {.on_silence = static_cast<OnSilence>(3)}).code, Code::no_such_choice);
    EXPECT_EQ(scene.add({0, 1}, plane, {.silence_time = -1}).code, Code::out_of_range);
    EXPECT_EQ(scene.add({0, 1}, plane, {.silence_time = std::nan("")}).code, Code::not_finite);
    EXPECT_EQ(scene.size(), 0u);
    ASSERT_TRUE(scene.add({0, 1}, plane));
    EXPECT_EQ(scene.update({0, 1}, Spring{}).code, Code::no_such_slot) << "a plane is no spring";
    EXPECT_EQ(scene.count(kind_of<Plane>), 1u);
    EXPECT_EQ(scene.count(kind_of<Spring>), 0u);
}

TEST(SceneSlots, CheckingSaysWhatDoingWillSay) {
    Scene scene({.representations = 8, .probes = 1}, {});
    Rng rng(81);
    for (int i = 0; i < 5000; ++i) {
        const Handle handle{static_cast<std::uint32_t>(between(rng, 0, 9)),
                            static_cast<std::uint32_t>(between(rng, 1, 3))};
        const Plane plane{.stiffness = uniform(rng, -10, 100)};
        const Use use{.probe = static_cast<std::uint32_t>(between(rng, 0, 1))};
        if (between(rng, 0, 1)) {
            const Verdict before = scene.check_add(handle, kind_of<Plane>, &plane, sizeof plane, use);
            const Verdict done = scene.add(handle, plane, use);
            ASSERT_EQ(before.code, done.code);
            ASSERT_EQ(before.field, done.field);
        } else {
            const Verdict before = scene.check_update(handle, kind_of<Plane>, &plane, sizeof plane);
            ASSERT_EQ(before.code, scene.update(handle, plane).code);
        }
        if (between(rng, 0, 3) == 0) scene.remove(handle);
    }
}

TEST(SceneSlots, ParametersMayLieAnywhereInMemory) {
    Scene scene = make_scene();
    alignas(8) unsigned char bytes[sizeof(Plane) + 8];
    const Plane plane{.normal = {0, 0, 1}, .stiffness = 1000};
    std::memcpy(bytes + 1, &plane, sizeof plane);
    ASSERT_TRUE(scene.add({0, 1}, kind_of<Plane>, bytes + 1, sizeof plane, {}));
    EXPECT_NEAR(settled(scene, at({0, 0, -0.001})).force.z(), 1, 1e-12);
}

TEST(SceneSlots, ChangesBetweenTwoCyclesAreOneChangeAndTheLastOneCounts) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = make_scene(), twin = make_scene();
    for (Scene* s : {&scene, &twin}) {
        ASSERT_TRUE(s->add({0, 1}, Plane{.stiffness = 1000}));
        settled(*s, probe);
    }
    ASSERT_TRUE(scene.update({0, 1}, Plane{.offset = 0.1, .stiffness = 50}));
    ASSERT_TRUE(scene.update({0, 1}, Plane{.stiffness = 2000}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {0, 0, -1}, .stiffness = 50}));
    ASSERT_TRUE(scene.remove({1, 1}));
    ASSERT_TRUE(twin.update({0, 1}, Plane{.stiffness = 2000}));
    for (int i = 0; i < 15; ++i)
        ASSERT_TRUE(same_bits(scene.evaluate(probe, dt), twin.evaluate(probe, dt))) << i;
}

TEST(SceneSlots, AChangeThatIsTakenBackBeforeItIsFeltNeverWas) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = make_scene(), twin = make_scene();
    for (Scene* s : {&scene, &twin}) {
        ASSERT_TRUE(s->add({0, 1}, Plane{.stiffness = 1000}));
        for (int i = 0; i < 5; ++i) s->evaluate(probe, dt);  // its own fade is still under way
    }
    ASSERT_TRUE(scene.update({0, 1}, Plane{.offset = 0.1, .stiffness = 50}));
    ASSERT_TRUE(scene.update({0, 1}, Plane{.stiffness = 1000}));
    for (int i = 0; i < 15; ++i)
        ASSERT_TRUE(same_bits(scene.evaluate(probe, dt), twin.evaluate(probe, dt))) << i;
}

TEST(SceneSlots, ClearRemovesAllAtOnceAndTheSceneIsAsNew) {
    const Probe probe = at({0, 0, -0.001});
    Scene scene = make_scene(), fresh = make_scene();
    Rng rng(82);
    for (std::uint32_t i = 0; i < 20; ++i) {
        ASSERT_TRUE(
            scene.add({i, 1}, Plane{.normal = to_plain(direction(rng)), .offset = 0.001, .stiffness = 800}));
        ASSERT_TRUE(scene.add({i + 20, 1}, ConstantForce{.force = {1, 1, 1}}));
        scene.evaluate(probe, dt);
    }
    scene.clear();
    EXPECT_EQ(scene.size(), 0u);
    EXPECT_EQ(scene.evaluate(probe, dt).force.norm(), 0.0);
    for (Scene* s : {&scene, &fresh}) ASSERT_TRUE(s->add({0, 1}, Plane{.stiffness = 1000}));
    for (int i = 0; i < 15; ++i)
        ASSERT_TRUE(same_bits(scene.evaluate(probe, dt), fresh.evaluate(probe, dt))) << i;
}

TEST(SceneSlots, AThousandRepresentationsFillAClaim) {
    Scene scene({.representations = Scene::max_representations, .probes = Scene::max_probes}, {});
    Rng rng(83);
    for (std::uint32_t i = 0; i < Scene::max_representations; ++i) {
        ASSERT_TRUE(scene.add({i, 1},
                              Plane{.normal = to_plain(direction(rng)), .offset = -0.05, .stiffness = 500},
                              {.probe = i % 16}));
    }
    EXPECT_EQ(scene.size(), Scene::max_representations);
    settled(scene, at({0, 0, 0}));
    for (std::uint32_t i = 0; i < Scene::max_representations;
         ++i) {  // all at once, twice, the second overtaking
        ASSERT_TRUE(scene.update({i, 1}, Plane{.normal = {0, 0, 1}, .offset = 0.001, .stiffness = 500}));
    }
    Wrench w = scene.evaluate(at({0, 0, 0}), dt);
    for (std::uint32_t i = 0; i < Scene::max_representations; ++i) ASSERT_TRUE(scene.remove({i, 1}));
    w = scene.evaluate(at({0, 0, 0}), dt);
    EXPECT_TRUE(finite(w));
    for (int i = 0; i < 30; ++i) w = scene.evaluate(at({0, 0, 0}), dt);
    EXPECT_EQ(w.force.norm(), 0.0);
}

TEST(SceneSlots, FeedbackIsForThoseWhoAskAndStopsAtTheRoomGiven) {
    Scene scene = make_scene();
    for (std::uint32_t i = 0; i < 6; ++i) {
        ASSERT_TRUE(scene.add({i, 7}, Plane{.stiffness = 100}, {.feedback = i % 2}));
    }
    scene.evaluate({}, dt);
    Feedback feedback[8];
    ASSERT_EQ(scene.feedback(feedback), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(feedback[i].handle.slot % 2, 1u);
        EXPECT_EQ(feedback[i].handle.generation, 7u);
        EXPECT_TRUE(feedback[i].flags & Feedback::fading);
    }
    EXPECT_EQ(scene.feedback(std::span(feedback, 2)), 2u);
}

TEST(SceneSlots, StiffnessSumIsTheStiffestSetAndEverySpring) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000}));
    ASSERT_TRUE(scene.add({1, 1}, Plane{.normal = {1, 0, 0}, .stiffness = 400}));
    ASSERT_TRUE(scene.add({2, 1}, Spring{.stiffness = 50}));
    settled(scene, {});
    EXPECT_EQ(scene.stiffness_sum(), 1050);
}
