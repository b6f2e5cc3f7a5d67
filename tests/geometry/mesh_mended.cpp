// The builder's results for clean meshes, and the faults that it repairs.

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "mesh_data.hpp"
#include "raw_mesh.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

MeshBuild exact() {
    MeshBuild how;
    how.exact = true;
    return how;
}

TEST(MeshBuild, ACleanMeshIsBuiltAsItWasGiven) {
    for (const RawMesh& raw : {raw_sphere(0), raw_sphere(4, 0.1, 0.05), raw_box(), raw_cone(20)}) {
        for (const MeshBuild& how : {MeshBuild{}, exact()}) {
            const Mesh mesh(raw.given(), how);
            EXPECT_EQ(wrong(mesh, raw, how), "");
            EXPECT_EQ(mesh.faces(), raw.triangles.size());
            EXPECT_FALSE(mesh.data().open);
            EXPECT_EQ(on_rim(mesh), 0);
            const MeshNotes& n = mesh.notes();
            EXPECT_EQ(n.vertices_not_finite + n.vertices_far + n.vertices_welded + n.vertices_split, 0);
            EXPECT_EQ(
                n.faces_dropped + n.faces_degenerate + n.faces_duplicate + n.faces_turned + n.faces_crossed,
                0);
            EXPECT_EQ(n.edges_open + n.edges_non_manifold, 0);
            EXPECT_EQ(n.parts, 1);
        }
    }
}

TEST(MeshBuild, AnyOrderOfTheTrianglesGivesACleanMesh) {
    const std::uint64_t seed = 0x5eed1;
    std::mt19937_64 random(seed);
    RawMesh raw = raw_sphere(4, 0.1, 0.05);
    raw.materials.resize(raw.triangles.size());
    for (int round = 0; round < 5; ++round) {
        for (std::size_t i = raw.triangles.size(); i-- > 1;)
            std::swap(raw.triangles[i], raw.triangles[random() % (i + 1)]);
        for (auto& m : raw.materials) m = static_cast<std::uint8_t>(random());
        const Mesh mesh(raw.given());
        EXPECT_EQ(wrong(mesh, raw), "") << "seed " << seed << " round " << round;
        EXPECT_EQ(mesh.notes().edges_open, 0);
    }
}

TEST(MeshBuild, SizeAndPlaceChangeNothing) {
    for (const double size : {40e-6, 1e-3, 0.2, 40.0}) {
        for (const double offset : {0.0, 1.0, 1e3, 1e6}) {
            RawMesh raw = raw_sphere(3, size / 2, 0.05);
            raw.move({offset, -offset, offset / 3});
            const Mesh mesh(raw.given(), exact());
            EXPECT_EQ(wrong(mesh, raw, exact()), "") << size << " at " << offset;
            EXPECT_EQ(mesh.faces(), raw.triangles.size()) << size << " at " << offset;
            EXPECT_EQ(mesh.notes().edges_open + mesh.notes().faces_crossed, 0) << size << " at " << offset;
            const Mesh coarse(raw.given());
            EXPECT_EQ(wrong(coarse, raw), "") << size << " at " << offset;
            EXPECT_EQ(coarse.faces(), raw.triangles.size()) << size << " at " << offset;
        }
    }
}

TEST(MeshBuild, NeedlesAndSmallPatchesAreLegal) {
    RawMesh needles = raw_grid(4, 400, 1e-5);
    for (Point3& p : needles.vertices) p[0] *= 1000;  // 10 mm by 10 um
    for (const RawMesh& raw : {needles, raw_grid(20, 20, 2e-6)}) {
        const Mesh mesh(raw.given());
        EXPECT_EQ(wrong(mesh, raw), "");
        EXPECT_EQ(mesh.faces(), raw.triangles.size());
        EXPECT_EQ(mesh.notes().parts, 1);
        EXPECT_EQ(mesh.notes().faces_crossed, 0);
    }
}

TEST(MeshBuild, VerticesThatAreOneAreWelded) {
    RawMesh sphere = raw_sphere(4, 0.1, 0.05), raw = sphere.unwelded();
    const Mesh equal(raw.given(), {.weld = 0});
    EXPECT_EQ(wrong(equal, raw, {.weld = 0}), "");
    EXPECT_EQ(equal.notes().vertices_welded, raw.vertices.size() - sphere.vertices.size());
    EXPECT_EQ(equal.notes().edges_open, 0);

    const std::uint64_t seed = 0x5eed2;
    std::mt19937_64 random(seed);
    for (Point3& p : raw.vertices)
        for (double& x : p)
            x += between(random, -3e-8, 3e-8);  // a fifth of the tolerance between two of them
    const Mesh near(raw.given());
    EXPECT_EQ(wrong(near, raw), "") << "seed " << seed;
    EXPECT_EQ(near.notes().vertices_welded, raw.vertices.size() - sphere.vertices.size());
    EXPECT_EQ(near.notes().edges_open, 0);
    const Mesh apart(raw.given(), {.weld = 0});
    EXPECT_EQ(apart.notes().vertices_welded, 0);
    EXPECT_GT(apart.notes().edges_open, 0);
}

