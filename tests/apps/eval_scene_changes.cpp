// Scene files: changes over time, and what an update keeps.

#include "eval_scene_text.hpp"

namespace knurl::scenefile {
namespace {

TEST(SceneFile, WhatDescribesTheChangeGoesBackToTheDefaultOfItsRepresentation) {
    const auto scene = scene_of("[[gravity]]\nid = 1\nrecovery = 1\n[[gravity]]\nid = 1\nat = 1\nmass = 2\n");
    EXPECT_EQ(params_of<Gravity>(scene.changes.at(1)).recovery, 0.1);
}

TEST(SceneFile, AnUpdateInheritsWhatMayBeAutomaticUnlessItDescribesTheChange) {
    const auto scene = scene_of(
        "[[plane]]\nid = 1\nfriction.static = 0.5\nrecovery = 0.1\n[[plane]]\nid = 1\nat = 1\noffset = 1\n");
    const auto updated = params_of<Plane>(scene.changes.at(1));
    EXPECT_EQ(updated.friction.static_, 0.5);
    EXPECT_EQ(updated.recovery, automatic);
}

TEST(SceneFile, ChangesAreInOrderOfTimeThenOfTheFile) {
    const auto scene = scene_of(R"(
[[spring]]
id = "late"
at = 2
[[plane]]
id = "b"
at = 1
[[spring]]
id = "c"
at = 1
[[plane]]
id = "first"
)");
    ASSERT_EQ(scene.changes.size(), 4u);
    EXPECT_EQ(scene.changes[0].id, "first");
    EXPECT_EQ(scene.changes[1].id, "b");
    EXPECT_EQ(scene.changes[2].id, "c");
    EXPECT_EQ(scene.changes[3].id, "late");
}

TEST(SceneFile, ALaterEntryOfTheSameIdIsAnUpdateThatInheritsWhatItDoesNotState) {
    const auto scene = scene_of(R"(
[[plane]]
id = 7
stiffness = 800
damping = 2
recovery = 0.03
[[plane]]
id = 7
at = 0.5
offset = 0.003
[[plane]]
id = 7
at = 0.7
stiffness = 100
recovery = 0
)");
    ASSERT_EQ(scene.changes.size(), 3u);
    EXPECT_EQ(scene.items, 1u);
    EXPECT_EQ(scene.changes[1].type, Change::Type::update);
    EXPECT_EQ(scene.changes[1].item, 0u);
    EXPECT_EQ(scene.changes[1].at, 0.5);
    const auto second = params_of<Plane>(scene.changes[1]);
    EXPECT_EQ(second.stiffness, 800);
    EXPECT_EQ(second.damping, 2);
    EXPECT_EQ(second.offset, 0.003);
    EXPECT_EQ(second.recovery, automatic) << "recovery belongs to the change: absent, it is automatic";
    const auto third = params_of<Plane>(scene.changes[2]);
    EXPECT_EQ(third.offset, 0.003);
    EXPECT_EQ(third.stiffness, 100);
    EXPECT_EQ(third.recovery, 0);
}

TEST(SceneFile, AnIdMayBeUsedAgainAfterItsRemoval) {
    const auto scene = scene_of(R"(
[[plane]]
id = "a"
[[plane]]
id = "a"
at = 1
remove = true
[[spring]]
id = "a"
at = 2
)");
    ASSERT_EQ(scene.changes.size(), 3u);
    EXPECT_EQ(scene.changes[1].type, Change::Type::remove);
    EXPECT_EQ(scene.changes[1].item, 0u);
    EXPECT_EQ(scene.changes[2].type, Change::Type::add);
    EXPECT_EQ(scene.changes[2].item, 1u);
    EXPECT_EQ(scene.changes[2].kind, kind_of<Spring>);
}

TEST(SceneFile, ARemovalMayStateTheTimeOverWhichItFades) {
    const auto scene = scene_of(
        "[[plane]]\nid = 1\nstiffness = 9\n[[plane]]\nid = 1\nat = 1\nremove = true\nrecovery = 0.2\n");
    ASSERT_EQ(scene.changes.size(), 2u);
    EXPECT_EQ(params_of<Plane>(scene.changes[1]).recovery, 0.2);
    EXPECT_EQ(params_of<Plane>(scene.changes[1]).stiffness, 9);
}

TEST(SceneFile, EntriesWithoutAnIdAreEachTheirOwn) {
    const auto scene = scene_of("[[plane]]\n[[plane]]\n[[plane]]\nat = 1\n");
    ASSERT_EQ(scene.items, 3u);
    for (const auto& change : scene.changes) EXPECT_EQ(change.type, Change::Type::add);
}

}  // namespace
}  // namespace knurl::scenefile
