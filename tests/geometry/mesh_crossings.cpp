// Faces through which others pass are found, and none in clean meshes. Without the cuts (unite), which would
// leave no such face.

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "mesh_data.hpp"
#include "raw_mesh.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

/// A floor of 4 cm (the first 800 triangles) and a wall across it, from height `low` on; they share no
/// vertex.
RawMesh floor_and_wall(double low, double x = 0.0191) {
    RawMesh m = raw_grid(20, 20);
    RawMesh wall = raw_grid(13, 7, 3.1e-3);
    for (Point3& p : wall.vertices) p = {x, p[0], p[1] + low};
    m.add(wall);
    return m;
}

TEST(MeshCrossings, AFloorAndAWallAreFoundAtEverySizeAndPlace) {
    for (const double scale : {1e-3, 0.1, 1.0, 1e3}) {  // 40 um to 40 m
        for (const double offset : {0.0, 1.0, 1e3, 1e6}) {
            for (const bool exact : {false, true}) {
                RawMesh raw = floor_and_wall(-5e-3);
                raw.scale(scale);
                raw.move({offset, offset, -offset});
                MeshBuild how;
                how.exact = exact;
                how.unite = false;
                const Mesh mesh(raw.given(), how);
                EXPECT_EQ(wrong(mesh, raw, how), "") << scale << " at " << offset;
                // The floor's column under the wall, and the wall's second row of squares.
                for (std::uint32_t j = 0; j < 20; ++j) {
                    const std::uint32_t square = 2 * (20 * j + 9);
                    EXPECT_TRUE(is_crossed(mesh, square) && is_crossed(mesh, square + 1))
                        << scale << " at " << offset << ", square " << j;
                }
                EXPECT_LE(crossed(mesh), 2 * 20 + 2 * 13) << scale << " at " << offset;
            }
        }
    }
}

TEST(MeshCrossings, AWallThatStandsOnTheFloorIsInTheWay) {
    const std::uint64_t seed = 0x5eedb;
    std::mt19937_64 random(seed);
    for (int round = 0; round < 60; ++round) {
        RawMesh raw = floor_and_wall(0);
        const Eigen::Quaterniond turn(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1),
                                      between(random, -1, 1));
        const double scale = std::pow(10, between(random, -3, 3)), offset = between(random, -10, 10);
        for (Point3& p : raw.vertices) {  // after this, rounding decides where the foot is
            const Eigen::Vector3d v = scale * (turn.normalized() * Eigen::Vector3d(p[0], p[1], p[2]));
            p = {v.x() + offset, v.y(), v.z() - offset};
        }
        const Mesh mesh(raw.given(), {.unite = false});
        for (std::uint32_t j = 0; j < 20; ++j)
            EXPECT_TRUE(is_crossed(mesh, 2 * (20 * j + 9)) || is_crossed(mesh, 2 * (20 * j + 9) + 1))
                << "seed " << seed << " round " << round << " square " << j;
    }
}

TEST(MeshCrossings, WhatHangsUnderTheFloorIsNot) {
    for (const double lean : {-2.0, -0.3, 0.0, 0.3, 2.0}) {
        for (const double low :
             {-7 * 3.1e-3, 1e-3}) {  // its upper edge touches the floor; it is above, with a gap
            RawMesh raw = floor_and_wall(low);
            for (std::size_t v = 21 * 21; v < raw.vertices.size(); ++v)
                raw.vertices[v][0] += lean * raw.vertices[v][2];
            EXPECT_EQ(crossed(Mesh(raw.given(), {.unite = false})), 0) << "lean " << lean << " from " << low;
        }
    }
}

TEST(MeshCrossings, SpheresThatCrossDoSoInARing) {
    RawMesh raw = raw_sphere(4), other = raw_sphere(4);
    other.move({0.08, 0.01, 0.02});
    raw.add(other);
    const Mesh mesh(raw.given(), {.unite = false});
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_GT(crossed(mesh), 100);
    EXPECT_LT(crossed(mesh), 600);
    for (const Face& f : mesh.data().faces) {
        // No face is marked that is clear of the plane in which the spheres meet.
        double nearest = 1;
        for (const auto& c : f.corner) {
            const Eigen::Vector3d p = Eigen::Vector3d(c[0], c[1], c[2]) + mesh.data().origin;
            const Eigen::Vector3d d(0.08, 0.01, 0.02);
            nearest = std::min(nearest, std::abs((p - d / 2).dot(d.normalized())));
        }
        EXPECT_TRUE(nearest <= 0.02 || (f.flags & face_crossed) == 0);
    }
}

