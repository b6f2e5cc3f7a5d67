// Edges and vertices where a surface is open or not a manifold.

#include <cmath>

#include <gtest/gtest.h>

#include "mesh_data.hpp"
#include "raw_mesh.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

TEST(MeshSeams, OneTriangleIsOpenAllAround) {
    const RawMesh raw{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.notes().edges_open, 3);
    EXPECT_TRUE(mesh.data().open);
    EXPECT_EQ(on_rim(mesh), 1);
}

TEST(MeshSeams, TwoTrianglesBackToBackAreAClosedSheet) {
    const RawMesh raw{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.faces(), 2);
    EXPECT_EQ(mesh.notes().edges_open, 0);
    for (const auto& [a, b] : {std::pair(0U, 1U), {1U, 2U}, {2U, 0U}}) EXPECT_EQ(over(mesh, raw, 0, a, b), 1);
}

TEST(MeshSeams, WhatTouchesARimSaysSo) {
    const RawMesh raw = raw_grid(10, 10);
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.notes().edges_open, 40);
    EXPECT_EQ(on_rim(mesh), 2 * (100 - 64));  // the outer ring of squares
}

TEST(MeshSeams, ATJunctionIsOpenAndSaysSo) {
    RawMesh raw{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0, 0}, {0.5, -1, 0}},
                {{0, 1, 2}, {0, 2, 3}, {0, 5, 4}, {4, 5, 1}}};
    const Mesh mesh(raw.given(), {.unite = false});
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(over(mesh, raw, 0, 0, 1), -1);
    EXPECT_EQ(mesh.notes().parts, 2);
    EXPECT_EQ(on_rim(mesh), 4);
}

/// Sheets that end at the x axis, each a strip of two triangles at an angle (degrees). The front of a
/// forward sheet is on the side of larger angles.
RawMesh sheets(const std::vector<std::pair<double, bool>>& at) {
    RawMesh m{{{0, 0, 0}, {1, 0, 0}}, {}};
    for (const auto& [degrees, forward] : at) {
        const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
        const auto n = static_cast<std::uint32_t>(m.vertices.size());
        m.vertices.push_back({0, c, s});
        m.vertices.push_back({1, c, s});
        m.triangles.push_back(forward ? Triangle{0, 1, n + 1} : Triangle{1, 0, n + 1});
        m.triangles.push_back(forward ? Triangle{0, n + 1, n} : Triangle{0, n, n + 1});
    }
    return m;
}

TEST(MeshSeams, AtAnEdgeOfManyEachSeesTheFirstInFrontOfIt) {
    // A floor and a wall through it, both of bodies: the two sheets around each free wedge are neighbours.
    const RawMesh raw =
        sheets({{10, true}, {80, false}, {100, true}, {170, false}, {190, true}, {350, false}});
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.notes().edges_non_manifold, 1);
    EXPECT_EQ(over(mesh, raw, 0, 0, 1), 2);
    EXPECT_EQ(over(mesh, raw, 2, 0, 1), 0);
    EXPECT_EQ(over(mesh, raw, 4, 0, 1), 6);
    EXPECT_EQ(over(mesh, raw, 8, 0, 1), 10);
    EXPECT_EQ(over(mesh, raw, 10, 0, 1), 8);
}

TEST(MeshSeams, AtAnEdgeOfManyTheOrderOfTheSheetsDoesNotMatter) {
    const std::uint64_t seed = 0x5eed5;
    std::mt19937_64 random(seed);
    for (int round = 0; round < 200; ++round) {
        // Pairs of a forward sheet and the backward one that it sees, at random places around the edge.
        const int pairs = 2 + static_cast<int>(random() % 6);
        std::vector<std::pair<double, bool>> at;
        const double turn = between(random, 0, 360);
        for (int p = 0; p < pairs; ++p) {
            at.push_back({turn + 360.0 * p / pairs, true});
            at.push_back({turn + 360.0 * (p + 0.5) / pairs, false});
        }
        std::vector<std::size_t> order(at.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random() % (i + 1)]);
        std::vector<std::pair<double, bool>> shuffled;
        for (const std::size_t i : order) shuffled.push_back(at[i]);
        const RawMesh raw = sheets(shuffled);
        const Mesh mesh(raw.given());
        ASSERT_EQ(wrong(mesh, raw), "") << "seed " << seed << " round " << round;
        for (std::size_t i = 0; i < order.size(); ++i) {
            // The face at the edge is the first of its sheet.
            const int other = over(mesh, raw, static_cast<std::uint32_t>(2 * i), 0, 1);
            ASSERT_GE(other, 0) << "seed " << seed << " round " << round;
            ASSERT_EQ(order[static_cast<std::size_t>(other) / 2], order[i] ^ 1U)
                << "seed " << seed << " round " << round;
        }
    }
}

