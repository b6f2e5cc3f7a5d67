// A height field gives the same contact as the mesh of the same triangles, in a fiftieth of the memory.

#include <cstdlib>
#include <cstring>
#include <memory>

#include <malloc.h>

#include <knurl/geometry/height_field.hpp>

#include "paths.hpp"
#include "walk_tools.hpp"

namespace knurl::test::height_field_tests {
namespace {

using Eigen::Vector3d;

struct Field {
    std::vector<float> heights;
    HeightGrid grid;
    MadeMesh shape;
};

Field terrain(std::uint32_t columns, std::uint32_t rows, std::uint64_t seed, double cell = 1e-3) {
    Field f{.heights = {}, .grid = {columns, rows, cell, cell * 1.25, {0.3, -0.2, 0.1}}, .shape = {}};
    Rng rng(seed);
    double phase[12];
    for (double& p : phase) p = between(rng, 0, 2 * M_PI);
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            double z = 0;
            for (int k = 0; k < 12; ++k)
                z += cell * 4 / (k + 1) *
                     std::sin((k + 1) * (0.11 * i * std::cos(phase[k]) + 0.13 * j) + phase[k]);
            f.heights.push_back(static_cast<float>(z));
        }
    }
    // The same corners as in the field, which stores heights as floats relative to their middle.
    const auto [least, most] = std::minmax_element(f.heights.begin(), f.heights.end());
    const double middle = (double{*least} + double{*most}) / 2;
    f.shape.name = "terrain";
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double z = double{static_cast<float>(double{f.heights[j * columns + i]} - middle)} + middle;
            f.shape.vertices.push_back({f.grid.corner.x() + i * f.grid.dx, f.grid.corner.y() + j * f.grid.dy,
                                        f.grid.corner.z() + z});
        }
    }
    for (std::uint32_t j = 0; j + 1 < rows; ++j) {
        for (std::uint32_t i = 0; i + 1 < columns; ++i) {
            const std::uint32_t a = j * columns + i, b = a + 1, c = b + columns, d = a + columns;
            f.shape.triangles.push_back({a, b, c});
            f.shape.triangles.push_back({a, c, d});
        }
    }
    return f;
}

TEST(HeightField, IsFeltAsTheMeshOfItsTriangles) {
    const std::uint64_t seed = 8;
    const Field f = terrain(150, 90, seed);
    const HeightField field(f.heights, f.grid);
    const auto mesh = build(f.shape);
    Hands hands(f.shape, seed);
    std::vector<Hand> all;
    for (int i = 0; i < 12; ++i) {
        all.push_back(hands.stroke());
        all.push_back(hands.graze());
        all.push_back(hands.poke());
        all.push_back(hands.into_a_corner());
    }
    for (const double radius : {0.0, 0.0021}) {
        std::size_t touching = 0, apart = 0;
        for (const Hand& hand : all) {
            Proxy on_field, on_mesh;
            for (const auto& p : hand) {
                const Vector3d h(p[0], p[1], p[2]);
                Foot a, b;
                Work work, mesh_work;
                const bool touches = follow(field, on_field, h, radius, a, work);
                const bool other = follow(*mesh, on_mesh, h, radius, b, mesh_work);
                ASSERT_LE(work.nodes, max_nodes);
                touching += touches;
                if (touches != other) {
                    ++apart;
                    EXPECT_LT(touches ? a.depth : b.depth, 1e-9) << "seed " << seed;
                } else if (touches) {
                    if ((a.point - b.point).norm() > 1e-9) ++apart;  // two places may be equally right
                    EXPECT_NEAR(a.depth, b.depth, 1e-9) << "seed " << seed;
                }
            }
        }
        EXPECT_GT(touching, 10000u);
        EXPECT_LE(apart, touching / 1000) << "seed " << seed;
    }
}

