// Scene files and `knurl eval`: surfaces that shapes are made of.

#include <cmath>

#include <gtest/gtest.h>

#include "eval_scene_text.hpp"
#include "eval_table.hpp"

namespace knurl::test {
namespace {

// Two triangles, 10 cm wide, at the height 0.
const std::string square =
    "[[asset]]\nvertices = [[-0.05, -0.05, 0], [0.05, -0.05, 0], [0.05, 0.05, 0], [-0.05, 0.05, 0]]\n"
    "triangles = [[0, 1, 2], [0, 2, 3]]\n";
// A slope of 1 in 10 along x.
const std::string slope =
    "[[asset]]\nheights = [[0, 0.01], [0, 0.01]]\nspacing = [0.1, 0.1]\ncorner = [-0.05, -0.05, -0.005]\n";

TEST(EvalAssets, AShapeOfTwoTrianglesIsThePlaneThatTheyLieIn) {
    const std::string plane = "[[plane]]\noffset = 0.001\nstiffness = 500\n";
    const std::string shape = square + "[[shape]]\nasset = 1\nposition = [0, 0, 0.001]\nstiffness = 500\n";
    const auto flat = eval(plane, press(0.01, -0.002, 0.5)).rows;
    const auto felt = eval(shape, press(0.01, -0.002, 0.5)).rows;
    ASSERT_EQ(felt.size(), flat.size());
    EXPECT_NEAR(flat.back().f[2], 1.5, 1e-12);
    for (std::size_t i = 0; i < felt.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(felt[i].f[k], flat[i].f[k], 1e-9) << felt[i].t;
            EXPECT_NEAR(felt[i].p[k], flat[i].p[k], 1e-12) << felt[i].t;
        }
}

TEST(EvalAssets, HeightsAreFeltAsTheSlopeThatTheyAre) {
    const auto rows = eval(slope + "[[shape]]\nasset = 1\nstiffness = 100\n", press(0.01, -0.002, 0.5)).rows;
    // 2 mm below the slope's middle: the distance is 2 mm cos, the direction its normal.
    const double cosine = 1 / std::sqrt(1.01);
    EXPECT_NEAR(rows.back().f[2], 100 * 0.002 * cosine * cosine, 1e-7);
    EXPECT_NEAR(rows.back().f[0], -0.1 * rows.back().f[2], 1e-7);
}

TEST(EvalAssets, AssetsAreNumberedInOrderAndAnUpdateMayNameAnother) {
    const auto rows = eval(square + slope +
                               "[[shape]]\nid = 1\nasset = 1\nstiffness = 100\n"
                               "[[shape]]\nid = 1\nat = 0.1\nasset = 2\nrecovery = 0\n",
                           rest_at(0.01, 0.05) + "0.06,0,0,-0.001\n0.2,0,0,-0.001\n")
                          .rows;
    EXPECT_EQ(rows[90].f[0], 0);
    EXPECT_NEAR(rows[90].f[2], 0.1, 1e-9);
    EXPECT_LT(rows.back().f[0], -0.005);
}

TEST(EvalAssets, AFileStandsBesideTheSceneAndHasAUnit) {
    const Folder folder;
    folder.file("square.obj", "v -50 -50 0\nv 50 -50 0\nv 50 50 0\nv -50 50 0\nf 1 2 3 4\n");
    const std::string motion = folder.file("M.csv", press(0.01, -0.002, 0.5));
    const auto run = [&](const std::string& asset) {
        return knurl(
            {"eval", "--scene",
             folder.file("S.toml", "[[asset]]\n" + asset + "[[shape]]\nasset = 1\nstiffness = 500\n"),
             "--motion", motion, "--out", "-"});
    };
    const Outcome felt = run("mesh = 'square.obj'\nunit = 'mm'\n");
    EXPECT_EQ(felt.code, 0) << felt.err;
    EXPECT_NE(felt.err.find("S.toml:1: asset 1: 4 edges are open"), std::string::npos) << felt.err;
    const std::string last = felt.out.substr(felt.out.rfind("\n0.5,") + 1);
    EXPECT_EQ(last.substr(0, last.find(",0,0,0,")), "0.5,0,0,-0.002,0,0,1") << felt.out.substr(0, 200);

    const auto refused = [&](const std::string& asset, const std::string& says) {
        const Outcome outcome = run(asset);
        EXPECT_EQ(outcome.code, 1);
        EXPECT_EQ(outcome.out, "");
        EXPECT_NE(outcome.err.find("S.toml:1: asset 1: "), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    };
    refused("mesh = 'square.obj'\n", "write unit = \"mm\"");
    refused("mesh = 'square.obj'\nunit = 'furlong'\n", "give one of mm, cm, m, in, um");
    refused("mesh = 'circle.obj'\nunit = 'mm'\n", "circle.obj: is not there");
    refused("vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\ntriangles = [[0, 1, 3]]\n", "out of range");
}

}  // namespace
}  // namespace knurl::test

namespace knurl::scenefile {
namespace {

TEST(SceneFile, AnAssetIsReadAsItStands) {
    const SceneFile scene = scene_of(
        "[[asset]]\nmesh = \"a.stl\"\nunit = \"mm\"\nexact = true\n"
        "[[asset]]\nheights = [[1, 2, 3], [4, 5, 6]]\nspacing = [0.5, 0.25]\ncorner = [7, 8, 9]\n");
    ASSERT_EQ(scene.assets.size(), 2u);
    EXPECT_EQ(scene.assets[0].mesh, "a.stl");
    EXPECT_EQ(scene.assets[0].unit, "mm");
    EXPECT_TRUE(scene.assets[0].exact);
    EXPECT_EQ(scene.assets[1].line, 5u);
    EXPECT_EQ(scene.assets[1].grid.columns, 3u);
    EXPECT_EQ(scene.assets[1].grid.rows, 2u);
    EXPECT_EQ(scene.assets[1].grid.dx, 0.5);
    EXPECT_EQ(scene.assets[1].grid.dy, 0.25);
    EXPECT_EQ(scene.assets[1].grid.corner, Eigen::Vector3d(7, 8, 9));
    EXPECT_EQ(scene.assets[1].heights, (std::vector<float>{1, 2, 3, 4, 5, 6}));
}

}  // namespace
}  // namespace knurl::scenefile
