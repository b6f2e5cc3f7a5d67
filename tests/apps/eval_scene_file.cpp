// Scene files: the valid content for each representation.

#include <limits>

#include <knurl/reps/presets.hpp>

#include "eval_scene_text.hpp"

namespace knurl::scenefile {
namespace {

TEST(SceneFile, ReadsEveryFieldOfAPlane) {
    const auto scene = scene_of(R"(
[[plane]]
id = "floor"
normal = [0, 0.5, 2]
offset = -0.25
stiffness = 800
damping = 1.5
recovery = 0.02
update = "last_depth"
probe = 3
on_silence = "move"
silence_time = 0.4
)");
    ASSERT_EQ(scene.changes.size(), 1u);
    const Change& change = scene.changes[0];
    EXPECT_EQ(change.type, Change::Type::add);
    EXPECT_EQ(change.at, 0);
    EXPECT_EQ(change.id, "floor");
    EXPECT_EQ(change.options.probe, 3u);
    EXPECT_EQ(change.options.on_silence, OnSilence::move);
    EXPECT_EQ(change.options.silence_time, 0.4);
    const auto plane = params_of<Plane>(change);
    EXPECT_EQ(plane.normal, (Vec3{0, 0.5, 2}));
    EXPECT_EQ(plane.offset, -0.25);
    EXPECT_EQ(plane.stiffness, 800);
    EXPECT_EQ(plane.damping, 1.5);
    EXPECT_EQ(plane.recovery, 0.02);
    EXPECT_EQ(plane.update, PlaneUpdate::last_depth);
}

TEST(SceneFile, WhatIsAbsentHasTheDefaultOfTheRepresentation) {
    const auto scene = scene_of("[[plane]]\nstiffness = 5\n[[spring]]\nstiffness = 7\n[[constant_force]]\n");
    ASSERT_EQ(scene.changes.size(), 3u);
    EXPECT_EQ(params_of<Plane>(scene.changes[0]).recovery, automatic);
    EXPECT_EQ(params_of<Plane>(scene.changes[0]).normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(params_of<Plane>(scene.changes[0]).update, PlaneUpdate::fade);
    EXPECT_EQ(params_of<Spring>(scene.changes[1]).duration, 0.2);
    EXPECT_EQ(params_of<Spring>(scene.changes[1]).rest_length, 0);
    EXPECT_EQ(params_of<ConstantForce>(scene.changes[2]).force, Vec3{});
    EXPECT_EQ(scene.changes[0].options.on_silence, OnSilence::fade);
    EXPECT_EQ(scene.items, 3u);
}

TEST(SceneFile, ReadsEveryFieldOfASpringAndAConstantForce) {
    const auto scene = scene_of(R"(
[[spring]]
anchor = [0.01, 0.02, 0.03]
attach = [0, 0.01, 0]
rest_length = 0.05
stiffness = 200.0
damping = 2
duration = 0.3
[[constant_force]]
force = [1, 2, 3]
torque = [0.1, 0.2, 0.3]
recovery = 0
)");
    const auto spring = params_of<Spring>(scene.changes.at(0));
    EXPECT_EQ(spring.anchor, (Vec3{0.01, 0.02, 0.03}));
    EXPECT_EQ(spring.attach, (Vec3{0, 0.01, 0}));
    EXPECT_EQ(spring.rest_length, 0.05);
    EXPECT_EQ(spring.stiffness, 200);
    EXPECT_EQ(spring.damping, 2);
    EXPECT_EQ(spring.duration, 0.3);
    const auto force = params_of<ConstantForce>(scene.changes.at(1));
    EXPECT_EQ(force.force, (Vec3{1, 2, 3}));
    EXPECT_EQ(force.torque, (Vec3{0.1, 0.2, 0.3}));
    EXPECT_EQ(force.recovery, 0);
}

TEST(SceneFile, AMaterialByNameSaysHowASurfaceFeelsAndKeysBesideItWin) {
    const auto scene = scene_of(R"(
[[plane]]
id = "floor"
friction.dynamic = 0.9
material = "rubber"
texture.origin = [1, 2, 3]
offset = 0.5
[[plane]]
id = "floor"
at = 1
material = "ice"
[[plane]]
id = "floor"
at = 2
damping = 7
)");
    ASSERT_EQ(scene.changes.size(), 3u);
    const Material& rubber = *preset("rubber");
    const auto first = params_of<Plane>(scene.changes[0]);
    EXPECT_EQ(first.friction.dynamic, 0.9);
    EXPECT_EQ(first.friction.static_, rubber.friction.static_);
    EXPECT_EQ(first.stiffness, rubber.stiffness);
    EXPECT_EQ(first.damping, rubber.damping);
    const Material& ice = *preset("ice");
    const auto second = params_of<Plane>(scene.changes[1]);
    EXPECT_EQ(second.friction.dynamic, ice.friction.dynamic) << "an update's material replaces what was";
    EXPECT_EQ(second.stiffness, ice.stiffness);
    EXPECT_EQ(second.offset, 0.5) << "but not where the surface lies";
    EXPECT_EQ(second.texture.origin, (Vec3{1, 2, 3}));
    const auto third = params_of<Plane>(scene.changes[2]);
    EXPECT_EQ(third.damping, 7);
    EXPECT_EQ(third.friction.dynamic, ice.friction.dynamic);
}

TEST(SceneFile, AKeyWithADotMayBeATableInside) {
    const auto scene = scene_of(R"(
[[plane]]
friction.static = 0.5
friction.dynamic = 0.25
snag.seed = 4000000000
snag.law = "paper"
[[plane]]
friction = { static = "automatic", dynamic = 0.25 }
texture = { direction = [0, 1, 0], pattern = "rings" }
[[plane]]
[plane.friction]
dynamic = 1
)");
    const auto dotted = params_of<Plane>(scene.changes.at(0));
    EXPECT_EQ(dotted.friction.static_, 0.5);
    EXPECT_EQ(dotted.friction.dynamic, 0.25);
    EXPECT_EQ(dotted.snag.seed, 4000000000u);
    EXPECT_EQ(dotted.snag.law, SnagLaw::paper);
    const auto table = params_of<Plane>(scene.changes.at(1));
    EXPECT_EQ(table.friction.static_, automatic);
    EXPECT_EQ(table.friction.dynamic, 0.25);
    EXPECT_EQ(table.texture.direction, (Vec3{0, 1, 0}));
    EXPECT_EQ(table.texture.pattern, TexturePattern::rings);
    EXPECT_EQ(params_of<Plane>(scene.changes.at(2)).friction.dynamic, 1);
}

TEST(SceneFile, AMatrixIsRowsOrAllItsEntriesRowByRow) {
    const auto scene = scene_of(R"(
[[taylor]]
jacobian = [[1, 2, 3],
            [4, 5, 6],
            [7, 8, 9.5]]
[[taylor]]
jacobian = [1, 2, 3, 4, 5, 6, 7, 8, 9.5]
[[taylor6]]
orientation = [0, 0, 1, 2]
jacobian = [[1, 0, 0, 0, 0, 2], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0],
            [3, 0, 0, 0, 0, 4]]
)");
    const Mat3 want{1, 2, 3, 4, 5, 6, 7, 8, 9.5};
    EXPECT_EQ(params_of<Taylor>(scene.changes.at(0)).jacobian, want);
    EXPECT_EQ(params_of<Taylor>(scene.changes.at(1)).jacobian, want);
    const auto six = params_of<Taylor6>(scene.changes.at(2));
    EXPECT_EQ(six.orientation, (Quat{.w = 0, .x = 0, .y = 1, .z = 2}));
    EXPECT_EQ(six.jacobian.at[5], 2);
    EXPECT_EQ(six.jacobian.at[30], 3);
    EXPECT_EQ(six.jacobian.at[35], 4);
}

TEST(SceneFile, PointsAreAListOfAnyLengthThatTheFieldAllows) {
    const auto scene = scene_of(
        "[[polygon]]\nvertices = [[0, 0, 0], [0.2, 0, 0], [0.2, 0.1, 0], [0, 0.1, 0]]\n"
        "[[polygon]]\nid = 1\nvertices = [[0, 0, 0], [0.2, 0, 0], [0.2, 0.1, 0], [0, 0.1, 0]]\n"
        "[[polygon]]\nid = 1\nat = 1\nvertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n");
    const auto four = params_of<Polygon>(scene.changes.at(0));
    EXPECT_EQ(four.vertices.count, 4u);
    EXPECT_EQ(four.vertices.at[2], (Vec3{0.2, 0.1, 0}));
    const auto three = params_of<Polygon>(scene.changes.at(2));
    EXPECT_EQ(three.vertices.count, 3u);
    EXPECT_EQ(three.vertices.at[2], (Vec3{1, 1, 0}));
    EXPECT_EQ(three.vertices.at[3], Vec3{}) << "nothing of the old ones is left";
}

TEST(SceneFile, InfiniteStiffnessMeansAsStiffAsTheDeviceAllows) {
    const auto scene = scene_of("[[plane]]\nstiffness = inf\n");
    EXPECT_EQ(params_of<Plane>(scene.changes.at(0)).stiffness, std::numeric_limits<double>::infinity());
}

TEST(SceneFile, ProbesAreNumberedInOrder) {
    const auto scene = scene_of("[[probe]]\nradius = 0.005\n[[probe]]\noffset = [0.01, 0, 0]\n");
    ASSERT_EQ(scene.probes.size(), 2u);
    EXPECT_EQ(scene.probes[0].radius, 0.005);
    EXPECT_EQ(scene.probes[0].offset, Vec3{});
    EXPECT_EQ(scene.probes[1].offset, (Vec3{0.01, 0, 0}));
    EXPECT_TRUE(scene.changes.empty());
}

TEST(SceneFile, AnEmptyFileIsAnEmptyScene) {
    EXPECT_TRUE(scene_of("").changes.empty());
}

}  // namespace
}  // namespace knurl::scenefile
