// Scene files and `knurl eval`: assets, and the shapes that use them.

#include <cmath>
#include <sstream>

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
    // 2 mm below the slope's middle: the distance is 2 mm cos, and the force is along the normal.
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

TEST(EvalAssets, NothingIsFeltInTheNotchOfAPolygonThatHasOne) {
    const Folder folder;
    folder.file(
        "u.obj",
        "v -30 -30 -10\nv 30 -30 -10\nv 30 30 -10\nv 10 30 -10\nv 10 -10 -10\nv -10 -10 -10\nv -10 30 -10\n"
        "v -30 30 -10\nv -30 -30 10\nv 30 -30 10\nv 30 30 10\nv 10 30 10\nv 10 -10 10\nv -10 -10 10\n"
        "v -10 30 10\nv -30 30 10\nf 9 10 11 12 13 14 15 16\nf 8 7 6 5 4 3 2 1\nf 1 2 10 9\nf 2 3 11 10\n"
        "f 3 4 12 11\nf 4 5 13 12\nf 5 6 14 13\nf 6 7 15 14\nf 7 8 16 15\nf 8 1 9 16\n");
    const Outcome felt =
        knurl({"eval", "--scene",
               folder.file("S.toml",
                           "[[asset]]\nmesh = 'u.obj'\nunit = 'mm'\n[[shape]]\nasset = 1\n"
                           "stiffness = 800\n"),
               "--motion", folder.file("M.csv", "0,0,0.01,0.03\n1,0,0.01,-0.03\n"), "--out", "-"});
    EXPECT_EQ(felt.code, 0) << felt.err;
    EXPECT_NE(felt.err.find("2 polygons are not convex"), std::string::npos) << felt.err;
    EXPECT_EQ(felt.err.find("open"), std::string::npos) << felt.err;
    std::istringstream lines(felt.out.substr(felt.out.find('\n') + 1));
    for (std::string line; std::getline(lines, line);)
        EXPECT_NE(line.find(",0,0,0,0,0,0,"), std::string::npos) << line;
}

TEST(EvalAssets, WhatIsWoundInsideOutIsTurnedUnlessItIsToStay) {
    const Folder folder;
    folder.file("box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
    for (const bool inside : {false, true}) {
        const Outcome felt =
            knurl({"eval", "--scene",
                   folder.file("S.toml", std::string("[[asset]]\nmesh = 'box.obj'\nunit = 'm'\ninside = ") +
                                             (inside ? "true" : "false") +
                                             "\n[[shape]]\nasset = 1\nstiffness = 100\n"),
                   "--motion", folder.file("M.csv", "0,0.2,0.2,-0.01\n0.01,0.2,0.2,-0.01\n1,0.2,0.2,0.01\n"),
                   "--out", "-"});
        EXPECT_EQ(felt.code, 0) << felt.err;
        EXPECT_EQ(felt.err.find("a closed part was wound inside out and turned; inside = true keeps it so") ==
                      std::string::npos,
                  inside)
            << felt.err;
        const std::string last = felt.out.substr(felt.out.rfind("\n1,") + 1);
        EXPECT_EQ(last.find("0.01,0,0,0,") != std::string::npos, inside) << last;
    }
}

TEST(EvalUnits, AHandDoesNotReachForMetres) {
    const Folder folder;
    const Outcome felt = knurl(
        {"eval", "--scene", folder.file("S.toml", "[[plane]]\nid = 'floor'\noffset = 5\nstiffness = 100\n"),
         "--motion", folder.file("M.csv", "0,0,0,40\n0.1,0,0,-40\n"), "--out", "-"});
    EXPECT_EQ(felt.code, 0);
    EXPECT_NE(
        felt.err.find("S.toml:3:10: offset of plane 'floor' is 5 m, but a hand reaches 2 m: lengths are in "
                      "metres; if it is in mm, write 0.005"),
        std::string::npos)
        << felt.err;
    EXPECT_NE(felt.err.find("M.csv: the motion goes 40 m far"), std::string::npos) << felt.err;
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