TEST(MeshBuild, WeldingDoesNotCollapseAMeshFinerThanItsTolerance) {
    // The first vertex is within the tolerance of both ends of an edge that is longer than the tolerance.
    const RawMesh edge{
        {{0, 0, 0}, {-0.9e-3, 0, 0}, {0.9e-3, 0, 0}, {0, 0.7, 0}, {0.7, -0.7, 0}, {-0.7, -0.7, 0}},
        {{1, 2, 3}, {0, 5, 4}}};
    MeshBuild how;
    how.weld = 0.5e-3;  // 1 mm, of 2 m
    const Mesh both(edge.given(), how);
    EXPECT_EQ(wrong(both, edge, how), "");
    EXPECT_EQ(both.faces(), 2);
    EXPECT_EQ(both.notes().vertices_welded, 1);
    // A chain of vertices, each within the tolerance of the next, stays long: nothing moves farther than the
    // tolerance.
    RawMesh chain = raw_grid(400, 1, 1e-3);
    for (Point3& p : chain.vertices) p[1] *= 5;
    how.weld = 0.004;  // 1.6 mm
    const Mesh long_one(chain.given(), how);
    EXPECT_EQ(wrong(long_one, chain, how), "");
    EXPECT_GT(long_one.faces(), 100);
    EXPECT_NEAR(long_one.high.x() - long_one.low.x(), 0.4, 0.004);
}

TEST(MeshBuild, TrianglesWithoutAreaGo) {
    RawMesh raw = raw_sphere(3);
    const auto n = raw.triangles.size();
    raw.triangles.push_back({0, 0, 1});  // a line
    raw.triangles.push_back({5, 5, 5});  // a point
    const auto v = static_cast<std::uint32_t>(raw.vertices.size());
    raw.vertices.insert(raw.vertices.end(), {{0.3, 0, 0}, {0.3, 0.1, 0}, {0.3, 0.04, 0}});
    raw.triangles.push_back({v, v + 1, v + 2});  // collinear
    for (const MeshBuild& how : {MeshBuild{}, exact()}) {
        const Mesh mesh(raw.given(), how);
        EXPECT_EQ(wrong(mesh, raw, how), "");
        EXPECT_EQ(mesh.faces(), n);
        EXPECT_EQ(mesh.notes().faces_degenerate, 3);
        EXPECT_EQ(mesh.notes().edges_open, 0);
    }
}

TEST(MeshBuild, TrianglesToldTwiceAreOne) {
    RawMesh raw = raw_sphere(3);
    const auto n = raw.triangles.size();
    for (std::size_t t = 0; t < n; t += 3) {
        const auto [a, b, c] = raw.triangles[t];
        raw.triangles.push_back({b, c, a});
        if (t % 2 == 0) raw.triangles.push_back({a, b, c});
    }
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.faces(), n);
    EXPECT_EQ(mesh.notes().faces_duplicate, raw.triangles.size() - n);
    EXPECT_EQ(mesh.notes().edges_open + mesh.notes().edges_non_manifold, 0);
}

TEST(MeshBuild, FacesWoundAgainstTheirNeighboursAreTurned) {
    const std::uint64_t seed = 0x5eed3;
    std::mt19937_64 random(seed);
    for (const double share : {0.1, 0.5, 0.9}) {
        RawMesh raw = raw_sphere(4, 0.1, 0.05);
        std::uint64_t turned = 0;
        for (std::size_t t = 0; t < raw.triangles.size(); ++t) {
            if (between(random, 0, 1) < share) raw.turn_over(t), ++turned;
        }
        const Mesh mesh(raw.given());
        EXPECT_EQ(wrong(mesh, raw), "") << "seed " << seed;
        EXPECT_EQ(mesh.notes().edges_open, 0);
        // The front of a body is its outside, whatever the majority of its triangles has.
        EXPECT_EQ(mesh.notes().faces_turned, turned);
        const Face& f = mesh.data().faces[0];
        const auto at = [&](std::size_t i) -> Eigen::Vector3d {
            return Eigen::Vector3d(f.corner[i][0], f.corner[i][1], f.corner[i][2]) + mesh.data().origin;
        };
        EXPECT_GT((at(1) - at(0)).cross(at(2) - at(0)).dot(at(0)), 0);
    }
}

