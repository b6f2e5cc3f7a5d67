// Reliefs against their formula in long double, as the gradient of an energy, and for any legal parameters.

#include <numbers>

#include <gtest/gtest.h>

#include <knurl/reps/texture.hpp>

#include "random_planes.hpp"

using namespace knurl;
using namespace knurl::test;

namespace texture_tests {
namespace {

using Vector = Eigen::Vector3d;
constexpr Real pi = std::numbers::pi_v<Real>;

Texture random_texture(Rng& rng) {
    return {.amplitude = scale(rng, 1e-6, 1e-3),
            .wavelength = scale(rng, 2e-4, 0.05),
            .direction = to_plain(scale(rng, 1e-6, 1e6) * direction(rng)),
            .origin = to_plain(scale(rng, 1e-3, 1) * direction(rng)),
            .pattern = static_cast<TexturePattern>(between(rng, 0, 2))};
}

/// A f at p, from the manual's text.
Real height(const Texture& texture, const RealVector& p, const RealVector& n) {
    const RealVector q = p - to_eigen(texture.origin).cast<Real>();
    const RealVector u = to_eigen(texture.direction).cast<Real>().normalized();
    const auto wave = [&](Real way) { return std::cos(2 * pi * way / texture.wavelength); };
    switch (texture.pattern) {
        case TexturePattern::ridges:
            return texture.amplitude * wave(q.dot(u));
        case TexturePattern::grid:
            return texture.amplitude * (wave(q.dot(u)) + wave(q.dot(n.cross(u).normalized()))) / 2;
        case TexturePattern::rings:
            return texture.amplitude * wave((q - n.dot(q) * n).norm());
    }
    return 0;
}

}  // namespace

TEST(Texture, HasItsFormulasHeightAndSlope) {
    const std::uint64_t seed = 61;
    Rng rng(seed);
    for (int i = 0; i < (long_form() ? 1'000'000 : 20'000); ++i) {
        const Texture texture = random_texture(rng);
        const Vector n = direction(rng), p = scale(rng, 1e-4, 10) * direction(rng);
        const Relief got = relief(texture, p, n, Vector::Zero());
        const RealVector rp = p.cast<Real>(), rn = n.cast<Real>().normalized();
        const Real steepest = 2 * pi * texture.amplitude / texture.wavelength;
        const Real reach = p.norm() + to_eigen(texture.origin).norm() + texture.wavelength;
        // The height cannot be more exact than p itself on the steepest slope.
        ASSERT_NEAR(double(got.height - height(texture, rp, rn)), 0, double(1e-12L * steepest * reach))
            << "seed " << seed << " case " << i;
        ASSERT_NEAR(got.slope.dot(n), 0, 1e-12 * double(steepest)) << "along the surface";
        const RealVector a = n.unitOrthogonal().cast<Real>(), b = rn.cross(a);
        const Real step = 1e-6L * texture.wavelength, curve = steepest * 2 * pi / texture.wavelength;
        for (const RealVector& way : {a, b}) {
            const Real rise =
                (height(texture, rp + step * way, rn) - height(texture, rp - step * way, rn)) / (2 * step);
            ASSERT_NEAR(double(got.slope.cast<Real>().dot(way) - rise), 0,
                        double(1e-12L * curve * reach + 1e-9L * steepest))
                << "seed " << seed << " case " << i << " pattern " << static_cast<int>(texture.pattern);
        }
    }
}

TEST(Texture, TheContactsForceIsTheGradientOfAnEnergy) {
    // U = k (depth + A f)^2 / 2 over the floor z = 0, all the work of a closed loop comes back.
    const std::uint64_t seed = 62;
    Rng rng(seed);
    const double k = 1500;
    for (int run = 0; run < 200; ++run) {
        Texture texture = random_texture(rng);
        texture.wavelength = scale(rng, 1e-3, 1e-2);
        texture.amplitude = scale(rng, 1e-6, 5e-5);
        texture.direction = {uniform(rng, -1, 1), uniform(rng, 0.1, 1), 0};
        const Vector up = Vector::UnitZ();
        const auto force = [&](const Vector& p) -> Vector {
            const Relief here = relief(texture, p, up, Vector::Zero());
            const double n = std::max(0.0, k * (here.height - p.z()));
            return n * up + texture_force(texture, here, n, {});
        };
        const Vector center(uniform(rng, -1, 1) * 0.01, uniform(rng, -1, 1) * 0.01, -1e-3);
        double work = 0;
        const int steps = 4000;
        const auto point = [&](double i) -> Vector {
            const double angle = 2 * double(pi) * i / steps;
            return center +
                   Vector(3e-3 * std::cos(angle), 2e-3 * std::sin(angle), 5e-4 * std::sin(3 * angle));
        };
        for (int i = 0; i < steps; ++i) {  // Simpson
            const Vector a = point(i), b = point(i + 1);
            work += (force(a) + 4 * force(0.5 * (a + b)) + force(b)).dot(b - a) / 6;
        }
        ASSERT_LE(std::abs(work), 1e-8) << "seed " << seed << " run " << run;
    }
}

TEST(Texture, IsCarriedByTheSurface) {
    const Texture texture{.amplitude = 1e-4, .wavelength = 2e-3, .direction = {1, 2, 0}};
    const Vector p(0.0123, 0.0456, 0), shift(0.004, -0.003, 0);
    const Relief there = relief(texture, p + shift, Vector::UnitZ(), shift);
    const Relief here = relief(texture, p, Vector::UnitZ(), Vector::Zero());
    EXPECT_NEAR(there.height, here.height, 1e-16);
    EXPECT_TRUE(there.slope.isApprox(here.slope, 1e-10));
}

TEST(Texture, AnOriginLiesOnAPeakAndOffItThePushIsOutwards) {
    for (const TexturePattern pattern :
         {TexturePattern::ridges, TexturePattern::grid, TexturePattern::rings}) {
        const Texture texture{
            .amplitude = 1e-4, .wavelength = 2e-3, .origin = {0.1, 0.2, 0}, .pattern = pattern};
        const Relief peak = relief(texture, {0.1, 0.2, 0}, Vector::UnitZ(), Vector::Zero());
        EXPECT_EQ(peak.height, 1e-4);
        EXPECT_EQ(peak.slope.norm(), 0);
        const Relief beside = relief(texture, {0.1003, 0.2, 0}, Vector::UnitZ(), Vector::Zero());
        EXPECT_GT(texture_force(texture, beside, 1, {}).x(), 0) << "down the slope";
    }
}

TEST(Texture, RidgesStayInThePlaceWhereTheSurfaceTurns) {
    // A local tangent plane turns with every update. The relief is fixed in the world, and does not move
    // under the tip.
    const Texture texture{.amplitude = 1e-4, .wavelength = 1e-3};
    const Vector p(0.25, 0.1, 0);
    const double flat = relief(texture, p, Vector::UnitZ(), Vector::Zero()).height;
    const double turned = relief(texture, p, Vector(0.1, 0, 1).normalized(), Vector::Zero()).height;
    EXPECT_EQ(flat, turned);
}

TEST(Texture, FadesOutWhereItPassesTooFastForTheServo) {
    const Texture texture{.wavelength = 1e-3};
    const Limits limits{.period = 1e-3};  // 1 / (8 T) = 125 Hz, 1 / (4 T) = 250 Hz
    EXPECT_EQ(texture_gain(texture, 0, limits), 1);
    EXPECT_EQ(texture_gain(texture, 0.125, limits), 1);
    EXPECT_NEAR(texture_gain(texture, 0.1875, limits), 0.5, 1e-15);
    EXPECT_EQ(texture_gain(texture, 0.25, limits), 0);
    EXPECT_EQ(texture_gain(texture, 1e12, limits), 0);
    EXPECT_EQ(texture_gain(texture, 0.25, {.period = 1e-4}), 1) << "a faster servo shows more";
}

TEST(Texture, ItsSidewaysStiffnessIsAtMostTheDevices) {
    const std::uint64_t seed = 63;
    Rng rng(seed);
    for (int run = 0; run < 2000; ++run) {
        const Texture texture = random_texture(rng);
        const Limits limits{.max_stiffness = scale(rng, 100, 5000)};
        const double n = scale(rng, 0.01, 10), step = 1e-5 * texture.wavelength;
        const Vector up = direction(rng), p = 0.1 * direction(rng);
        const Vector way = up.unitOrthogonal();
        const auto push = [&](const Vector& at) {
            return texture_force(texture, relief(texture, at, up, Vector::Zero()), n, limits);
        };
        const double stiffness = (push(p + step * way) - push(p - step * way)).dot(way) / (-2 * step);
        ASSERT_LE(std::abs(stiffness), limits.max_stiffness * (1 + 1e-6))
            << "seed " << seed << " run " << run;
    }
    const Texture gentle{.amplitude = 1e-5, .wavelength = 1e-2};
    const Relief somewhere = relief(gentle, {0.001, 0, 0}, Vector::UnitZ(), Vector::Zero());
    EXPECT_TRUE(
        texture_force(gentle, somewhere, 2, {.max_stiffness = 1000}).isApprox(-2 * somewhere.slope, 1e-15))
        << "below that it is the formula";
}

TEST(Texture, IsFiniteForAnyLegalParameters) {
    const std::uint64_t seed = 64;
    Rng rng(seed);
    for (int i = 0; i < (long_form() ? 1'000'000 : 50'000); ++i) {
        Texture texture{.amplitude = between(rng, 0, 3) ? scale(rng, 1e-9, 1) : 1,
                        .wavelength = between(rng, 0, 3) ? scale(rng, 6e-7, 1e3) : 6e-7,
                        .direction = to_plain(scale(rng, 1e-6, 1e9) * direction(rng)),
                        .origin = to_plain(scale(rng, 1e-9, 1e9) * direction(rng)),
                        .pattern = static_cast<TexturePattern>(between(rng, 0, 2))};
        const Vector n = between(rng, 0, 3) ? direction(rng) : to_eigen(texture.direction).normalized();
        const Vector p =
            between(rng, 0, 3) ? Vector(scale(rng, 1e-9, 1e12) * direction(rng)) : to_eigen(texture.origin);
        const Relief got = relief(texture, p, n, scale(rng, 1e-9, 1e9) * direction(rng));
        ASSERT_LE(std::abs(got.height), texture.amplitude) << "seed " << seed << " case " << i;
        ASSERT_LE(got.slope.norm(), 2 * double(pi) * texture.amplitude / texture.wavelength * (1 + 1e-12));
        const Limits limits{.max_stiffness = scale(rng, 1, 1e9)};
        ASSERT_TRUE(texture_force(texture, got, scale(rng, 1e-9, 1e21), limits).allFinite());
        const double gain = texture_gain(texture, scale(rng, 1e-9, 1e12), {.period = scale(rng, 1e-5, 0.05)});
        ASSERT_TRUE(gain >= 0 && gain <= 1);
    }
}

}  // namespace texture_tests
