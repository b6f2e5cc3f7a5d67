// Tests the generated meshes: their number of faces, closedness and size are as stated.

#include <exact/god_object.hpp>
#include <gtest/gtest.h>

#include "paths.hpp"
#include "spoiled.hpp"

namespace {

using namespace knurl::test;
using exact::Real;
using exact::Surface;
using exact::V;

Real volume(const MadeMesh& s) {
    Real sum = 0;
    for (std::size_t i = 0; i < s.triangles.size(); ++i) {
        sum += dot(s.corner(i, 0), cross(s.corner(i, 1), s.corner(i, 2))) / 6;
    }
    return sum;
}

TEST(GeneratedMeshes, AreClosedAndTurnedOutwards) {
    for (const MadeMesh& s : clean_shapes(1)) {
        const Surface surface(s.vertices, s.triangles);
        EXPECT_EQ(surface.open_edges(), 0U) << s.name;
        EXPECT_EQ(surface.faces(), s.triangles.size()) << s.name;
        EXPECT_GT(volume(s), 0) << s.name;
        EXPECT_GT(s.size(), 0.05) << s.name;
        EXPECT_LT(s.size(), 0.4) << s.name;
    }
    EXPECT_NEAR(static_cast<double>(volume(icosphere(4))), 4.0 / 3 * M_PI * 1e-3, 2e-5);
    EXPECT_NEAR(static_cast<double>(volume(cube(3))), 1e-3, 1e-15);
    EXPECT_EQ(icosphere(3).triangles.size(), 20U * 64);
}

TEST(GeneratedMeshes, AreTheSameForTheSameSeed) {
    EXPECT_EQ(noisy_sphere(2, 0.3, 9).vertices, noisy_sphere(2, 0.3, 9).vertices);
    EXPECT_NE(noisy_sphere(2, 0.3, 9).vertices, noisy_sphere(2, 0.3, 8).vertices);
    const MadeMesh s = torus(20, 10);
    EXPECT_EQ(Hands(s, 4).stroke(), Hands(s, 4).stroke());
}

TEST(GeneratedMeshes, SpoiledOnesKeepTheSurface) {
    Rng rng(3);
    const MadeMesh s = icosphere(2);
    for (const MadeMesh& bad : {unwelded(s), duplicated(s, 0.3, rng), with_degenerate(s, 0.3, rng),
                                with_t_junctions(s, 0.3, rng), shuffled(s, rng)}) {
        for (int i = 0; i < 50; ++i) {
            const V p{between(rng, -.2, .2), between(rng, -.2, .2), between(rng, -.2, .2)};
            const Surface good(s.vertices, s.triangles), spoiled(bad.vertices, bad.triangles);
            const V a = good.nearest(good.nearest_face(p), p).point;
            ASSERT_LT(exact::distance(a, spoiled.nearest(spoiled.nearest_face(p), p).point), 1e-16L)
                << bad.name;
        }
    }
    EXPECT_EQ(Surface(unwelded(s).vertices, unwelded(s).triangles).open_edges(), 3 * s.triangles.size());
}

TEST(Hands, TouchWhatTheyShould) {
    for (const MadeMesh& s : clean_shapes(1)) {
        const Surface surface(s.vertices, s.triangles);
        Hands hands(s, 11);
        int touching = 0, cycles = 0;
        for (const Hand& hand : {hands.stroke(), hands.stroke(), hands.poke(), hands.around_an_edge()}) {
            exact::GodObject god(surface);
            for (std::size_t i = 1; i < hand.size(); ++i) {
                ++cycles;
                touching += god.step(exact::to_exact(hand[i]));
                const Real step = exact::distance(exact::to_exact(hand[i]), exact::to_exact(hand[i - 1]));
                ASSERT_LT(step, 0.0004L * s.size() / 0.2L) << s.name;
            }
        }
        EXPECT_GT(touching, cycles / 3) << s.name;
    }
}

}  // namespace