TEST(MeshBuild, AnOpenSheetGoesWithMostOfItsFaces) {
    const std::uint64_t seed = 0x5eeda;
    std::mt19937_64 random(seed);
    for (int round = 0; round < 40; ++round) {
        RawMesh raw = raw_grid(10, 10);
        std::uint64_t down = 0;
        for (std::size_t t = 0; t < raw.triangles.size(); ++t)
            if (between(random, 0, 1) < (round % 2 == 0 ? 0.35 : 0.65)) raw.turn_over(t), ++down;
        const Mesh mesh(raw.given());
        EXPECT_EQ(wrong(mesh, raw), "") << "seed " << seed << " round " << round;
        EXPECT_EQ(mesh.notes().faces_turned, std::min(down, 200 - down))
            << "seed " << seed << " round " << round;
        EXPECT_EQ(mesh.notes().edges_open, 40);
        for (const Face& f : mesh.data().faces) {
            const auto up = (f.corner[1][0] - f.corner[0][0]) * (f.corner[2][1] - f.corner[0][1]) -
                            (f.corner[1][1] - f.corner[0][1]) * (f.corner[2][0] - f.corner[0][0]);
            EXPECT_EQ(up > 0, down < 100);
        }
    }
}

TEST(MeshBuild, APartThatAgreesWithItselfIsLeftAsItIs) {
    RawMesh raw = raw_sphere(3);
    RawMesh inside = raw_sphere(3, 0.05), other = raw_sphere(3, 0.02);
    for (std::size_t t = 0; t < inside.triangles.size(); ++t) inside.turn_over(t);  // a hollow
    raw.add(inside);
    const Mesh hollow(raw.given());
    EXPECT_EQ(wrong(hollow, raw), "");
    EXPECT_EQ(hollow.notes().faces_turned, 0);
    EXPECT_EQ(hollow.notes().parts, 2);
    other.turn_over(7);
    raw.add(other);
    const Mesh mesh(raw.given());
    EXPECT_EQ(wrong(mesh, raw), "");
    EXPECT_EQ(mesh.notes().faces_turned, 1);
}

TEST(MeshBuild, AVertexThatIsNoPlaceTakesItsFacesAlone) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    const RawMesh clean = raw_sphere(4, 0.1, 0.05);
    const Mesh whole(clean.given());
    for (const double bad : {nan, inf, -inf, 1e30, -1e7, 1e300, 5e6, 1e4}) {
        RawMesh raw = clean;
        raw.vertices[100][1] = bad;
        const Mesh mesh(raw.given());
        EXPECT_EQ(wrong(mesh, raw), "") << bad;
        const bool finite = std::abs(bad) < 1e7;
        EXPECT_EQ(mesh.notes().vertices_not_finite, finite ? 0 : 1) << bad;
        EXPECT_EQ(mesh.notes().vertices_far, finite ? 1 : 0) << bad;
        EXPECT_EQ(mesh.notes().faces_dropped, 6) << bad;
        EXPECT_EQ(mesh.notes().edges_open, 6) << bad;
        EXPECT_NEAR(mesh.data().size, whole.data().size, 1e-3) << bad;  // the bad vertex does not count
    }
    RawMesh unused = clean;  // a vertex without a triangle has no effect
    unused.vertices.push_back({nan, 0, 0});
    unused.vertices.push_back({1e6, 0, 0});
    const Mesh mesh(unused.given());
    EXPECT_EQ(mesh.notes().vertices_not_finite + mesh.notes().vertices_far, 0);
    EXPECT_EQ(mesh.data().size, whole.data().size);
}

TEST(MeshBuild, AllOfItTakesAtMost96BytesATriangle) {
    const std::uint64_t seed = 0x5eed4;
    std::mt19937_64 random(seed);
    RawMesh needles = raw_grid(4, 4000, 1e-5);
    for (Point3& p : needles.vertices) p[0] *= 1000;
    for (const RawMesh& raw : {raw_sphere(4), raw_sphere(6, 0.1, 0.05), raw_grid(100, 100), needles,
                               raw_soup(random, 10000, 0.01), raw_cone(5000)}) {
        const Mesh mesh(raw.given(), {.find_crossings = false});
        EXPECT_LE(static_cast<double>(mesh.bytes()) / static_cast<double>(mesh.faces()), 96)
            << mesh.faces() << " faces, seed " << seed;
    }
}

}  // namespace
