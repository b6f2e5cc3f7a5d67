// The force of the representations that a way of rendering has sent; and the relief that is sent whole.

#include <cmath>

#include <gtest/gtest.h>

#include <knurl/geometry/mesh.hpp>

#include "surface/stated.hpp"
#include "surface/terrain_whole.hpp"

namespace surface_stated_tests {
namespace {

using surface::Recording;
using surface::Stated;

constexpr std::int64_t ms = 1'000'000;

/// A servo that reads at k ms and writes 0.1 ms later; the hand is 1 mm below z = 0.
Recording recording(int cycles) {
    Recording r;
    for (int i = 0; i < cycles; ++i) {
        r.cycles.push_back(
            {.number = static_cast<std::uint64_t>(i), .t = i * 1e-3, .position = {0, 0, -1e-3}});
        r.read_ns.push_back(i * ms);
        r.write_ns.push_back(i * ms + ms / 10);
    }
    return r;
}

knurl::Plane plane(double offset) {
    return {.offset = offset, .stiffness = 1000};
}

TEST(Stated, IsInForceFromTheFirstCycleAfterItsCommitAndAtOnce) {
    Stated stated;
    stated.say(0, 0, {plane(0)});
    stated.say(10 * ms + 200'000, 10 * ms + 300'000, {plane(1e-3)});            // between two cycles
    stated.say(20 * ms + 50'000, 20 * ms + 200'000, {plane(0), plane(-1e-3)});  // while one worked
    stated.say(30 * ms - 100'000, 30 * ms + 10'000, {plane(2e-3)});             // while one read
    stated.say(35 * ms - 1000, 35 * ms - 500, {});
    const auto force = stated.force(recording(40), {});
    ASSERT_EQ(force.size(), 40u);
    const auto z = [&](std::size_t i) { return force[i].z(); };
    EXPECT_NEAR(z(0), 1, 1e-9);
    EXPECT_NEAR(z(10), 1, 1e-9);
    EXPECT_NEAR(z(11), 2, 1e-9) << "no fade";
    EXPECT_NEAR(z(19), 2, 1e-9);
    EXPECT_TRUE(std::isnan(z(20))) << "nobody knows whether the cycle had it";
    EXPECT_NEAR(z(21), 1, 1e-9);
    EXPECT_TRUE(std::isnan(z(30)));
    EXPECT_NEAR(z(31), 3, 1e-9);
    EXPECT_EQ(z(35), 0);
    EXPECT_TRUE(Stated().force(recording(3), {}).empty()) << "nothing was said";
}

TEST(Stated, KeepsToTheDevicesLimits) {
    Stated stated;
    stated.say(0, 0, {plane(10e-3)});
    EXPECT_NEAR(stated.force(recording(1), {.max_force = 8}).front().z(), 8, 1e-9);
    EXPECT_NEAR(stated.force(recording(1), {.max_stiffness = 500}).front().z(), 5.5, 1e-9);
}

TEST(Whole, TheFieldIsTheMesh) {
    surface::HeightGrid grid{.rows = 30, .columns = 40, .cell = 0.5e-3};
    for (int r = 0; r < grid.rows; ++r)
        for (int c = 0; c < grid.columns; ++c)  // steeper to the north and to the east
            grid.heights.push_back(1e-3 * std::sin(0.02 * c * c) + 2e-3 * std::cos(0.01 * r * r));
    const surface::Terrain terrain(grid);
    const surface::TerrainMesh triangles(terrain);
    const surface::TerrainField heights(terrain);
    const knurl::Mesh mesh(triangles.triangles());
    const knurl::HeightField field(heights.heights, heights.grid);
    Recording stroke = recording(2000);
    for (std::size_t i = 0; i < stroke.cycles.size(); ++i) {
        const double x = 9e-3 * std::sin(0.013 * static_cast<double>(i)),
                     y = 6e-3 * std::cos(0.017 * static_cast<double>(i));
        stroke.cycles[i].position = {x, y, terrain.height(x, y) - (i < 10 ? -1e-3 : 0.3e-3)};
    }
    Stated stated;
    stated.say(0, 0, {knurl::Shape{.asset = 1, .stiffness = 1000}});
    const auto a = stated.force(stroke, {}, &mesh), b = stated.force(stroke, {}, &field);
    int touching = 0, apart = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        touching += b[i].norm() > 0.05;
        apart += (a[i] - b[i]).norm() > 1e-4;  // N; possible where two places are equally near
    }
    EXPECT_GT(touching, 1900);
    EXPECT_LE(apart, 4);
}

}  // namespace

}  // namespace surface_stated_tests