TEST(HeightField, TakesTwoBytesATriangle) {
    const Field f = terrain(403, 344, 1);
    const HeightField field(f.heights, f.grid);
    EXPECT_EQ(field.faces(), 402u * 343 * 2);
    EXPECT_LE(double(field.bytes()), 2.1 * double(field.faces()));
    EXPECT_LE(double(field.block_bytes()), 2.1 * double(field.faces())) << "as the servo maps it";
    const auto allocated = [] {  // 0 with a sanitizer's allocator
        const struct mallinfo2 all = mallinfo2();
        return all.uordblks + all.hblkhd;
    };
    const std::size_t before = allocated();
    const HeightField counted(f.heights, f.grid);
    EXPECT_LE(double(allocated() - before), 2.1 * double(field.faces()));
}

struct Block {
    explicit Block(std::size_t bytes)
        : memory(static_cast<std::byte*>(std::aligned_alloc(64, bytes)), &std::free), size(bytes) {}
    std::shared_ptr<std::byte> memory;
    std::size_t size;
    std::span<std::byte> all() { return {memory.get(), size}; }
};

Block written(const HeightField& field) {
    Block block(field.block_bytes());
    field.write(block.all());
    return block;
}

TEST(HeightField, IsTheSameInAnotherProcess) {
    const std::uint64_t seed = 5;
    const Field f = terrain(70, 50, seed);
    const HeightField field(f.heights, f.grid, 3);
    std::unique_ptr<Asset> again;
    {
        Block block = written(field);
        again = asset_of(block.all(), block.memory);
        EXPECT_EQ(block.memory.use_count(), 2) << "it lies where it was written";
    }
    ASSERT_EQ(again->kind, AssetKind::height_field);
    EXPECT_EQ(again->faces(), field.faces());
    EXPECT_EQ(again->bytes(), field.bytes());
    EXPECT_EQ(again->low, field.low);
    EXPECT_EQ(again->high, field.high);
    Proxy one, other;
    int touching = 0;
    Hands hands(f.shape, seed);
    for (int stroke = 0; stroke < 5; ++stroke) {
        for (const auto& at : hands.stroke()) {
            Foot a, b;
            Work work;
            const Vector3d hand(at.data());
            const bool first = follow(field, one, hand, 0, a, work),
                       second = follow(*again, other, hand, 0, b, work);
            ASSERT_EQ(first, second);
            ASSERT_EQ(std::memcmp(&one, &other, sizeof one), 0);
            if (!first) continue;
            ++touching;
            EXPECT_EQ(a.depth, b.depth);
            EXPECT_EQ(a.triangle, b.triangle);
            EXPECT_EQ(b.material, 3);
        }
    }
    EXPECT_GT(touching, 100) << "seed " << seed;
}

TEST(HeightField, ABlockOfAnotherSizeOrBuildIsRefused) {
    const Field f = terrain(30, 20, 6);
    const HeightField field(f.heights, f.grid);
    Block block = written(field);
    EXPECT_THROW(asset_of(block.all().first(block.size - 64), block.memory), HeightFieldError);
    EXPECT_THROW(HeightField(block.all().first(16), block.memory), HeightFieldError);
    EXPECT_THROW(asset_of(block.all().subspan(64), block.memory), MeshError);
    EXPECT_THROW(field.write(block.all().first(128)), HeightFieldError);
    // Counts whose product overflows 32 bits to a small number.
    for (const auto& [columns, rows] : {std::pair{0xfffffff0u, 0xffffffffu}, {0xffffffffu, 0xffffffffu}}) {
        Block spoiled = written(field);
        std::memcpy(spoiled.memory.get() + 8, &columns, 4);
        std::memcpy(spoiled.memory.get() + 12, &rows, 4);
        EXPECT_THROW(HeightField(spoiled.all(), spoiled.memory), HeightFieldError);
    }
    for (std::size_t at = 0; at < 16; at += 4) {  // the magic word and the counts
        Block spoiled = written(field);
        spoiled.memory.get()[at + 2] ^= std::byte{0x40};
        EXPECT_THROW(HeightField(spoiled.all(), spoiled.memory), HeightFieldError) << at;
    }
}

