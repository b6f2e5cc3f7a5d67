// A proxy in cases with a known answer.

#include <Eigen/Geometry>

#include "spoiled.hpp"
#include "walk_tools.hpp"

namespace knurl::test {
namespace {

using Eigen::Vector3d;

constexpr double tiny = 1e-14;  // m, of double corners

MadeMesh tetrahedron() {
    MadeMesh shape;
    shape.name = "tetrahedron";
    shape.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
    shape.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return shape;
}

void expect_foot(const Finger& finger, const Vector3d& point, const Vector3d& normal, double depth,
                 double within = tiny) {
    EXPECT_LT((finger.foot.point - point).norm(), within) << finger.foot.point.transpose();
    EXPECT_LT((finger.foot.normal - normal.normalized()).norm(), 1e-9) << finger.foot.normal.transpose();
    EXPECT_NEAR(finger.foot.depth, depth, within);
}

/// A fin without thickness, given with both sides, on a floor of five triangles whose corners meet at the
/// fin's foot. The order of the triangles decides which side of the fin the walk meets first.
TEST(Walk, AHandDoesNotComeThroughAFinAroundItsFoot) {
    for (const std::array<std::size_t, 2>& order : {std::array<std::size_t, 2>{5, 6}, {6, 5}}) {
        for (const double side : {-1.0, 1.0}) {
            MadeMesh shape;
            shape.vertices = {{0, 0, 0},         {0, 0.02, 0},      {0, 0.02, 0.02}, {-0.02, -0.005, 0},
                              {0.02, -0.005, 0}, {-0.02, -0.02, 0}, {0.02, -0.02, 0}};
            const std::vector<Triangle> all = {{0, 1, 3}, {0, 4, 1}, {0, 3, 5}, {0, 6, 4},
                                               {0, 5, 6}, {0, 1, 2}, {0, 2, 1}};
            for (const std::size_t i : {order[0], std::size_t{0}, std::size_t{1}, std::size_t{2},
                                        std::size_t{3}, std::size_t{4}, order[1]})
                shape.triangles.push_back(all[i]);
            const auto mesh = build(shape);
            Finger finger(*mesh);
            finger.to(side * 0.004, -0.002, 0.001);
            ASSERT_TRUE(finger.to(side * 0.004, -0.002, -0.001));
            ASSERT_TRUE(finger.to(-side * 0.0005, 0.012, 0.004)) << "through the fin from side " << side;
            EXPECT_NEAR(finger.foot.point.x(), 0, tiny);
            EXPECT_NEAR(finger.foot.depth, 0.0005, tiny);
            EXPECT_NEAR(finger.foot.normal.x(), side, 1e-9);
        }
    }
}

TEST(Walk, PokesAndSlidesOnATetrahedron) {
    const auto mesh = build(tetrahedron());
    Finger finger(*mesh);
    const Vector3d n = Vector3d(1, 1, 1).normalized(), middle = Vector3d::Constant(0.1 / 3);
    ASSERT_FALSE(finger.to(middle + 0.01 * n));
    ASSERT_TRUE(finger.to(middle - 0.001 * n));
    expect_foot(finger, middle, n, 0.001);
    EXPECT_EQ(finger.foot.triangle, 3u);
    // Along the slope: the foot is below the hand, not where it went in.
    const Vector3d way = Vector3d(1, -1, 0).normalized();
    for (int i = 0; i <= 100; ++i) {
        const Vector3d x = middle + way * (i * 1e-4);
        ASSERT_TRUE(finger.to(x - 0.002 * n));
        expect_foot(finger, x, n, 0.002);
    }
    EXPECT_FALSE(finger.to(middle + 1e-6 * n));
    EXPECT_EQ(finger.proxy.phase, Proxy::Phase::free);
}

TEST(Walk, GoesOverABoxsEdgeWhenTheOtherSideIsNearer) {
    const auto mesh = build(cube(4));  // 0.1 m, its middle in the origin or not
    const Vector3d high = mesh->high, low = mesh->low, middle = (low + high) / 2;
    const double half = 0.05;
    Finger finger(*mesh);
    finger.to(middle + Vector3d(half - 0.01, 0.003, half + 0.001));
    // 3 mm below the top, out towards the side: held by the top until the hand is beside the box.
    for (double x = half - 0.01; x < half; x += 1e-4) {
        const Vector3d hand = middle + Vector3d(x, 0.003, half - 0.003);
        ASSERT_TRUE(finger.to(hand));
        expect_foot(finger, hand + Vector3d(0, 0, 0.003), Vector3d::UnitZ(), 0.003);
    }
    EXPECT_FALSE(finger.to(middle + Vector3d(half + 1e-4, 0.003, half - 0.003)));
    // And back in from the side: now the side holds it.
    ASSERT_TRUE(finger.to(middle + Vector3d(half - 1e-3, 0.003, half - 0.003)));
    expect_foot(finger, middle + Vector3d(half, 0.003, half - 0.003), Vector3d::UnitX(), 1e-3);
}

TEST(Walk, RestsInAnInnerCornerOnItsVertexAndEdge) {
    // A room's corner: three faces' fronts towards (+, +, +).
    MadeMesh room;
    room.vertices = {{0, 0, 0},     {0.1, 0, 0},   {0, 0.1, 0},  {0, 0, 0.1},
                     {0.1, 0.1, 0}, {0, 0.1, 0.1}, {0.1, 0, 0.1}};
    room.triangles = {{0, 1, 4}, {0, 4, 2}, {0, 2, 5}, {0, 5, 3}, {0, 3, 6}, {0, 6, 1}};
    const auto mesh = build(room);
    Finger finger(*mesh);
    finger.to(0.03, 0.03, 0.03);
    ASSERT_TRUE(finger.along({0.03, 0.03, 0.03}, {-0.001, -0.002, 0.03}, 100));
    expect_foot(finger, {0, 0, 0.03}, {1, 2, 0}, std::sqrt(5e-6));
    ASSERT_TRUE(finger.along({-0.001, -0.002, 0.03}, {-0.001, -0.002, -0.003}, 100));
    expect_foot(finger, {0, 0, 0}, {1, 2, 3}, std::sqrt(14e-6));
    // Up the edge between two walls: both keep holding.
    ASSERT_TRUE(finger.along({-0.001, -0.002, -0.003}, {-0.001, -0.002, 0.05}, 200));
    expect_foot(finger, {0, 0, 0.05}, {1, 2, 0}, std::sqrt(5e-6));
    EXPECT_FALSE(finger.to(0.001, 0.001, 0.05));
}

TEST(Walk, APlaneGridIsAPlane) {
    const auto mesh = build(plane_grid());
    Finger finger(*mesh);
    finger.to(-0.015, -0.01, 0.002);
    for (int i = 0; i < 300; ++i) {
        const Vector3d hand(-0.015 + i * 1e-4, -0.01 + i * 0.7e-4, -0.001 - 1e-6 * i);
        ASSERT_TRUE(finger.to(hand)) << i;
        expect_foot(finger, {hand.x(), hand.y(), 0}, Vector3d::UnitZ(), -hand.z());
    }
}

// The tip slips off a rim as off the edge of a table: free below it, and not caught from behind.
TEST(Walk, SlipsOffARimAndMayComeBackFromAbove) {
    const auto mesh = build(plane_grid());
    const double rim = mesh->high.x();
    Finger finger(*mesh);
    finger.to(rim - 0.001, 0.0003, 0.001);
    ASSERT_TRUE(finger.to(rim - 0.001, 0.0003, -0.002));
    ASSERT_TRUE(finger.to(rim - 1e-6, 0.0003, -0.002));
    EXPECT_FALSE(finger.to(rim + 1e-6, 0.0003, -0.002));
    EXPECT_FALSE(finger.to(rim - 0.005, 0.0003, -0.002)) << "below the table";
    EXPECT_FALSE(finger.to(rim - 0.005, 0.0003, 0.002)) << "through it from behind";
    EXPECT_TRUE(finger.to(rim - 0.005, 0.0003, -0.002));
}

TEST(Walk, AHandThatBeginsInsideIsFreeUntilItHasComeOut) {
    const auto mesh = build(cube(4));
    const Vector3d middle = (mesh->low + mesh->high) / 2;
    Finger finger(*mesh);
    EXPECT_FALSE(finger.to(middle));
    EXPECT_FALSE(finger.along(middle, middle + Vector3d(0.06, 0, 0), 100));
    EXPECT_TRUE(finger.along(middle + Vector3d(0.06, 0, 0), middle + Vector3d(0.049, 0, 0), 10));
}

TEST(Walk, TwoSheetsBackToBackHoldFromBothSides) {
    const auto mesh = build(two_sided_sheet());
    const Vector3d middle = (mesh->low + mesh->high) / 2 + Vector3d(0.0013, 0.0004, 0);
    for (const double side : {1.0, -1.0}) {
        Finger finger(*mesh);
        finger.to(middle + Vector3d(0, 0, side * 0.002));
        for (int i = 0; i < 2000; ++i) {
            const double z = -0.0005 + 0.0006 * std::cos(0.1 * i);  // in front of it at times
            const bool in = finger.to(middle + Vector3d(1e-6 * i, 0, side * z));
            ASSERT_EQ(in, z < 0) << i << " on side " << side;
            if (in) {
                EXPECT_GT(finger.foot.normal.z() * side, 0.99);
            }
        }
    }
}

TEST(Walk, AThinPlateIsNotPoppedThrough) {
    const auto mesh = build(thin_plate());
    const Vector3d middle = (mesh->low + mesh->high) / 2;
    const double top = mesh->high.z();
    Finger finger(*mesh);
    finger.to(middle.x() + 0.0011, middle.y(), top + 0.001);
    for (int i = 0; i < 400; ++i) {
        const Vector3d hand(middle.x() + 0.0011 + 1e-5 * i, middle.y() + 0.7e-5 * i, top - 0.003);
        ASSERT_TRUE(finger.to(hand));
        expect_foot(finger, {hand.x(), hand.y(), top}, Vector3d::UnitZ(), 0.003, 1e-8);
    }
}

TEST(Walk, WhatIsNotANumberMeetsNothing) {
    const auto mesh = build(cube(2));
    const Vector3d middle = (mesh->low + mesh->high) / 2;
    Finger finger(*mesh);
    finger.to(middle + Vector3d(0, 0.01, 0.06));
    ASSERT_TRUE(finger.to(middle + Vector3d(0, 0.01, 0.049)));
    EXPECT_FALSE(finger.to(NAN, 0, 0));
    EXPECT_FALSE(finger.to(INFINITY, 0, 0));
    EXPECT_FALSE(finger.to(1e300, 1e300, -1e300));
    EXPECT_FALSE(finger.to(middle + Vector3d(0, 0.01, 0.06)));
    EXPECT_TRUE(finger.to(middle + Vector3d(0, 0.01, 0.049)));
    finger.proxy.face = 123456789;  // as if it were of another mesh
    EXPECT_FALSE(finger.to(middle + Vector3d(0, 0.01, 0.049)));
}

// A teleport right through something stops at it.
TEST(Walk, NothingIsFastEnoughToTunnel) {
    const auto mesh = build(plane_grid());
    for (const double far : {0.01, 1.0, 100.0, 1e5}) {
        Finger finger(*mesh);
        finger.to(0.0011, 0.0007, far);
        bool in = false;
        for (int cycles = 0; cycles < 3 && !in; ++cycles) in = finger.to(0.0011, 0.0007, -far);
        EXPECT_TRUE(in) << far;
        if (in) {
            EXPECT_NEAR(finger.foot.depth, far, far * 1e-9);
        }
    }
}

TEST(Walk, ShadedNormalsAreContinuousAndThoseOfTheSphere) {
    const auto mesh = build(icosphere(3));
    Finger finger(*mesh);
    finger.to(0, 0, 0.11);
    Vector3d last(0, 0, 0);
    for (int i = 0; i < 3000; ++i) {
        const double a = i * 5e-4;
        const Vector3d out(std::sin(a) * 0.8, std::sin(a) * 0.6, std::cos(a));
        ASSERT_TRUE(finger.to(0.097 * out));
        const Vector3d shaded = shaded_normal(*mesh, finger.foot);
        EXPECT_NEAR(shaded.norm(), 1, 1e-12);
        EXPECT_GT(shaded.dot(finger.foot.point.normalized()), std::cos(0.01));
        if (i > 0) {
            EXPECT_LT((shaded - last).norm(), 0.02);
        }  // a face's own normals jump by 0.13
        last = shaded;
    }
}

// A floor and a wall that share no vertex. The hand presses into the floor, and is dragged to the wall and
// through it. The wall stands on the floor's edges, or in the middle of its faces.
class WalkInATangle : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(WallOnEdges, WalkInATangle, testing::Bool());
TEST_P(WalkInATangle, AWallThatCrossesTheFloorIsNotPassedBelow) {
    MadeMesh sheets = crossing_sheets();
    if (!GetParam()) {
        const MadeMesh wall = sheets;
        sheets = grid(3, 3, 0.02, 0.02);
        sheets.append(wall);
        // The wall alone: its own floor is left out.
        std::erase_if(sheets.triangles, [&](const auto& t) {
            return t[0] >= 16 && sheets.vertices[t[0]][2] == 0 && sheets.vertices[t[1]][2] == 0 &&
                   sheets.vertices[t[2]][2] == 0;
        });
    }
    const auto mesh = build(sheets, true, false);
    ASSERT_GT(mesh->notes().faces_crossed, 0u);
    Finger finger(*mesh);
    finger.to(0.0123, 0.0031, 0.001);
    int through = 0, guards = 0, tangled = 0;
    for (int i = 0; i < 3000; ++i) {
        const double x = 0.012 * std::cos(i * 2e-3), y = 0.0031 + 1e-6 * i;
        ASSERT_TRUE(finger.to(x, y, -0.0015)) << i;
        through += finger.foot.point.x() < -1e-9;
        guards += static_cast<int>(finger.work.guards);
        tangled += finger.proxy.phase == Proxy::Phase::tangled;
        const Vector3d corner(std::max(x, 0.0), y, 0);
        EXPECT_LT((finger.foot.point - corner).norm(), 1e-6) << i;
        EXPECT_NEAR(finger.foot.depth, (corner - Vector3d(x, y, -0.0015)).norm(), 1e-6);
    }
    EXPECT_EQ(through, 0);
    EXPECT_GT(guards, 0);
    EXPECT_GT(tangled, 100);
    EXPECT_EQ(finger.proxy.phase, Proxy::Phase::touching) << "back in the open it walks again";
    EXPECT_FALSE(finger.to(0.012, 0.0031, 0.0001));
}

// Beyond the tip of a wedge of 30 degrees the hand is still behind the plane of the face that held it. The
// normal of one face alone would hold it at the edge without end.
TEST(Walk, LetsGoBeyondTheEdgeOfAKnife) {
    const double t = 0.1 * std::tan(M_PI / 6);
    MadeMesh wedge;
    wedge.vertices = {{0, -0.1, 0},   {0, 0.1, 0},      {-0.1, -0.1, 0},
                      {-0.1, 0.1, 0}, {-0.1, -0.1, -t}, {-0.1, 0.1, -t}};
    wedge.triangles = {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1},
                       {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
    const auto mesh = build(wedge);
    ASSERT_EQ(mesh->notes().edges_open, 0u);
    Finger finger(*mesh);
    finger.to(-0.003, 0.01, 0.001);
    ASSERT_TRUE(finger.to(-0.003, 0.01, -0.0005));
    expect_foot(finger, {-0.003, 0.01, 0}, Vector3d::UnitZ(), 0.0005);
    EXPECT_FALSE(finger.to(0.002, 0.01, -0.0005));
}

TEST(Walk, LetsGoBeyondTheEdgeOfASheetWithTwoSides) {
    const auto mesh = build(two_sided_sheet());
    Finger finger(*mesh);
    finger.to(0.019, 0.0011, 0.001);
    ASSERT_TRUE(finger.to(0.019, 0.0011, -0.001));
    EXPECT_FALSE(finger.to(0.0201, 0.0011, -0.001));
}

// The hand is past an edge by less than a distance can resolve: the foot must follow nevertheless.
TEST(Walk, IsExactBesideAnEdge) {
    const auto mesh = build(plane_grid());
    const double edge = 0.002;
    for (double past = 1e-13; past < 1e-9; past *= 1.3) {
        Finger finger(*mesh);
        finger.to(edge - 1e-4, 0.0003, 0.001);
        ASSERT_TRUE(finger.to(edge - 1e-4, 0.0003, -0.003));
        ASSERT_TRUE(finger.to(edge + past, 0.0003, -0.003));
        EXPECT_NEAR(finger.foot.point.x(), edge + past, 1e-15);
    }
}

// Faces that lie side by side without a link between them: the walk finds them through the tree.
TEST(Walk, GoesOverSeamsThatAreNotWelded) {
    Rng rng(3);
    for (const MadeMesh& shape :
         {with_t_junctions(plane_grid(), 0.5, rng), jittered(unwelded(plane_grid()), 2e-7, rng)}) {
        const auto mesh = std::make_unique<Mesh>(view(shape), MeshBuild{.exact = true, .weld = 0});
        Finger finger(*mesh);
        finger.to(-0.015, -0.01, 0.002);
        for (int i = 0; i < 300; ++i) {
            const Vector3d hand(-0.015 + i * 1e-4, -0.01 + i * 0.7e-4, -0.001);
            ASSERT_TRUE(finger.to(hand)) << shape.name << " " << i;
            EXPECT_LT((finger.foot.point - Vector3d(hand.x(), hand.y(), 0)).norm(), 1e-6)
                << shape.name << " " << i;
        }
    }
}

}  // namespace
}  // namespace knurl::test
