// A probe with a radius, and a proxy that moves to another mesh.

#include "exact/surface.hpp"
#include "paths.hpp"
#include "spoiled.hpp"
#include "walk_tools.hpp"

namespace knurl::test {
namespace {

using Eigen::Vector3d;

constexpr double radius = 0.002;

TEST(WalkWithARadius, OnAPlaneItsDepthIsTheRadiusLessTheHeight) {
    const auto mesh = build(plane_grid());
    Finger finger(*mesh, radius);
    for (double z = 0.004; z > -0.003; z -= 1e-5) {
        const bool touches = finger.to(0.0013, -0.0007, z);
        ASSERT_EQ(touches, z < radius) << z;
        if (!touches) continue;
        EXPECT_NEAR(finger.foot.depth, radius - z, 1e-14) << z;
        EXPECT_LT((finger.foot.normal - Vector3d::UnitZ()).norm(), 1e-9) << z;
        EXPECT_LT((finger.foot.point - Vector3d(0.0013, -0.0007, 0)).norm(), 1e-14) << z;
    }
    for (double z = -0.003; z < 0.004; z += 1e-5) ASSERT_EQ(finger.to(0.0013, -0.0007, z), z < radius) << z;
}

TEST(WalkWithARadius, RollsOverAConvexEdge) {
    const auto mesh = build(cube(4));
    const Vector3d corner(0.05, -0.003, 0.05);
    Finger finger(*mesh, radius);
    finger.to(corner + Vector3d(-0.01, 0, 0.01));
    for (double angle = 0; angle < M_PI / 2; angle += 1e-3) {
        const Vector3d out(std::sin(angle), 0, std::cos(angle));
        ASSERT_TRUE(finger.to(corner + 0.0015 * out));
        EXPECT_NEAR(finger.foot.depth, 0.0005, 1e-12);
        EXPECT_LT((finger.foot.point - corner).norm(), 1e-9);
        EXPECT_LT((finger.foot.normal - out).norm(), 1e-6);
    }
    EXPECT_FALSE(finger.to(corner + Vector3d(0.00142, 0, 0.00142)));
}

// While the centre is in front, the depth is that of the nearest point. It never jumps, although its
// direction does in a concave corner.
TEST(WalkWithARadius, InFrontItsDepthIsThatOfTheNearestPoint) {
    const std::uint64_t seed = 5;
    for (const MadeMesh& shape : {noisy_sphere(4, 0.3, seed), staircase()}) {
        const exact::Surface surface(shape.vertices, shape.triangles);
        const auto mesh = build(shape);
        Hands hands(shape, seed);
        std::size_t touching = 0, cycle = 0;
        for (int i = 0; i < 4; ++i) {
            Finger finger(*mesh, radius);
            for (const auto& p : hands.hover()) {
                const bool touches = finger.to(p);
                if (++cycle % 5 != 0) continue;  // searching all faces takes long
                const exact::V h = exact::to_exact(p);
                if (surface.winding(h) > 0.5L) continue;
                const int face = surface.nearest_face(h);
                const double far = double(exact::distance(surface.nearest(face, h).point, h));
                ASSERT_EQ(touches, far < radius) << shape.name << ", seed " << seed;
                if (touches) {
                    EXPECT_NEAR(finger.foot.depth, radius - far, 1e-12);
                }
                touching += touches;
            }
        }
        EXPECT_GT(touching, 100u) << shape.name;
    }
}

TEST(WalkWithARadius, FastOnesDoNotTunnel) {
    const auto mesh = build(thin_plate());
    const Vector3d middle = (mesh->low + mesh->high) / 2 + Vector3d(0.0011, 0.0007, 0);
    for (const double step : {0.0005, 0.003, 0.02, 0.5}) {
        Finger finger(*mesh, radius);
        finger.to(middle + Vector3d(0, 0, 1.0));
        bool in = false;
        for (double z = 1.0; z > -0.02; z -= step) in = finger.to(middle + Vector3d(0, 0, z));
        ASSERT_TRUE(in) << step;
        EXPECT_GT(finger.foot.normal.z(), 0.99) << step;
        EXPECT_NEAR(finger.foot.point.z(), 5e-5, 1e-12);
    }
}

TEST(WalkWithARadius, OneThatIsNoneIsAPoint) {
    const auto mesh = build(plane_grid());
    for (const double none : {-1.0, double{NAN}}) {
        Finger finger(*mesh, none);
        EXPECT_FALSE(finger.to(0.0013, -0.0007, 0.001));
        for (int i = 0; i < 3; ++i) {
            ASSERT_TRUE(finger.to(0.0013 + 1e-5 * i, -0.0007, -0.001));
            EXPECT_NEAR(finger.foot.depth, 0.001, 1e-14);
        }
    }
}

// The radius changes while an empty box is known: the box is valid only for the radius with which it was
// made.
TEST(WalkWithARadius, MayChangeFromCycleToCycle) {
    const auto mesh = build(plane_grid());
    Proxy proxy;
    Foot foot;
    Work work;
    for (int i = 0; i < 300; ++i) {
        const Vector3d hand(0.0013 + 1e-7 * i, -0.0007, 0.005);
        EXPECT_FALSE(follow(*mesh, proxy, hand, 0, foot, work));
    }
    ASSERT_LT(proxy.low[0], proxy.high[0]) << "no empty box was found";
    EXPECT_TRUE(follow(*mesh, proxy, {0.0013, -0.0007, 0.005}, 0.006, foot, work));
    EXPECT_NEAR(foot.depth, 0.001, 1e-12);
}

TEST(WalkAdopts, AnotherMeshUnderTheHandKeepsItsPlace) {
    const MadeMesh coarse = icosphere(3), fine = icosphere(5);
    const auto from = build(coarse), to = build(fine);
    Finger finger(*from);
    finger.to(0.02, 0.03, 0.11);
    const Vector3d hand(0.016, 0.025, 0.09);
    ASSERT_TRUE(finger.to(hand));
    const Foot before = finger.foot;
    Work work;
    adopt(*to, finger.proxy, hand, work);
    EXPECT_LE(work.nodes, max_nodes);
    EXPECT_EQ(finger.proxy.phase, Proxy::Phase::touching);
    Foot foot;
    ASSERT_TRUE(follow(*to, finger.proxy, hand, 0, foot, work));
    EXPECT_LT((foot.point - before.point).norm(), 0.002);  // the difference of the meshes
    EXPECT_GT(foot.normal.dot(before.normal), 0.97);
    // The same mesh again: nothing moves.
    adopt(*to, finger.proxy, hand, work);
    Foot again;
    ASSERT_TRUE(follow(*to, finger.proxy, hand, 0, again, work));
    EXPECT_LT((again.point - foot.point).norm(), 1e-15);
}

TEST(WalkAdopts, AFreeProxyIsFreeEvenInsideOfTheNewMesh) {
    const auto from = build(icosphere(2, 0.05)), to = build(icosphere(3, 0.1));
    Finger finger(*from);
    const Vector3d hand(0, 0.01, 0.08);
    ASSERT_FALSE(finger.to(hand));
    Work work;
    Foot foot;
    adopt(*to, finger.proxy, hand, work);
    EXPECT_FALSE(follow(*to, finger.proxy, hand, 0, foot, work));
    EXPECT_FALSE(follow(*to, finger.proxy, hand, 0, foot, work));
}

}  // namespace
}  // namespace knurl::test
