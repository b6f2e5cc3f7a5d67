// A mesh as one block of memory: a mesh that another process has built is the same mesh.

#include <cstring>
#include <memory>

#include <generators.hpp>
#include <gtest/gtest.h>
#include <paths.hpp>

#include <knurl/geometry/mesh.hpp>
#include <knurl/geometry/proxy.hpp>

namespace knurl {
namespace {

struct Block {
    explicit Block(std::size_t bytes)
        : memory(static_cast<std::byte*>(std::aligned_alloc(64, bytes)), &std::free), size(bytes) {}
    std::shared_ptr<std::byte> memory;
    std::size_t size;
    std::span<std::byte> all() { return {memory.get(), size}; }
};

class AnyBlock : public testing::TestWithParam<bool> {
  protected:
    const test::MadeMesh made = test::noisy_sphere(4, 0.1, 7);
    const Mesh mesh{{.vertices = made.vertices, .triangles = made.triangles}, {.exact = GetParam()}};
    Block written() {
        Block block(mesh.block_bytes());
        mesh.write(block.all());
        return block;
    }
};
INSTANTIATE_TEST_SUITE_P(Corners, AnyBlock, testing::Bool());

TEST_P(AnyBlock, IsTheSameMeshToTheBit) {
    Block block = written();
    const Mesh again(block.all(), block.memory);
    EXPECT_EQ(again.faces(), mesh.faces());
    EXPECT_EQ(again.bytes(), mesh.bytes());
    EXPECT_EQ(again.low, mesh.low);
    EXPECT_EQ(again.high, mesh.high);
    EXPECT_EQ(again.notes().triangles_given, mesh.notes().triangles_given);
    Proxy one, other;
    int touching = 0;
    test::Hands hands(made, 3);
    for (const auto& at : hands.stroke()) {
        Foot a, b;
        Work work;
        const Eigen::Vector3d hand(at.data());
        const bool first = follow(mesh, one, hand, 0, a, work),
                   second = follow(again, other, hand, 0, b, work);
        ASSERT_EQ(first, second);
        ASSERT_EQ(std::memcmp(&one, &other, sizeof one), 0);
        if (!first) continue;
        ++touching;
        EXPECT_EQ(a.depth, b.depth);
        EXPECT_EQ(a.triangle, b.triangle);
    }
    EXPECT_GT(touching, 100);
}

TEST_P(AnyBlock, OutlivesTheOneThatItCameFrom) {
    std::unique_ptr<Mesh> again;
    {
        Block block = written();
        again = std::make_unique<Mesh>(block.all(), block.memory);
    }
    Proxy proxy;
    Foot foot;
    Work work;
    follow(*again, proxy, {0, 0, 0.3}, 0, foot, work);
    EXPECT_TRUE(follow(*again, proxy, {0, 0, 0.05}, 0, foot, work));
}

TEST_P(AnyBlock, OfAnotherSizeOrBuildIsRefused) {
    Block block = written();
    EXPECT_THROW(Mesh(block.all().first(block.size - 64), block.memory), MeshError);
    EXPECT_THROW(Mesh(block.all().first(16), block.memory), MeshError);
    EXPECT_THROW(Mesh(block.all().subspan(8, block.size - 64), block.memory), MeshError);
    EXPECT_THROW(mesh.write(block.all().first(128)), MeshError);
    for (std::size_t at = 0; at < 32; at += 8) {  // the magic word and the counts
        Block spoiled = written();
        spoiled.memory.get()[at + 3] ^= std::byte{0x40};
        EXPECT_THROW(Mesh(spoiled.all(), spoiled.memory), MeshError) << at;
    }
}

}  // namespace
}  // namespace knurl
