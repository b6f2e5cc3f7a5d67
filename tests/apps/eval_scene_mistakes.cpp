// Scene files: the message for each mistake.

#include "eval_scene_text.hpp"

namespace knurl::scenefile {
namespace {

// Every mistake: its place (line:column of the word to correct) and its message.
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
        Mistake{"LetterOutsideQuotes", "[[plane]]\nid = f\u00fcr\n", "2:7", "put the word in quotes"},
        Mistake{"TableWithoutName", "[[\x01plane]]\n", "1:3", "control character U+0001"},
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
        Mistake{"NegativeRadius", "[[probe]]\nradius = -1e-3\n", "2:10",
                "probe 0: probe.radius = -0.001 m is out of range"},
        Mistake{"NanProbeOffset", "[[probe]]\noffset = [nan, 0, 0]\n", "2:10",
                "probe 0: probe.offset = nan is not a finite number"},
        Mistake{"ProbeTooFar", "[[probe]]\noffset = [0, 2e9, 0]\n", "2:10",
                "give components from -1000000000"},
        Mistake{"NegativeSilence", "[[plane]]\nid = 'w'\nprobe = 1\nsilence_time = -1\noffset = 1\n", "4:16",
                "plane 'w': plane.silence_time = -1 s is out of range; give a value of 0 s or more"},
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
        Mistake{"AssetOfNothing", "[[asset]]\n", "1:1", "must be one of: a mesh = \"FILE\" with its unit;"},
        Mistake{"AssetOfTwoForms", "[[asset]]\nmesh = 'a.stl'\nheights = [[1, 2], [3, 4]]\n", "1:1",
                "must be one of"},
        Mistake{"AssetWithoutTriangles", "[[asset]]\nvertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n", "1:1",
                "vertices and triangles"},
        Mistake{"AssetWithoutSpacing", "[[asset]]\nheights = [[1, 2], [3, 4]]\n", "1:1",
                "heights and their spacing"},
        Mistake{"ExactHeights", "[[asset]]\nheights = [[1, 2], [3, 4]]\nspacing = [1, 1]\nexact = true\n",
                "4:9", "a mesh has it"},
        Mistake{"UnknownAssetKey", "[[asset]]\nmess = 'a.stl'\n", "2:1", "did you mean 'mesh'?"},
        Mistake{
            "TriangleOfTwo",
            "[[asset]]\nvertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\ntriangles = [[0, 1, 2],\n [0, 1]]\n",
            "4:2", "triangle 2 of triangles of asset 1 must be three numbers of vertices"},
        Mistake{"TriangleBelowNought", "[[asset]]\ntriangles = [[0, 1, -1]]\n", "2:14", "from 0"},
        Mistake{"HeightsOfUnequalRows", "[[asset]]\nheights = [[1, 2],\n [3]]\n", "3:2",
                "has 1 heights, the first has 2"},
        Mistake{"HeightsInOneRow", "[[asset]]\nheights = [1, 2]\n", "2:12",
                "must be an array, not an integer"},
        Mistake{"HeightThatIsNone", "[[asset]]\nheights = [[1, nan]]\n", "2:16",
                "must be finite numbers in m"},
        Mistake{"SpacingOfNothing", "[[asset]]\nspacing = [0.1, 0]\n", "2:11", "must be above 0 m"},
        Mistake{"ShapeOfAnAssetThatIsNotThere", "[[shape]]\nid = 's'\nasset = 1\n", "1:1",
                "shape 's' is made of asset 1, but the scene has 0"},
        Mistake{"BadUpdate", "[[plane]]\nid = 1\n[[plane]]\nid = 1\nat = 1\nstiffness = -4\n", "6:13", "-4"}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(SceneFile, AMaterialMustBeOneOfTheList) {
    EXPECT_EQ(
        error_of("[[plane]]\nmaterial = \"ruber\"\n"),
        "S.toml:2:12: material of the plane of line 1 is 'ruber'; it must be one of: concrete, sand, rubber, "
        "skin, cloth, ice, sandpaper");
    EXPECT_EQ(error_of("[[spring]]\nmaterial = \"ice\"\n").find("S.toml:2:1: unknown key 'material'"), 0u)
        << "an effect has none";
    EXPECT_NE(error_of("[[plane]]\nmateral = \"ice\"\n").find("did you mean 'material'?"), std::string::npos);
}

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
