// The work of closed loops on a rough relief, by shading. With flat shading the hand gains nothing. Smooth
// shading turns the force away from the energy's gradient, so it gives and takes energy: this measures how
// much.
//
// KNURL_SEED: of relief and loops. KNURL_LONG: more loops, and a table by stiffness and depth.

#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include <knurl/geometry/height_field.hpp>

#include "shape_tools.hpp"

namespace shading_loops_tests {
namespace {

using knurl::HeightField;
using knurl::Scene;
using knurl::Shading;
using knurl::Shape;
using knurl::test::Rng;
using Vector = Eigen::Vector3d;

constexpr int steps = 20'000;

std::uint64_t seed() {
    const char* asked = std::getenv("KNURL_SEED");
    return asked ? std::strtoull(asked, nullptr, 10) : 1;
}

/// 4 cm across, with cells of 1 mm, about the origin: independent random heights up to +-`relief` (m).
HeightField rough(Rng& rng, double relief) {
    constexpr std::uint32_t n = 41;
    std::vector<float> heights(std::size_t{n} * n);
    for (float& h : heights) h = static_cast<float>(knurl::test::uniform(rng, -relief, relief));
    return HeightField(heights,
                       {.columns = n, .rows = n, .dx = 1e-3, .dy = 1e-3, .corner = {-0.02, -0.02, 0}});
}

/// A smooth closed curve some millimetres across, up and down by a third of `depth` (m) about that depth.
knurl::test::SmallLoop loop_at(Rng& rng, double depth) {
    knurl::test::SmallLoop loop(
        rng, {knurl::test::uniform(rng, -0.008, 0.008), knurl::test::uniform(rng, -0.008, 0.008), -depth},
        0.0015);
    double height = 0;
    for (int h = 0; h < 3; ++h) height += std::abs(loop.a[h].z()) + std::abs(loop.b[h].z());
    for (int h = 0; h < 3; ++h) loop.a[h].z() *= depth / 3 / height, loop.b[h].z() *= depth / 3 / height;
    return loop;
}

struct Works {
    double most = -HUGE_VAL, least = HUGE_VAL, sum_of_sizes = 0;  // J, on the hand
    int loops = 0;
    void add(double work) {
        most = std::max(most, work), least = std::min(least, work);
        sum_of_sizes += std::abs(work);
        ++loops;
    }
};

/// The work of the second lap; the hand came down from above before the first.
double work(const HeightField& field, Shading shading, double stiffness, const knurl::test::SmallLoop& loop) {
    Scene scene = knurl::test::make_scene();
    scene.set_asset(1, &field);
    EXPECT_TRUE(scene.add({0, 1}, Shape{.asset = 1, .shading = shading, .stiffness = stiffness}));
    scene.settle();
    const auto force = [&](const Vector& p, const Vector& = Vector::Zero()) {
        return Vector(scene.evaluate(knurl::test::at(p), knurl::test::dt).force);
    };
    for (int i = 100; i > 0; --i) force(loop.at(0) + Vector(0, 0, 1e-4 * i));
    knurl::test::work_along(loop, steps, force);
    return knurl::test::work_along(loop, steps, force);
}

Works works(Shading shading, double stiffness, double depth, double relief, int loops) {
    Rng rng(seed());
    const HeightField field = rough(rng, relief);
    Works all;
    for (int i = 0; i < loops; ++i) all.add(work(field, shading, stiffness, loop_at(rng, depth)));
    return all;
}

constexpr double relief = 0.2e-3;  // m

TEST(ShadingLoops, FlatShadingGivesTheHandNothing) {
    for (const double depth : {0.5e-3, 2e-3}) {
        const Works flat = works(Shading::flat, 1000, depth, relief, knurl::test::long_form() ? 200 : 10);
        EXPECT_LE(flat.most, 1e-8) << "J, at " << depth << " m, KNURL_SEED=" << seed();
        EXPECT_GT(flat.loops, 0);
    }
}

TEST(ShadingLoops, SmoothShadingGivesAndTakesInProportionToTheStiffness) {
    const int loops = knurl::test::long_form() ? 200 : 10;
    const Works soft = works(Shading::smooth, 250, 1e-3, relief, loops),
                hard = works(Shading::smooth, 1000, 1e-3, relief, loops);
    EXPECT_GT(hard.most, 1e-6) << "J: this relief says nothing, KNURL_SEED=" << seed();
    EXPECT_NEAR(hard.most, 4 * soft.most, 1e-6 * hard.most) << "KNURL_SEED=" << seed();
    EXPECT_NEAR(hard.least, 4 * soft.least, 1e-6 * std::abs(hard.least)) << "KNURL_SEED=" << seed();
}

TEST(ShadingLoops, TheTableOfTheReadme) {
    const int loops = knurl::test::long_form() ? 100 : 1;
    std::printf("KNURL_SEED=%llu, 1000 N/m, %d loops, uJ: mean of sizes, most gained, most lost\n",
                static_cast<unsigned long long>(seed()), loops);
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        for (const double height : {0.05e-3, 0.2e-3}) {
            for (const double depth : {0.5e-3, 1e-3, 2e-3, 4e-3}) {
                const Works w = works(shading, 1000, depth, height, loops);
                if (shading == Shading::flat) {
                    EXPECT_LE(w.most, 1e-8) << "J, KNURL_SEED=" << seed();
                }
                std::printf("%s, relief +-%.2f mm, depth %.1f mm: %10.4f %10.4f %10.4f\n",
                            shading == Shading::flat ? "flat  " : "smooth", height * 1e3, depth * 1e3,
                            1e6 * w.sum_of_sizes / w.loops, 1e6 * w.most, 1e6 * w.least);
            }
        }
    }
}

}  // namespace
}  // namespace shading_loops_tests
