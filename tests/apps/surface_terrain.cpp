// The true surface that knurl-surface renders and judges by: a bicubic B-spline, checked against an
// independent evaluation in long double (de Boor's recursion instead of the weights) and against brute
// force.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "surface/terrain.hpp"

namespace {

using surface::HeightGrid;
using surface::Terrain;

HeightGrid hills(unsigned seed, int rows = 30, int columns = 40) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> height(-2e-3, 2e-3);
    HeightGrid grid{.rows = rows, .columns = columns, .cell = 0.5e-3};
    for (int i = 0; i < rows * columns; ++i) grid.heights.push_back(height(random));
    return surface::smoothed(grid, 2.0);
}

/// Cubic B-spline basis on integer knots by the Cox-de Boor recursion; support [i - 2, i + 2].
long double basis(int degree, long double knot, long double x) {
    if (degree == 0) return x >= knot && x < knot + 1 ? 1 : 0;
    return (x - knot) / degree * basis(degree - 1, knot, x) +
           (knot + degree + 1 - x) / degree * basis(degree - 1, knot + 1, x);
}

long double reference_height(const HeightGrid& grid, long double x, long double y) {
    const long double u = x / grid.cell + 0.5L * (grid.columns - 1);
    const long double v = 0.5L * (grid.rows - 1) - y / grid.cell;
    long double sum = 0;
    for (int r = static_cast<int>(std::floor(v)) - 2; r <= static_cast<int>(std::floor(v)) + 3; ++r)
        for (int c = static_cast<int>(std::floor(u)) - 2; c <= static_cast<int>(std::floor(u)) + 3; ++c) {
            const int rr = std::clamp(r, 0, grid.rows - 1), cc = std::clamp(c, 0, grid.columns - 1);
            sum += basis(3, r - 2, v) * basis(3, c - 2, u) *
                   static_cast<long double>(grid.heights[static_cast<std::size_t>(rr * grid.columns + cc)]);
        }
    return sum;
}

TEST(Terrain, HeightIsTheBicubicBSplineOfItsControlHeights) {
    const HeightGrid grid = hills(1);
    const Terrain terrain(grid);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> x(-13e-3, 13e-3), y(-10e-3, 10e-3);  // beyond the border too
    for (int i = 0; i < 3000; ++i) {
        const double px = x(random), py = y(random);
        EXPECT_NEAR(terrain.height(px, py), static_cast<double>(reference_height(grid, px, py)), 1e-16)
            << px << ' ' << py;
    }
}

TEST(Terrain, DerivativesAreThoseOfTheHeight) {
    const HeightGrid grid = hills(3);
    const Terrain terrain(grid);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> x(-9e-3, 9e-3), y(-7e-3, 7e-3);
    const long double h = 1e-6L;
    for (int i = 0; i < 300; ++i) {
        const long double a = x(random), b = y(random);
        const auto f = [&](long double dx, long double dy) { return reference_height(grid, a + dx, b + dy); };
        const auto jet = terrain.jet(static_cast<double>(a), static_cast<double>(b));
        EXPECT_NEAR(jet.fx, static_cast<double>((f(h, 0) - f(-h, 0)) / (2 * h)), 1e-5);
        EXPECT_NEAR(jet.fy, static_cast<double>((f(0, h) - f(0, -h)) / (2 * h)), 1e-5);
        EXPECT_NEAR(jet.fxx, static_cast<double>((f(h, 0) - 2 * f(0, 0) + f(-h, 0)) / (h * h)), 0.5);
        EXPECT_NEAR(jet.fyy, static_cast<double>((f(0, h) - 2 * f(0, 0) + f(0, -h)) / (h * h)), 0.5);
        EXPECT_NEAR(jet.fxy, static_cast<double>((f(h, h) - f(h, -h) - f(-h, h) + f(-h, -h)) / (4 * h * h)),
                    0.5);
    }
}

TEST(Terrain, NeverLeavesTheRangeOfItsHeights) {
    const HeightGrid grid = hills(5);
    const Terrain terrain(grid);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> at(-20e-3, 20e-3);
    for (int i = 0; i < 10000; ++i) {
        const double height = terrain.height(at(random), at(random));
        EXPECT_GE(height, terrain.lowest() - 1e-18);
        EXPECT_LE(height, terrain.highest() + 1e-18);
    }
}