TEST(MeshSeams, ASheetWithTwoSidesIsNotACrack) {
    // Both sides of a floor, and of a wall on it, given as triangles of the same vertices.
    const RawMesh raw = sheets({{0, true}, {0, false}, {90, true}, {90, false}, {180, true}, {180, false}});
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(over(mesh, raw, 0, 0, 1), 6);   // the floor's top and the wall's front
    EXPECT_EQ(over(mesh, raw, 4, 0, 1), 10);  // the wall's back and the floor's other top
    EXPECT_EQ(over(mesh, raw, 8, 0, 1), 2);   // both undersides
}

TEST(MeshSeams, NearlyEqualAnglesAreOne) {
    // As above, but the far vertices of the two sides differ by rounding.
    for (const double off : {1e-9, -1e-9, 1e-12, -1e-12, 1e-15}) {
        const RawMesh raw =
            sheets({{0, true}, {off, false}, {90 + off, true}, {90, false}, {180, true}, {180 + off, false}});
        const Mesh mesh(raw.given(), {.exact = true, .weld = 0});
        EXPECT_EQ(over(mesh, raw, 0, 0, 1), 6) << off;
        EXPECT_EQ(over(mesh, raw, 4, 0, 1), 10) << off;
        EXPECT_EQ(over(mesh, raw, 8, 0, 1), 2) << off;
    }
}

TEST(MeshSeams, TwoBodiesAtAnEdgeHangTogetherThroughFreeSpace) {
    RawMesh raw = raw_box(), other = raw_box();
    other.move({0.1, 0.1, 0});
    raw.add(other);
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.notes().edges_non_manifold, 1);
    EXPECT_EQ(mesh.notes().edges_open, 0);
    EXPECT_EQ(mesh.notes().vertices_welded, 2);
    // At that edge the side in front of one box's side is the other box's, a quarter turn on: both form one
    // part.
    EXPECT_EQ(mesh.notes().parts, 1);
}

TEST(MeshSeams, AVertexWithTwoFansIsSplit) {
    RawMesh raw = raw_box(), other = raw_box();
    other.move({0.1, 0.1, 0.1});
    raw.add(other);
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.notes().vertices_split, 1);
    EXPECT_EQ(mesh.notes().parts, 2);
    EXPECT_EQ(mesh.notes().edges_open, 0);
    EXPECT_FALSE(mesh.data().open);
    EXPECT_GE(on_rim(mesh), 6);  // the faces around the vertex are marked, since they do not reach all of it
    EXPECT_LE(on_rim(mesh), 12);
}

TEST(MeshSeams, AFanOfManyFacesIsCutWhereItIsFlat) {
    for (const int sides : {60, 64, 65, 100, 128, 129, 1000, 100000}) {
        RawMesh raw = raw_cone(sides);
        const Mesh mesh(raw.given(), {.find_crossings = false});
        if (sides < 2000) {
            EXPECT_EQ(wrong(mesh, raw), "") << sides;
        }
        // The tip and the base's centre are split, and a vertex in which two cuts end.
        EXPECT_GE(mesh.notes().vertices_split, sides > 64 ? 2 : 0) << sides;
        EXPECT_LE(mesh.notes().vertices_split, sides > 64 ? 2 + sides / 64 : 0) << sides;
        EXPECT_EQ(mesh.notes().edges_open, 0) << sides;  // the mesh itself is closed
        EXPECT_EQ(mesh.data().open, sides > 64) << sides;
        EXPECT_EQ(mesh.notes().parts, 1) << sides;
        EXPECT_EQ(on_rim(mesh), sides > 64 ? 2 * static_cast<std::size_t>(sides) : 0) << sides;
    }
    // A pyramid of four flat sides, each of 30 triangles: no ridge is cut.
    RawMesh raw{{{0, 0, 1}}, {}};
    const Point3 foot[4] = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
    for (std::size_t side = 0; side < 4; ++side) {
        const Point3 &a = foot[side], &b = foot[(side + 1) % 4];
        for (int i = 0; i < 30; ++i)
            raw.vertices.push_back({a[0] + (b[0] - a[0]) * i / 30, a[1] + (b[1] - a[1]) * i / 30, 0});
    }
    for (std::uint32_t i = 0; i < 120; ++i) raw.triangles.push_back({0, 1 + i, 1 + (i + 1) % 120});
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    std::size_t cut = 0;
    for (std::uint32_t i = 0; i < 120; ++i) {
        if (over(mesh, raw, i, 0, 1 + i) >= 0) continue;
        ++cut;
        EXPECT_NE(i % 30, 0) << "a ridge is cut";
    }
    EXPECT_GE(cut, 2);
    EXPECT_LE(cut, 4);
}

}  // namespace
