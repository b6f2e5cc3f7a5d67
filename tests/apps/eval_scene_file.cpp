// Scene files: what they may say, and what a person reads who says something else.

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include <knurl/reps/presets.hpp>
#include <knurl/scenefile/scene_file.hpp>

namespace knurl::scenefile {
namespace {

SceneFile scene_of(const std::string& text) {
    return parse_scene(text, "S.toml");
}

template <class R>
R params_of(const Change& change) {
    EXPECT_EQ(change.kind, kind_of<R>);
    EXPECT_EQ(change.params.size(), sizeof(R));
    R params;
    std::memcpy(&params, change.params.data(), sizeof params);
    return params;
}

std::string error_of(const std::string& text) {
    try {
        scene_of(text);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no error";
}

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
    EXPECT_EQ(change.use.probe, 3u);
    EXPECT_EQ(change.use.on_silence, OnSilence::move);
    EXPECT_EQ(change.use.silence_time, 0.4);
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
    EXPECT_EQ(scene.changes[0].use.on_silence, OnSilence::fade);
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

TEST(SceneFile, AMaterialMustBeOneOfTheList) {
    EXPECT_EQ(
        error_of("[[plane]]\nmaterial = \"ruber\"\n"),
        "S.toml:2:12: material of the plane of line 1 is 'ruber'; it must be one of: concrete, sand, rubber, "
        "skin, cloth, ice, sandpaper");
    EXPECT_EQ(error_of("[[spring]]\nmaterial = \"ice\"\n").find("S.toml:2:1: unknown key 'material'"), 0u)
        << "an effect has none";
    EXPECT_NE(error_of("[[plane]]\nmateral = \"ice\"\n").find("did you mean 'material'?"), std::string::npos);
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

// Every mistake: where it is (line:column of the word to mend) and what a person reads.
struct Mistake {
    const char* name;
    const char* text;
    const char* where;
    const char* says;
};
void PrintTo(const Mistake& mistake, std::ostream* out) {
    *out << mistake.name;
}
class SceneFileMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(SceneFileMistakes, NamesFileLineAndColumnAndSaysWhatToDo) {
    const std::string error = error_of(GetParam().text);
    EXPECT_EQ(error.find(std::string("S.toml:") + GetParam().where + ": "), 0u) << error;
    EXPECT_NE(error.find(GetParam().says), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

INSTANTIATE_TEST_SUITE_P(
    All, SceneFileMistakes,
    testing::Values(
        Mistake{"NotToml", "[[plane]]\nstiffness = = 3\n", "2:13", ""},
        Mistake{"UnknownTable", "[[plame]]\nstiffness = 3\n", "1:3", "did you mean [[plane]]?"},
        Mistake{"UnknownTableFarFromAll", "[[accordion]]\n", "1:3", "[[constant_force]]"},
        Mistake{"NoList", "[plane]\nstiffness = 3\n", "1:2", "[[plane]]"},
        Mistake{"UnknownKey", "[[plane]]\nid = 'floor'\nstifness = 3\n", "3:1", "did you mean 'stiffness'?"},
        Mistake{"UnknownKeyFarFromAll", "[[spring]]\nqqqqqqqq = 3\n", "2:1", "rest_length"},
        Mistake{"UnknownInnerKey", "[[plane]]\nfriction.statik = 3\n", "2:10", "friction.statik"},
        Mistake{"WrongType", "[[plane]]\n  stiffness = \"800 N/m\"\n", "2:15",
                "must be a number in N/m, not a string"},
        Mistake{"WrongVector", "[[plane]]\nnormal = [0, 1]\n", "2:10", "three numbers"},
        Mistake{"WrongVectorPart", "[[spring]]\nanchor = [0, \"a\", 1]\n", "2:10", "three numbers in m"},
        Mistake{"WrongChoice", "[[plane]]\nupdate = \"jump\"\n", "2:10", "fade, paper, last_depth"},
        Mistake{"WrongSilence", "[[plane]]\non_silence = \"stay\"\n", "2:14", "fade, hold, move"},
        Mistake{"NegativeStiffness", "[[plane]]\nid = 'w'\nstiffness = -1\n", "3:13",
                "plane 'w': plane.stiffness = -1 N/m is out of range"},
        Mistake{"NegativeStiffnessRange", "[[plane]]\nstiffness = -1\n", "2:13", "from 0 to"},
        Mistake{"Nan", "[[plane]]\noffset = nan\n", "2:10", "offset"},
        Mistake{"NanInVector", "[[plane]]\nnormal = [0, nan, 1]\n", "2:10", "normal"},
        Mistake{"InfiniteOffset", "[[plane]]\noffset = inf\n", "2:10", "offset"},
        Mistake{"ZeroNormal", "[[plane]]\nnormal = [0, 0, 0]\n", "2:10", "normal"},
        Mistake{"NegativeRecovery", "[[plane]]\nrecovery = -0.5\n", "2:12", "recovery"},
        Mistake{"AutomaticAsNumber", "[[plane]]\nrecovery = -1\n", "2:12", "or \"automatic\""},
        Mistake{"MatrixWithAShortRow", "[[taylor]]\njacobian = [[1, 0, 0],\n  [0, 1],\n  [0, 0, 1]]\n", "3:3",
                "row 2 of jacobian of the taylor of line 1 must be three numbers in N/m, not an array of 2"},
        Mistake{"MatrixWithTwoRows", "[[taylor]]\njacobian = [[1, 0, 0], [0, 1, 0]]\n", "2:12",
                "has 2 rows; it must have 3"},
        Mistake{"MatrixOfAWord", "[[taylor]]\njacobian = 'stiff'\n", "2:12", "three rows of three numbers"},
        Mistake{"MatrixOutOfRange", "[[taylor]]\njacobian = [[1, 0, 0], [0, 1e10, 0], [0, 0, 1]]\n", "2:12",
                "taylor.jacobian = 10000000000 N/m is out of range"},
        Mistake{"QuaternionOfThree", "[[taylor6]]\norientation = [1, 0, 0]\n", "2:15",
                "four numbers, not an array of 3; write orientation = [1, 0, 0, 0]"},
        Mistake{"QuaternionOfNothing", "[[taylor6]]\norientation = [0, 0, 0, 0]\n", "2:15", "no orientation"},
        Mistake{"MagnetThatEndsTooSoon", "[[magnet]]\nstiffness = 100\nmax_force = 2\nmax_distance = 0.01\n",
                "4:16", "magnet.max_distance = 0.01 m is not beyond max_force / stiffness = 0.02 m"},
        Mistake{"PointsOfANumber", "[[polygon]]\nvertices = 3\n", "2:12", "must be a list of points in m"},
        Mistake{"PointOfTwoNumbers", "[[polygon]]\nvertices = [[0, 0, 0], [1, 0],\n  [1, 1, 0]]\n", "2:24",
                "point 2 of vertices of the polygon of line 1 must be three numbers in m, not an array of 2"},
        Mistake{"TooFewPoints", "[[polygon]]\nvertices = [[0, 0, 0], [1, 0, 0]]\n", "2:12",
                "has 2 points; give from 3 to"},
        Mistake{"DottedKey", "[[plane]]\nfriction = { statics = 1 }\n", "2:14",
                "did you mean 'friction.static'?"},
        Mistake{"DottedKeyAlone", "[[plane]]\nstatic = 1\n", "2:1", "did you mean 'friction.static'?"},
        Mistake{"TableWithAValue", "[[plane]]\nfriction = 0.5\n", "2:1", "friction.static, friction.dynamic"},
        Mistake{"TableInsteadOfAValue", "[[plane]]\nnormal = { x = 1 }\n", "2:12", "did you mean 'normal'?"},
        Mistake{"AutomaticFrictionAsNumber", "[[plane]]\nfriction.static = -1\n", "2:19",
                "must be 0 or more, or \"automatic\""},
        Mistake{"Contradiction", "[[plane]]\nid = 'w'\nfriction.dynamic = 0.5\nfriction.static = 0.25\n",
                "4:19", "plane 'w': plane.friction.static = 0.25 is below friction.dynamic"},
        Mistake{"IntegerIsAReal", "[[plane]]\nsnag.seed = 1.5\n", "2:13", "must be an integer, not a number"},
        Mistake{"IntegerTooLarge", "[[plane]]\nsnag.seed = 4294967296\n", "2:13",
                "it must be 0 to 4294967295"},
        Mistake{"NegativeRestLength", "[[spring]]\nrest_length = -0.1\n", "2:15", "rest_length"},
        Mistake{"NegativeAt", "[[plane]]\nat = -0.1\n", "2:6", "0 s or more"},
        Mistake{"NanAt", "[[plane]]\nat = nan\n", "2:6", "finite"},
        Mistake{"ProbeOutOfRange", "[[plane]]\nprobe = 16\n", "2:9", "0 to 15"},
        Mistake{"ProbeNoInteger", "[[plane]]\nprobe = 1.5\n", "2:9", "integer"},
        Mistake{"NegativeRadius", "[[probe]]\nradius = -1e-3\n", "2:10", "radius of probe 0"},
        Mistake{"NanProbeOffset", "[[probe]]\noffset = [nan, 0, 0]\n", "2:10", "offset of probe 0"},
        Mistake{"UnknownProbeKey", "[[probe]]\nradios = 1\n", "2:1", "did you mean 'radius'?"},
        Mistake{"EmptyId", "[[plane]]\nid = ''\n", "2:6", "string or an integer"},
        Mistake{"RemoveNoBoolean", "[[plane]]\nremove = 1\n", "2:10", "true or false"},
        Mistake{"TwiceAtTheSameTime", "[[plane]]\nid = 1\n[[plane]]\nid = 1\noffset = 1\n", "3:1",
                "two entries at 0 s"},
        Mistake{"RemovedAndAddedAtTheSameTime",
                "[[plane]]\nid = 1\n[[plane]]\nid = 1\nat = 1\nremove = true\n[[plane]]\nid = 1\nat = 1\n",
                "7:1", "two entries at 1 s"},
        Mistake{"RemovalOfNothing", "[[plane]]\nid = 'x'\nremove = true\nat = 1\n", "1:1",
                "nothing of that id"},
        Mistake{"RemovedTwice",
                "[[plane]]\nid = 1\n[[plane]]\nid = 1\nat = 1\nremove = true\n[[plane]]\nid = 1\nat = "
                "2\nremove = true\n",
                "7:1", "nothing of that id"},
        Mistake{"UpdateOfAnotherKind", "[[plane]]\nid = 'a'\n[[spring]]\nid = 'a'\nat = 1\n", "3:1",
                "must be of the same kind"},
        Mistake{"UpdateOfTheProbe", "[[plane]]\nid = 1\n[[plane]]\nid = 1\nat = 1\nprobe = 2\n", "6:9",
                "remove it and add it again"},
        Mistake{"BadUpdate", "[[plane]]\nid = 1\n[[plane]]\nid = 1\nat = 1\nstiffness = -4\n", "6:13", "-4"}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(SceneFile, AFileThatCannotBeReadIsNamed) {
    try {
        read_scene("/no/such/scene.toml");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("/no/such/scene.toml"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace knurl::scenefile
