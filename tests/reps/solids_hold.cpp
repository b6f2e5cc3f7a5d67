// Solids thinner than the depth of the hand: they hold it from where it came, at any depth, and let it slip
// off sideways without a step.

#include <string>

#include "solids_reference.hpp"

using namespace knurl;
using namespace knurl::test;

namespace solids_hold_tests {
namespace {

constexpr std::uint64_t seed = 8301;
constexpr double deepest = 0.01;  // m

// Coins, needles, beads, wires: half a millimetre to three, and probes up to twice that.
Sphere thin(Rng& rng, const Sphere&) {
    return {.radius = scale(rng, 5e-4, 3e-3)};
}
Capsule thin(Rng& rng, const Capsule&) {
    return {.half_length = scale(rng, 2e-3, 0.05), .radius = scale(rng, 2.5e-4, 2e-3)};
}
Cylinder thin(Rng& rng, const Cylinder&) {
    const bool coin = between(rng, 0, 1);
    const double small = scale(rng, 2.5e-4, 2e-3), large = scale(rng, 5e-3, 0.05);
    return {.radius = coin ? large : small, .half_length = coin ? small : large};
}
Torus thin(Rng& rng, const Torus&) {
    return {.radius = scale(rng, 0.01, 0.05), .tube = scale(rng, 2.5e-4, 2e-3)};
}

template <class R>
R thin_solid(Rng& rng) {
    R s = thin(rng, R{});
    s.center = to_plain(Vector(0.02 * direction(rng)));
    s.stiffness = 1000;
    if constexpr (requires { s.axis; }) s.axis = to_plain(direction(rng));
    return s;
}

// A path straight in along the normal at a point of the surface, or up to a third of the thickness beside it.
template <class R>
struct WayIn {
    Vector from, normal;
    double probe;
    bool rounded = false;  // over the edge of a cylinder

