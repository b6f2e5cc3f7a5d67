// Ids and generations; refusals that change nothing; a batch that takes effect as one.

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

TEST(SceneSlots, AnUpdateOfTheGeometryAloneIsRefusedByFieldAndBySize) {
    Scene scene = make_scene();
    Plane plane{.stiffness = 500};
    ASSERT_TRUE(scene.add({0, 1}, plane));
    plane.offset = std::nan("");
    const Verdict verdict = scene.update({0, 1}, kind_of<Plane>, &plane, geometry_bytes<Plane>());
    EXPECT_EQ(verdict.code, Code::not_finite);
    EXPECT_EQ(Describe<Plane>::fields[verdict.field].name, "offset");
    const Spring spring{.stiffness = 100};
    ASSERT_TRUE(scene.add({1, 1}, spring));
    EXPECT_EQ(scene.update({1, 1}, kind_of<Spring>, &spring, 8).code, Code::wrong_size)
        << "an effect is sent whole";
}

// Moved planes use the newest recovery that was sent, also where only the recovery has changed.
TEST(SceneSlots, ARecoverySentByItselfIsThatOfTheNextMove) {
    Scene scene = make_scene(), fresh = make_scene();
    Plane plane{.offset = -0.001, .stiffness = 500, .recovery = 0};
    for (Scene* each : {&scene, &fresh}) ASSERT_TRUE(each->add({0, 1}, plane));
    const auto feel = [](Scene& each) { return each.evaluate(at({0, 0, 0}), dt).force.z(); };
    for (int i = 0; i < 4; ++i) {  // until both records of the plane are alike
        plane.offset = i % 2 ? -0.001 : -0.002;
        for (Scene* each : {&scene, &fresh}) ASSERT_TRUE(each->update({0, 1}, plane));
        ASSERT_EQ(feel(scene), feel(fresh));
    }
    plane.recovery = 0.1;
    ASSERT_TRUE(scene.update({0, 1}, plane));
    ASSERT_EQ(feel(scene), feel(fresh));
    plane.offset = 0.002;
    for (Scene* each : {&scene, &fresh}) ASSERT_TRUE(each->update({0, 1}, plane));
    for (int i = 0; i < 50; ++i) ASSERT_EQ(feel(scene), feel(fresh)) << "cycle " << i;
    EXPECT_LT(feel(scene), 0.9) << "1 N after 100 ms";
}

// A thousand moved planes keep their place in the sets, beside surfaces that are evaluated in each cycle.
// They move so often, and with so many other changes, that the room for fading sets runs full.
TEST(SceneSlots, PlanesPutElsewhereInBatchesAreFeltAsThoseDescribedAnew) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        Rng rng(seed);
        Scene put({.representations = 64, .probes = 2}, {}),
            described({.representations = 64, .probes = 2}, {});
        std::vector<Plane> planes(40);
        const auto both = [&](auto act) { act(put), act(described); };
        for (std::uint32_t i = 0; i < planes.size(); ++i) {
            planes[i] = {.normal = to_plain(direction(rng)), .offset = -0.001, .stiffness = 500};
            both([&](Scene& scene) { ASSERT_TRUE(scene.add({i, 1}, planes[i], {.probe = i % 2})); });
        }
        both([&](Scene& scene) {
            ASSERT_TRUE(scene.place_probe(1, {.offset = {0.001, 0, 0}, .radius = 0.0005}));
            ASSERT_TRUE(scene.add({50, 1}, Sphere{.radius = 0.003, .side = Side::inside, .stiffness = 500}));
            ASSERT_TRUE(
                scene.add({51, 1}, Plane{.offset = -0.001, .velocity = {0, 0, 0.01}, .stiffness = 500}));
        });
        for (int cycle = 0; cycle < 400; ++cycle) {
            const int share = between(rng, 0, 4);  // of the planes of one probe, or of both
            for (std::uint32_t i = 0; share > 0 && i < planes.size(); ++i) {
                if (between(rng, 0, 3) >= share || (share == 2 && i % 2 == 0)) continue;
                planes[i].normal = to_plain(direction(rng));
                planes[i].offset = uniform(rng, -0.003, 0.0005);
                planes[i].recovery = cycle % 50 == 0 && between(rng, 0, 1) ? 0 : 0.003;
                if (cycle % 40 == 0) planes[i].velocity.x = between(rng, 0, 1) ? 0 : uniform(rng, -0.1, 0.1);
                ASSERT_TRUE(put.update({i, 1}, planes[i]));
                planes[i].snag.seed = 2 + static_cast<std::uint32_t>(cycle);  // without effect on the hand
                ASSERT_TRUE(described.update({i, 1}, planes[i]));
                planes[i].snag.seed = 1;
            }
            const Probe probe = at(uniform(rng, 0, 0.002) * direction(rng), 0.05 * direction(rng));
            const Wrench want = described.evaluate(probe, dt), got = put.evaluate(probe, dt);
            ASSERT_EQ(got.force, want.force) << "seed " << seed << " cycle " << cycle;
            ASSERT_EQ(got.torque, want.torque) << "seed " << seed << " cycle " << cycle;
        }
    }
}

TEST(SceneSlots, CheckingSaysWhatDoingWillSay) {
    Scene scene({.representations = 8, .probes = 1}, {});
    Rng rng(81);
    for (int i = 0; i < 5000; ++i) {
        const RepresentationId id{static_cast<std::uint32_t>(between(rng, 0, 9)),
                                  static_cast<std::uint32_t>(between(rng, 1, 3))};
        const Plane plane{.stiffness = uniform(rng, -10, 100)};
        const AddOptions options{.probe = static_cast<std::uint32_t>(between(rng, 0, 1))};
        if (between(rng, 0, 1)) {
            const Verdict before = scene.check_add(id, kind_of<Plane>, &plane, sizeof plane, options);
            const Verdict done = scene.add(id, plane, options);
            ASSERT_EQ(before.code, done.code);
            ASSERT_EQ(before.field, done.field);
        } else {
            const Verdict before = scene.check_update(id, kind_of<Plane>, &plane, sizeof plane);
            ASSERT_EQ(before.code, scene.update(id, plane).code);
        }
        if (between(rng, 0, 3) == 0) scene.remove(id);
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
         ++i) {  // all at once, twice; the second interrupts the first
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
        EXPECT_EQ(feedback[i].id.slot % 2, 1u);
        EXPECT_EQ(feedback[i].id.generation, 7u);
        EXPECT_TRUE(feedback[i].flags & Feedback::fading);
    }
    EXPECT_EQ(scene.feedback(std::span(feedback, 2)), 2u);
}