TEST(HeightField, KeepsToItsBudget) {
    const Field f = terrain(30, 20, 6);
    const std::size_t need = HeightField(f.heights, f.grid).bytes();
    EXPECT_NO_THROW(HeightField(f.heights, f.grid, 0, need));
    try {
        HeightField(f.heights, f.grid, 0, need - 1);
        FAIL() << "it was built";
    } catch (const HeightFieldError& error) {
        EXPECT_NE(std::string(error.what()).find(std::to_string(need)), std::string::npos) << error.what();
    }
}

TEST(HeightField, StaysWithinTheLimitsWhereverTheHandIsThrownTo) {
    const Field f = terrain(700, 600, 2);
    const HeightField field(f.heights, f.grid);
    Rng rng(3);
    for (const double radius : {0.0, 0.01, 0.3}) {
        Proxy proxy;
        Foot foot;
        Vector3d hand = field.high;
        for (int i = 0; i < 3000; ++i) {
            if (i % 6 == 0) {
                for (int k = 0; k < 3; ++k) hand[k] = between(rng, field.low[k] - 0.1, field.high[k] + 0.1);
            }
            Work work;
            const bool touches = follow(field, proxy, hand, radius, foot, work);
            ASSERT_LE(work.nodes, max_nodes);
            ASSERT_LE(work.faces, max_walk_faces);
            ASSERT_LE(work.sweeps, max_sweeps);
            if (touches) {
                ASSERT_TRUE(foot.point.allFinite() && foot.normal.allFinite() && foot.depth >= 0);
            }
        }
    }
}

TEST(HeightField, SlipsOffItsRim) {
    const std::vector<float> flat(20 * 10, 0.0f);
    const HeightField field(flat, {20, 10, 0.001, 0.001, {0, 0, 0}});
    Proxy proxy;
    Foot foot;
    Work work;
    EXPECT_FALSE(follow(field, proxy, {0.018, 0.0042, 0.002}, 0, foot, work));
    ASSERT_TRUE(follow(field, proxy, {0.018, 0.0042, -0.001}, 0, foot, work));
    EXPECT_NEAR(foot.depth, 0.001, 1e-15);
    EXPECT_TRUE(follow(field, proxy, {0.01899, 0.0042, -0.001}, 0, foot, work));
    EXPECT_FALSE(follow(field, proxy, {0.01901, 0.0042, -0.001}, 0, foot, work));
}

TEST(HeightField, RefusesWhatIsNone) {
    const std::vector<float> four(4, 0.0f);
    EXPECT_THROW(HeightField({}, HeightGrid{}), HeightFieldError);
    EXPECT_THROW(HeightField(four, {1, 4, 1, 1, {0, 0, 0}}), HeightFieldError);
    EXPECT_THROW(HeightField(four, {2, 3, 1, 1, {0, 0, 0}}), HeightFieldError);
    EXPECT_THROW(HeightField(four, {2, 2, 0, 1, {0, 0, 0}}), HeightFieldError);
    EXPECT_THROW(HeightField(four, {2, 2, 1, NAN, {0, 0, 0}}), HeightFieldError);
    EXPECT_THROW(HeightField(four, {2, 2, 1, 1e-300, {0, 0, 0}}), HeightFieldError);
    EXPECT_THROW(HeightField(four, {2, 2, 1, 1, {0, 0, INFINITY}}), HeightFieldError);
    for (int k = 0; k < 3; ++k) {
        HeightGrid nowhere{2, 2, 1, 1, {0, 0, 0}};
        nowhere.corner[k] = NAN;
        EXPECT_THROW(HeightField(four, nowhere), HeightFieldError) << k;
    }
    EXPECT_THROW(HeightField(std::vector<float>{0, 0, NAN, 0}, {2, 2, 1, 1, {0, 0, 0}}), HeightFieldError);
    EXPECT_NO_THROW(HeightField(four, {2, 2, 1, 1, {0, 0, 0}}));
    EXPECT_NO_THROW(HeightField(four, {2, 2, 1e-9, 1e-9, {0, 0, 0}}));
}

}  // namespace
}  // namespace knurl::test::height_field_tests
