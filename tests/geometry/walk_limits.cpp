// No cycle takes long, allocates, or lets go where it must hold.

#include "../reps/count_allocations.hpp"
#include "paths.hpp"
#include "spoiled.hpp"
#include "walk_tools.hpp"

namespace knurl::test {
namespace {

using Eigen::Vector3d;

// Finger checks every cycle against the limits.
TEST(WalkWithinLimits, WhereverTheHandIsThrownTo) {
    const MadeMesh shape = noisy_sphere(6, 0.5, 11);
    const auto mesh = build(shape, false);
    Hands hands(shape, 12);
    for (const double radius : {0.0, 0.004}) {
        Finger finger(*mesh, radius);
        int capped = 0;
        for (const auto& p : hands.teleports(400, 8)) {
            finger.to(p);
            capped += finger.work.faces >= max_walk_faces || finger.work.nodes >= max_nodes;
        }
        EXPECT_GT(capped, 0) << "no limit was met: this says nothing";
    }
}

// The limit of work ends a walk after a long jump of the hand; in the following cycles the walk arrives.
TEST(WalkWithinLimits, GoesOnInTheNextCycle) {
    const auto mesh = build(icosphere(6), false);
    Finger finger(*mesh);
    finger.to(0, 0, 0.11);
    ASSERT_TRUE(finger.to(0, 0, 0.099));
    const Vector3d hand = 0.09 * Vector3d(0.8, 0.1, -0.5).normalized();
    int cycles = 0;
    do {
        ASSERT_TRUE(finger.to(hand));
        const Vector3d way = finger.foot.point - hand;
        EXPECT_TRUE(finger.foot.depth == 0 || way.dot(finger.foot.normal) > 0) << "pulled inwards";
    } while (++cycles < 100 && finger.work.faces > 0);
    EXPECT_GT(cycles, 2);
    EXPECT_LT(cycles, 20);
    EXPECT_NEAR(finger.foot.depth, 0.01, 1e-4);
    EXPECT_GT(finger.foot.normal.dot(hand.normalized()), 0.999);
}

// A path from behind through twenty thousand sheets, against the front of the last one: more boxes than a
// cycle may search. The following cycles search the rest of the path, and the last sheet holds.
TEST(WalkWithinLimits, ASweepThatALimitCutsGoesOn) {
    MadeMesh shape;
    constexpr std::uint32_t sheets = 20000;
    for (std::uint32_t i = 0; i <= sheets; ++i) {
        const double x = double(i) / sheets;
        for (const auto& [y, z] : {std::pair{-0.01, -0.01}, {0.01, -0.01}, {0.0, 0.01}})
            shape.vertices.push_back({x, y, z});
        const std::uint32_t v = 3 * i;
        shape.triangles.push_back(i < sheets ? Triangle{v, v + 1, v + 2} : Triangle{v, v + 2, v + 1});
    }
    const auto mesh = build(shape, false, false);
    Finger finger(*mesh);
    finger.to(-0.01, 0, 0);
    finger.to(1.001, 0, 0);
    EXPECT_EQ(finger.proxy.phase, Proxy::Phase::free);
    EXPECT_GT(finger.work.nodes, max_nodes - 16) << "no limit was met: this says nothing";
    int cycles = 0;
    while (++cycles < 50 && !finger.to(1.001, 0, 0)) {
    }
    EXPECT_LT(cycles, 50);
    EXPECT_NEAR(finger.foot.depth, 0.001, 1e-6);
}

TEST(WalkWithinLimits, AllocatesNothing) {
    const MadeMesh shape = noisy_sphere(4, 0.3, 3);
    const auto mesh = build(shape), other = build(crossing_sheets(), true, false);  // not cut: tangled
    Hands hands(shape, 4);
    const Hand stroke = hands.stroke(), poke = hands.poke(), thrown = hands.teleports(50, 2);
    Proxy proxy;
    Foot foot;
    Work work;
    const std::size_t before = allocations();
    for (const double radius : {0.0, 0.002}) {
        for (const Hand* hand : {&stroke, &poke, &thrown}) {
            for (const auto& p : *hand) {
                const Vector3d h(p[0], p[1], p[2]);
                if (follow(*mesh, proxy, h, radius, foot, work)) shaded_normal(*mesh, foot);
                adopt(*mesh, proxy, h, work);
            }
        }
    }
    proxy = Proxy{};
    for (int i = 0; i < 1000; ++i)
        follow(*other, proxy, {0.01 * std::cos(0.01 * i), 0.003, 0.001 - 1e-5 * std::min(i, 300)}, 0, foot,
               work);
    EXPECT_GT(work.tangles, 0u);
    EXPECT_EQ(allocations(), before);
}

// Goes in and out by rounding, 240 000 times, on faces, edges and corners, and never falls in.
TEST(WalkWithinLimits, GrazingNeverFallsIn) {
    const MadeMesh shape = icosphere(3);
    for (const bool exact : {true, false}) {
        const auto mesh = build(shape, exact);
        Rng rng(17);
        int fell = 0, touched = 0;
        for (int place = 0; place < 1200; ++place) {
            Finger finger(*mesh);
            const std::size_t i = below(rng, shape.triangles.size());
            const auto at = [&](std::size_t k) {
                const auto& p = shape.vertices[shape.triangles[i][k]];
                return Vector3d(p[0], p[1], p[2]);
            };
            // A corner, or a point of an edge or of the face; and so close to it that only rounding decides
            // about contact.
            const double u = place % 3 == 0 ? 0 : between(rng, 0, 1),
                         v = place % 3 < 2 ? 0 : between(rng, 0, 1 - u);
            const Vector3d x = at(0) + u * (at(1) - at(0)) + v * (at(2) - at(0)), out = x.normalized();
            const double scale = std::pow(10.0, between(rng, -17.5, -14)),
                         aside = scale * std::pow(10.0, between(rng, 0, 6));
            finger.to(x + 0.001 * out);
            for (int k = 0; k < 100; ++k) {
                const Vector3d w(between(rng, -1, 1), between(rng, -1, 1), between(rng, -1, 1));
                touched += finger.to(x + aside * (w - w.dot(out) * out) + out * (scale * w.x()));
            }
            fell += !finger.to(x - 1e-4 * out);
        }
        EXPECT_EQ(fell, 0) << (exact ? "double" : "float");
        EXPECT_GT(touched, 30000);
    }
}

// All tolerances scale with the size.
TEST(WalkWithinLimits, LetsGoAtTheSamePartOfAnySize) {
    for (const double scale : {1e-3, 1.0, 1e3}) {  // 40 um, 4 cm, 40 m
        const auto mesh = build(scaled(plane_grid(), scale));
        Finger finger(*mesh);
        finger.to(scale * Vector3d(0.0011, 0.0007, 0.002));
        for (int i = 0; i < 100; ++i) {
            const Vector3d hand = scale * Vector3d(0.0011 + 1e-4 * i, 0.0007, -0.001);
            ASSERT_TRUE(finger.to(hand));
            EXPECT_NEAR(finger.foot.depth, scale * 0.001, scale * 1e-15);
            EXPECT_FALSE(finger.to(hand + scale * Vector3d(0, 0, 0.001 + 1e-9)));
        }
        EXPECT_TRUE(finger.to(scale * Vector3d(0.0011, 0.0007, -0.001)));
        EXPECT_TRUE(finger.to(scale * Vector3d(0.0011, 0.0007, 1e-13)));  // on it
        EXPECT_EQ(finger.foot.depth, 0);
    }
}

TEST(WalkWithinLimits, CrossingSheetsOfAnySizeAnywhere) {
    for (const double scale : {2e-4, 1.0, 200.0}) {
        for (const double far : {0.0, 1e3, 1e6}) {
            if (far > 0 && scale < 1) continue;  // the resolution of a double is too coarse there
            const exact::V off{far, -far / 3, far / 7};
            const auto mesh = build(moved(scaled(crossing_sheets(), scale), off));
            const Vector3d o(double(off.x), double(off.y), double(off.z));
            Finger finger(*mesh);
            finger.to(o + scale * Vector3d(0.0123, 0.0031, 0.001));
            int through = 0, lost = 0;
            for (int i = 0; i < 3000; ++i) {
                const double x = 0.012 * std::cos(i * 2e-3);
                lost += !finger.to(o + scale * Vector3d(x, 0.0031 + 1e-6 * i, -0.0015));
                through += (finger.foot.point - o).x() < -1e-7 * scale - far * 1e-15;
            }
            EXPECT_EQ(through, 0) << scale << " at " << far;
            EXPECT_EQ(lost, 0) << scale << " at " << far;
        }
    }
}

// In free space most cycles do not search the mesh at all.
TEST(WalkWithinLimits, FreeWithRoomLooksAtNothing) {
    const auto mesh = build(icosphere(5), false);
    Finger finger(*mesh);
    std::uint64_t nodes = 0;
    for (int i = 0; i < 10000; ++i) {
        const double angle = i * 1e-3;  // 0.13 m/s
        EXPECT_FALSE(finger.to(0.13 * Vector3d(std::cos(angle), std::sin(angle), 0)));
        nodes += finger.work.nodes;
    }
    EXPECT_LT(nodes, 1000u);
}

}  // namespace
}  // namespace knurl::test
