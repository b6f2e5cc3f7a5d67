// Sphere, capsule, cylinder and torus, from outside and from inside: the work of every path, and what is held deep
// inside. tests/reference/solids.cpp compares them with the reference.

#include "solids_reference.hpp"

using namespace knurl;
using namespace knurl::test;

TYPED_TEST(Solids, PressedDeeperThanHalfWayToItsCoreItKeepsTheNormalAndHoldsHoweverDeep) {
    Rng& rng = this->random;
    for (int round = 0; round < 200; ++round) {
        TypeParam s = random_solid<TypeParam>(rng, 0.03);
        if constexpr (requires { s.tube; })
            s.tube = std::min(s.tube, s.radius / 2), s.radius += 0.005;  // nothing plugs the hole
        const double probe = round % 2 ? 0 : 0.005, half = (least_radius(s) + probe) / 2;
        // From outside towards the core, straight through, and out on the other side.
        Vector p;
        exact::Foot start;
        do {
            p = some_point(rng, s, probe);
            start = nearest_foot(s, p, probe);
        } while (start.height < 1e-4);
        const Vector n = exact::rounded(start.normal);
        const Vector surface = p - static_cast<double>(start.height) * n;
        // Until a cylinder's face holds alone the contact is the edge's.
        if (!straight_in(s, surface, n, std::is_same_v<TypeParam, Cylinder> ? probe + 1e-4 : half, probe))
            continue;
        Evaluated<TypeParam> solid(s);
        solid(p, probe);
        const double last = 2 * (largest(s) + probe) + half;
        for (double depth = 0; depth < last; depth += half / 100) {
            const Contact c = solid(surface - depth * n, probe);
            ASSERT_NEAR(c.height, -depth, 1e-12) << "round " << round << " depth " << depth;
            ASSERT_LE((c.normal - n).norm(), 1e-9) << "round " << round << " depth " << depth;
        }
    }
}

TYPED_TEST(Solids, TheWayBackOutOfTheDepthIsTheWayIn) {
    Rng& rng = this->random;
    for (int round = 0; round < 200; ++round) {
        const TypeParam s = random_solid<TypeParam>(rng, 0.03);
        const double half = least_radius(s) / 2, deepest = 1.5 * half;
        Vector p;
        do {
            p = some_point(rng, s);
        } while (nearest_foot(s, p, 0).height < 1e-4);
        const exact::Foot start = nearest_foot(s, p, 0);
        const Vector n = exact::rounded(start.normal), surface = p - static_cast<double>(start.height) * n;
        if (!straight_in(s, surface, n, half, 0)) continue;
        Evaluated<TypeParam> solid(s);
        std::vector<double> in;
        for (int i = 0; i <= 100; ++i) in.push_back(solid(surface - deepest * i / 100 * n).height);
        for (int i = 100; i >= 0; --i)
            ASSERT_NEAR(solid(surface - deepest * i / 100 * n).height, in[(std::size_t)i], 1e-12);
        EXPECT_GE(solid(p).height, 0);
    }
}

TYPED_TEST(Solids, NoWayThroughItGivesTheHandMoreThanItPutIn) {
    Rng& rng = this->random;
    for (int round = 0; round < 60; ++round) {
        const TypeParam s = random_solid<TypeParam>(rng, 0.02);
        Evaluated<TypeParam> solid(s);
        SmallLoop loop(rng, to_eigen(s.center), 0.02);
        double sum = 0, gained = 0;
        Vector p = loop.at(0);
        bool outside = false;
        constexpr int steps = 40'000;
        for (int i = 0; i < 2 * steps; ++i) {
            const Vector next = loop.at(2 * M_PI * (i + 1) / steps);
            const Contact c = solid((p + next) / 2);
            sum += force_of(c).dot(next - p);
            p = next;
            if (c.height >= 0) {  // between two times outside
                if (outside) gained = std::max(gained, sum);
                outside = true;
                sum = 0;
            }
        }
        EXPECT_LE(gained, 5e-5) << "J; round " << round;  // the error of the quadrature at a cylinder's edges
    }
}