    WayIn(Rng& rng, const R& s, double beside) {
        probe = between(rng, 0, 1) ? 0 : uniform(rng, 0, 2) * least_radius(s);
        const double size = largest(s) + probe;
        exact::Foot start;
        do {
            from = to_eigen(s.center) + 1.5 * size * direction(rng);
            start = nearest_foot(s, from, probe);
        } while (!(start.height > 1e-4L));
        normal = exact::rounded(start.normal);
        from -= static_cast<double>(start.height - 1e-4L) * normal;
        from += beside * least_radius(s) * normal.cross(direction(rng));
        if constexpr (std::is_same_v<R, Cylinder>) {
            const double along = std::abs(normal.dot(to_eigen(s.axis).normalized()));
            rounded = along > 1e-9 && along < 1 - 1e-9;
        }
    }
};

}  // namespace

template <class R>
struct ThinSolids : testing::Test {
    Rng random{seed};
};
TYPED_TEST_SUITE(ThinSolids, All);

TYPED_TEST(ThinSolids, HoldTheHandFromWhereItCameHoweverDeepAndGiveItBackThere) {
    Rng& rng = this->random;
    int held = 0;
    for (int round = 0; round < (long_form() ? 20'000 : 400); ++round) {
        const TypeParam s = thin_solid<TypeParam>(rng);
        const WayIn<TypeParam> way(rng, s, 0);
        if (way.rounded) continue;
        const double step = scale(rng, 1e-5, 3e-3);  // up to 3 m/s: right through it in one cycle
        Evaluated<TypeParam> solid(s);
        const std::string where = "seed " + std::to_string(seed) + " round " + std::to_string(round);
        solid(way.from, way.probe);
        double depth = -1e-4;
        bool past = false;  // a step that ends out of its ball has led past it
        while (depth < deepest && !past) {
            depth += step;
            const Vector p = way.from - (depth + 1e-4) * way.normal;
            past = solid.state.hold.part == 0 &&
                   (p - to_eigen(s.center)).norm() > 0.999 * (largest(s) + way.probe);
            if (past) break;
            const Contact now = solid(p, way.probe);
            if (depth < 1e-9) continue;
            ASSERT_NEAR(now.height, -depth, 1e-9) << where;
            ASSERT_LE((now.normal - way.normal).norm(), 1e-6) << where << " depth " << depth;
        }
        if (past) continue;
        ++held;
        for (; depth > -1e-4; depth -= 3e-5) {
            const Contact now = solid(way.from - (depth + 1e-4) * way.normal, way.probe);
            if (!(depth > 1e-9)) continue;
            ASSERT_NEAR(now.height, -depth, 1e-9) << where;
        }
        EXPECT_GE(solid(way.from, way.probe).height, 0) << where << ": free again where it came in";
        EXPECT_EQ(solid.state.hold.part, 0u) << where;
    }
    EXPECT_GT(held, 100);
}

TYPED_TEST(ThinSolids, PressedBesideTheirMiddleHoldOrSlipOffSidewaysWithoutAStep) {
    Rng& rng = this->random;
    int slipped = 0;
    for (int round = 0; round < (long_form() ? 20'000 : 400); ++round) {
        const TypeParam s = thin_solid<TypeParam>(rng);
        WayIn<TypeParam> way(rng, s, uniform(rng, 0.02, 0.4));
        // A probe whose radius presses it over an edge turns there as fast as it passes.
        if (std::is_same_v<TypeParam, Cylinder>) way.from -= way.probe * way.normal, way.probe = 0;
        const double step = scale(rng, 1e-6, 1e-4);
        Evaluated<TypeParam> solid(s);
        const std::string where = "seed " + std::to_string(seed) + " round " + std::to_string(round);
        Contact last = solid(way.from, way.probe);
        for (double gone = 0; gone < deepest; gone += step) {
            const Contact now = solid(way.from - gone * way.normal, way.probe);
            // By the surface's stiffness, and by what its normal turns in a cycle about the place of contact.
            const double lever = 1000 * (gone + 2 * (least_radius(s) + way.probe));
            ASSERT_LE((force_of(now) - force_of(last)).norm(), 0.0502 * lever + 2100 * step + 1e-9)
                << where << " gone " << gone;
            // Off sideways, not shot out at the back: no harder than its surface there.
            const double onwards = -force_of(now).dot(way.normal);
            ASSERT_LE(onwards, 1000 * (least_radius(s) + way.probe)) << where << " gone " << gone;
            if (now.height >= 0 && last.height < 0) {
                ++slipped;
                break;
            }
            last = now;
        }
    }
    EXPECT_GT(slipped, 20);
}

// The hand goes anywhere: in, out, behind and around. The force changes by no more than the plane's own
// stiffness times the way, plus the effect of a twentieth of a radian on the lever of the kept normal.
TYPED_TEST(ThinSolids, NeverMakeAStepAndNeverGiveMoreThanWasPutIn) {
    Rng& rng = this->random;
    int touched = 0;
    double worst = 0;
    for (int round = 0; round < (long_form() ? 4000 : 60); ++round) {
        const TypeParam s = thin_solid<TypeParam>(rng);
        const double probe = round % 2 ? 0 : uniform(rng, 0, 1.5) * least_radius(s);
        Evaluated<TypeParam> solid(s);
        Vector about = to_eigen(s.center);
        if constexpr (requires { s.tube; })
            about += s.radius * to_eigen(s.axis).normalized().unitOrthogonal();
        const SmallLoop loop(rng, about + 0.5 * least_radius(s) * direction(rng), 0.004);
        const std::string where = "seed " + std::to_string(seed) + " round " + std::to_string(round);
        constexpr int steps = 6000;
        double sum = 0, gained = 0;
        bool outside = false;
        Vector p = loop.at(0), force = force_of(solid(p, probe));
        for (int i = 0; i < 2 * steps; ++i) {
            const Vector next = loop.at(2 * M_PI * (i + 1) / steps);
            const Contact c = solid(next, probe);
            const Vector now = force_of(c);
            const double lever = (next - to_eigen(s.center)).norm() + largest(s) + probe;
            const double bound = 1000 * ((next - p).norm() + (now.norm() / 1000 + lever) * 0.05);
            ASSERT_LE((now - force).norm(), 1.05 * bound + 1e-9) << where << " cycle " << i;
            worst = std::max(worst, (now - force).norm());
            sum += 0.5 * (now + force).dot(next - p);
            force = now;
            p = next;
            touched += c.height < 0;
            if (c.height >= 0) {  // between two times outside
                if (outside) gained = std::max(gained, sum);
                outside = true;
                sum = 0;
            }
        }
        EXPECT_LE(gained, 1e-5) << "J; " << where;
    }
    std::printf("largest step %.3g N\n", worst);
    EXPECT_GT(touched, 10'000);
}

}  // namespace solids_hold_tests