TEST(MeshCrossings, BodiesWhoseFacesLieInOnePlaneAreFound) {
    // A hand that slides off one box inside the other would pass below the other's top.
    RawMesh raw = raw_box(0.1, 0.1, 0.05), other = raw_box(0.1, 0.07, 0.05);
    other.move({0.05, 0.015, 0});
    raw.add(other);
    const Mesh mesh(raw.given(), {.unite = false});
    const auto both =
        is_crossed(mesh, 2) && is_crossed(mesh, 3) && is_crossed(mesh, 14) && is_crossed(mesh, 15);
    EXPECT_TRUE(both) << "the tops";
}

TEST(MeshCrossings, SeamsThatWereNotWeldedAreNoCrossings) {
    for (const RawMesh& clean : {raw_grid(20, 20), raw_sphere(3), raw_box()}) {
        const RawMesh raw = clean.unwelded();
        const Mesh mesh(raw.given(), {.weld = 0, .unite = false});
        EXPECT_EQ(mesh.notes().faces_crossed, 0);
    }
    // T-junctions: one row of squares beside a finer one, level or over a ridge; and each 1 um out of place.
    const std::uint64_t seed = 0x5eed6;
    std::mt19937_64 random(seed);
    for (const double fall : {0.0, 0.3}) {
        for (const double jitter : {0.0, 1e-6}) {
            RawMesh raw = raw_grid(10, 1, 4e-3), fine = raw_grid(17, 1, 4e-2 / 17);
            for (Point3& p : fine.vertices) p = {p[0], -p[1], -fall * p[1]};
            for (std::size_t t = 0; t < fine.triangles.size(); ++t) fine.turn_over(t);
            raw.add(fine);
            for (Point3& p : raw.vertices)
                for (double& x : p) x += between(random, -jitter, jitter);
            const Mesh mesh(raw.given(), {.unite = false});
            EXPECT_EQ(mesh.notes().faces_crossed, 0)
                << "fall " << fall << " jitter " << jitter << " seed " << seed;
        }
    }
}

TEST(MeshCrossings, AFaceThatGoesThroughItsNeighboursNeighbourIsFound) {
    // The two share a vertex, and the far edge of one passes through the other.
    const RawMesh raw{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 1}, {0.3, 0.3, -1}, {1, 0, -1}, {0.5, -1, 0.2}},
        {{0, 1, 2}, {0, 3, 4}, {0, 6, 5}}};
    const Mesh mesh(raw.given(), {.unite = false});
    EXPECT_TRUE(is_crossed(mesh, 0));
    EXPECT_TRUE(is_crossed(mesh, 1));
    EXPECT_FALSE(is_crossed(mesh, 2));
}