TEST(Terrain, FirstRowLiesInTheNorthAndFirstColumnInTheWest) {
    HeightGrid grid{.rows = 6, .columns = 6, .cell = 1e-3, .heights = std::vector<double>(36, 0.0)};
    grid.heights[0] = 1e-3;
    const Terrain terrain(grid);
    EXPECT_GT(terrain.height(-2.5e-3, 2.5e-3), 0.2e-3);
    EXPECT_EQ(terrain.height(2.5e-3, 2.5e-3), 0);
    EXPECT_EQ(terrain.height(-2.5e-3, -2.5e-3), 0);
}

TEST(Terrain, FootIsTheNearestPointOfTheSurface) {
    for (unsigned seed = 10; seed < 14; ++seed) {
        const HeightGrid grid = hills(seed);
        const Terrain terrain(grid);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> x(-8e-3, 8e-3), y(-6e-3, 6e-3), z(-3e-3, 3e-3);
        for (int i = 0; i < 40; ++i) {
            const Eigen::Vector3d p(x(random), y(random), z(random));
            const auto foot = terrain.foot(p);
            EXPECT_NEAR(foot.point.z(), terrain.height(foot.point.x(), foot.point.y()), 1e-17);

            // Stationary: the line from the foot to p is the normal there.
            const Eigen::Vector3d line = p - foot.point;
            EXPECT_LT(line.cross(foot.normal).norm(), 1e-11) << "seed " << seed << " case " << i;
            EXPECT_NEAR(line.dot(foot.normal), foot.distance, 1e-12);
            EXPECT_EQ(foot.distance < 0, p.z() < terrain.height(p.x(), p.y()));

            // Nearest of all: no point of a fine grid is nearer.
            double nearest = 1;
            for (int a = -160; a <= 160; ++a)
                for (int b = -160; b <= 160; ++b) {
                    const double gx = p.x() + a * 25e-6, gy = p.y() + b * 25e-6;
                    nearest = std::min(nearest, (Eigen::Vector3d(gx, gy, terrain.height(gx, gy)) - p).norm());
                }
            EXPECT_LE(std::abs(foot.distance), nearest + 1e-12) << "seed " << seed << " case " << i;
        }
    }
}

TEST(Terrain, FootOfAPointOnTheSurfaceIsThatPoint) {
    const Terrain terrain(hills(20));
    for (int i = 0; i < 50; ++i) {
        const double x = -8e-3 + i * 0.3e-3, y = 5e-3 - i * 0.2e-3;
        const auto foot = terrain.foot({x, y, terrain.height(x, y)});
        EXPECT_NEAR(foot.distance, 0, 1e-15);
        EXPECT_NEAR(foot.normal.dot(terrain.normal(x, y)), 1, 1e-12);
    }
}

TEST(Terrain, FarAwayTheFootIsStillAFiniteTangentPlane) {
    const Terrain terrain(hills(21));
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, -1, 0.5), Eigen::Vector3d(0, 0, -1)}) {
        const auto foot = terrain.foot(p);
        EXPECT_TRUE(foot.point.allFinite());
        EXPECT_NEAR(foot.normal.norm(), 1, 1e-12);
    }
}

TEST(Terrain, ASmoothedConstantStaysConstantAndAPlaneStaysAPlaneInside) {
    HeightGrid grid{.rows = 60, .columns = 60, .cell = 1e-3};
    for (int r = 0; r < 60; ++r)
        for (int c = 0; c < 60; ++c) grid.heights.push_back(0.3e-3 * c - 0.1e-3 * r);
    const auto smooth = surface::smoothed(grid, 3.0);
    for (int r = 15; r < 45; ++r)
        for (int c = 15; c < 45; ++c) {
            const auto i = static_cast<std::size_t>(r * 60 + c);
            EXPECT_NEAR(smooth.heights[i], grid.heights[i], 1e-15);
        }
}

TEST(Terrain, RefusesWhatIsNoSurface) {
    EXPECT_THROW(Terrain({.rows = 1, .columns = 9, .cell = 1e-3, .heights = std::vector<double>(9)}),
                 std::runtime_error);
    EXPECT_THROW(Terrain({.rows = 4, .columns = 4, .cell = 0, .heights = std::vector<double>(16)}),
                 std::runtime_error);
    EXPECT_THROW(Terrain({.rows = 4, .columns = 4, .cell = 1e-3, .heights = std::vector<double>(15)}),
                 std::runtime_error);
    EXPECT_THROW(Terrain({.rows = 4, .columns = 4, .cell = 1e-3, .heights = std::vector<double>(16, NAN)}),
                 std::runtime_error);
}

}  // namespace