using V = std::array<long double, 3>;
V minus(const Point3& a, const Point3& b) {
    return {static_cast<long double>(a[0]) - b[0], static_cast<long double>(a[1]) - b[1],
            static_cast<long double>(a[2]) - b[2]};
}
long double triple(const V& a, const V& b, const V& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// By how much (of volume) a segment goes through a triangle; < 0: it misses.
long double through(const Point3& p, const Point3& q, const RawMesh& m, const Triangle& t) {
    const V d = minus(q, p);
    const V a = minus(m.vertices[t[0]], p), b = minus(m.vertices[t[1]], p), c = minus(m.vertices[t[2]], p);
    const V u = minus(m.vertices[t[1]], m.vertices[t[0]]), v = minus(m.vertices[t[2]], m.vertices[t[0]]);
    const long double above = triple(u, v, minus(p, m.vertices[t[0]])),
                      below = triple(u, v, minus(q, m.vertices[t[0]]));
    const long double x = triple(d, b, a), y = triple(d, c, b), z = triple(d, a, c);
    const long double sides = above > 0 ? std::min({-x, -y, -z}) : std::min({x, y, z});
    const long double other = above > 0 ? std::min({x, y, z}) : std::min({-x, -y, -z});
    return std::min(std::min(std::abs(above), std::abs(below)) * (above * below < 0 ? 1 : -1),
                    std::max(sides, other));
}

TEST(MeshCrossings, InASoupTheyAreThoseThatEveryPairTellsOf) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        std::mt19937_64 random(seed);
        const RawMesh raw = raw_soup(random, 300, seed % 2 == 0 ? 0.1 : 0.06);
        const Mesh mesh(raw.given(), {.weld = 0, .find_crossings = true, .unite = false});
        const auto margin = 1e-9L;
        std::size_t found = 0;
        for (std::uint32_t i = 0; i < raw.triangles.size(); ++i) {
            long double most = -1;
            for (std::uint32_t j = 0; j < raw.triangles.size(); ++j) {
                if (i == j) continue;
                for (std::size_t e = 0; e < 3; ++e) {
                    const Triangle &s = raw.triangles[i], &t = raw.triangles[j];
                    most = std::max(most, through(raw.vertices[s[e]], raw.vertices[s[(e + 1) % 3]], raw, t));
                    most = std::max(most, through(raw.vertices[t[e]], raw.vertices[t[(e + 1) % 3]], raw, s));
                }
            }
            if (std::abs(most) < margin) continue;
            found += most > 0;
            ASSERT_EQ(is_crossed(mesh, i), most > 0)
                << "seed " << seed << " triangle " << i << " by " << most;
        }
        EXPECT_GT(found, 10) << "seed " << seed;
        EXPECT_LT(found, 290) << "seed " << seed;
    }
}

TEST(MeshCrossings, AskedNotToNoneIsLookedFor) {
    const RawMesh raw = floor_and_wall(-5e-3);
    EXPECT_EQ(crossed(Mesh(raw.given(), {.find_crossings = false})), 0);
}

/// The faces around a vertex form a loop on their way around it, and so pass through each other. The loop's
/// faces that no other crosses lie behind the others, so that the walk reaches them only over the vertex.
RawMesh looped_fan() {
    RawMesh raw;
    raw.vertices = {{0, 0, 0},      {-2, -2, -1}, {2, -2, -1}, {2, 0.5, -1}, {-0.5, 0.5, -1},
                    {-0.5, -1, -1}, {0, -1, -1},  {0, 2, -1},  {-2, 2, -1}};
    for (std::uint32_t i = 1; i < 9; ++i) raw.triangles.push_back({0, i, i == 8 ? 1 : i + 1});
    return raw;
}

TEST(MeshCrossings, FacesOfAFanThatPassesThroughItselfAllSaySo) {
    const Mesh mesh(looped_fan().given(), {.unite = false});
    EXPECT_EQ(mesh.notes().faces_crossed, 2U);
    for (const Face& face : mesh.data().faces) {
        EXPECT_NE(face.flags & face_knot, 0) << face.triangle;
        EXPECT_EQ((face.flags & face_crossed) != 0, face.triangle == 2 || face.triangle == 5)
            << face.triangle;
    }
}

/// More sheets that cross all these faces change nothing, wherever in the tree they are.
TEST(MeshCrossings, AFanThatPassesThroughItselfSaysSoBehindSheetsToo) {
    for (std::uint32_t sheets = 1; sheets < 7; ++sheets) {
        RawMesh raw = looped_fan();
        for (std::uint32_t i = 0; i < sheets; ++i) {
            const double z = -0.3 - 0.1 * i;
            const std::uint32_t first = static_cast<std::uint32_t>(raw.vertices.size());
            raw.vertices.insert(raw.vertices.end(), {{-3, -3, z}, {3, -3, z}, {0, 4, z}});
            raw.triangles.push_back({first, first + 1, first + 2});
        }
        const Mesh mesh(raw.given(), {.unite = false});
        EXPECT_EQ(mesh.notes().faces_crossed, 8 + sheets);
        for (const Face& face : mesh.data().faces)
            EXPECT_EQ((face.flags & face_knot) != 0, face.triangle < 8) << face.triangle << ", " << sheets;
    }
}

}  // namespace
