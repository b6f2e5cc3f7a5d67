// The result of an application's source, in any process: the asset with its materials, or a one-line error.

#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/geometry/proxy.hpp>
#include <knurl/geometry/triangles.hpp>
#include <knurl/servo/asset_build.hpp>

#include "../refusal.hpp"

namespace {

using knurl::AssetMaterial;
using knurl::protocol::AssetSource;
using knurl::servo::build_asset;
using knurl::servo::BuiltAsset;

constexpr std::uint64_t plenty = 1 << 20;

/// A source's bytes, with room in front so that they can be moved.
struct Bytes {
    std::vector<std::uint64_t> words;
    std::size_t size = 0;
    std::span<std::byte> all() { return std::as_writable_bytes(std::span(words)).first(size); }
    void put(std::uint64_t at, const void* from, std::size_t bytes) {
        std::memcpy(all().data() + at, from, bytes);
    }
    void room(std::uint64_t bytes) {
        size = bytes;
        words.resize((bytes + 15) / 8);
    }
};

/// One square metre, of a soft material.
Bytes square() {
    const std::vector<knurl::Point3> vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<knurl::Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
    const AssetMaterial soft{.stiffness = 0.5};
    AssetSource header;
    header.vertices = vertices.size();
    header.triangles = triangles.size();
    header.materials = 1;
    const auto layout = *knurl::protocol::layout_of(header);
    Bytes bytes;
    bytes.room(layout.total);
    bytes.put(0, &header, sizeof header);
    bytes.put(layout.vertices, vertices.data(), 24 * vertices.size());
    bytes.put(layout.materials, &soft, sizeof soft);
    bytes.put(layout.triangles, triangles.data(), 12 * triangles.size());
    return bytes;
}

/// 5 by 4 heights of 0.25 m, rough.
Bytes field() {
    knurl::protocol::HeightSource header{
        .columns = 5, .rows = 4, .dx = 0.5, .dy = 0.25, .corner = {1, 2, 3}, .material = {.friction = 0.5}};
    const std::vector<float> heights(20, 0.25f);
    Bytes bytes;
    bytes.room(*knurl::protocol::bytes_of(header));
    bytes.put(0, &header, sizeof header);
    bytes.put(sizeof header, heights.data(), 4 * heights.size());
    return bytes;
}

std::string refusal(std::span<const std::byte> bytes, std::uint64_t budget = plenty) {
    return knurl::test::refusal_of([&] { build_asset(bytes, budget); });
}

TEST(AssetBuild, AMeshComesOutWithItsMaterials) {
    Bytes bytes = square();
    const BuiltAsset built = build_asset(bytes.all(), plenty);
    std::fill(bytes.words.begin(), bytes.words.end(), ~std::uint64_t{0});  // not needed any more
    ASSERT_EQ(built.asset->materials.size(), 1u);
    EXPECT_EQ(built.asset->materials[0].stiffness, 0.5);
    EXPECT_EQ(built.ready.kind, static_cast<std::uint32_t>(knurl::AssetKind::mesh));
    EXPECT_EQ(built.ready.faces, 2u);
    EXPECT_EQ(built.ready.bytes, built.asset->bytes());
    EXPECT_EQ(built.ready.notes.triangles_given, 2u);
    EXPECT_NEAR(built.ready.high[0], 1, 1e-6);
    knurl::Proxy proxy;
    knurl::Foot foot;
    knurl::Work work;
    follow(*built.asset, proxy, {0.5, 0.4, 0.01}, 0, foot, work);
    ASSERT_TRUE(follow(*built.asset, proxy, {0.5, 0.4, -0.01}, 0, foot, work));
    EXPECT_NEAR(foot.depth, 0.01, 1e-12);
}

TEST(AssetBuild, SoDoesAHeightField) {
    Bytes bytes = field();
    const BuiltAsset built = build_asset(bytes.all(), plenty);
    std::fill(bytes.words.begin(), bytes.words.end(), ~std::uint64_t{0});
    ASSERT_EQ(built.asset->kind, knurl::AssetKind::height_field);
    ASSERT_EQ(built.asset->materials.size(), 1u);
    EXPECT_EQ(built.asset->materials[0].friction, 0.5);
    EXPECT_EQ(built.ready.kind, static_cast<std::uint32_t>(knurl::AssetKind::height_field));
    EXPECT_EQ(built.ready.faces, 24u);
    EXPECT_EQ(built.ready.bytes, built.asset->bytes());
    EXPECT_EQ(built.ready.low[1], 2);
    EXPECT_EQ(built.ready.high[0], 3);
    knurl::Proxy proxy;
    knurl::Foot foot;
    knurl::Work work;
    follow(*built.asset, proxy, {2, 2.4, 3.3}, 0, foot, work);
    ASSERT_TRUE(follow(*built.asset, proxy, {2, 2.4, 3.24}, 0, foot, work));
    EXPECT_NEAR(foot.depth, 0.01, 1e-12);
    EXPECT_EQ(foot.material, 0);
}

/// The source with one part replaced.
template <class T>
std::string with(Bytes bytes, std::size_t at, T value, std::uint64_t budget = plenty) {
    bytes.put(at, &value, sizeof value);
    return refusal(bytes.all(), budget);
}

TEST(AssetBuild, WhatIsNoSourceIsRefusedInOneLine) {
    Bytes bytes = square();
    EXPECT_NE(refusal(bytes.all().first(40)).find("40 bytes"), std::string::npos);
    EXPECT_NE(refusal(bytes.all().first(bytes.size - 4)).find("cut off"), std::string::npos);
    EXPECT_NE(refusal(bytes.all(), 100).find("budget is 100"), std::string::npos);
    Bytes moved;
    moved.room(bytes.size + 8);
    moved.put(4, bytes.all().data(), bytes.size);
    EXPECT_NE(refusal(moved.all().subspan(4, bytes.size)).find("aligned"), std::string::npos);
    EXPECT_EQ(refusal(bytes.all()), "accepted");
    using Head = knurl::protocol::AssetHead;
    EXPECT_NE(with(bytes, 0, std::uint64_t{1}).find("same version"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Head, version), 2u).find("same version"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Head, kind), 3u).find("kind 3"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(AssetSource, flags), 64u).find("flags 0x40"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Head, kind), 2u).find("heights do not make"), std::string::npos);
}

TEST(AssetBuild, NorIsWhatIsNoHeightField) {
    using Source = knurl::protocol::HeightSource;
    Bytes bytes = field();
    EXPECT_EQ(refusal(bytes.all()), "accepted");
    EXPECT_NE(refusal(bytes.all().first(80)).find("no height field"), std::string::npos);
    EXPECT_NE(refusal(bytes.all().first(bytes.size - 4)).find("cut off"), std::string::npos);
    EXPECT_NE(refusal(bytes.all(), 100).find("budget is 100"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Source, columns), 6u).find("6 by 4"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Source, columns), ~std::uint64_t{0}).find("do not make"),
              std::string::npos);
    EXPECT_NE(
        with(bytes, offsetof(Source, columns), std::uint64_t{1} + (std::uint64_t{20} << 32)).find("1 by 20"),
        std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Source, dx), -1.0).find("1e-9 m or more"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Source, dy), double{NAN}).find("1e-9 m or more"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Source, corner) + 8, double{INFINITY}).find("corner"), std::string::npos);
    EXPECT_NE(with(bytes, offsetof(Source, material), double{NAN}).find("material 0"), std::string::npos);
    EXPECT_NE(with(bytes, sizeof(Source) + 28, NAN).find("column 2, row 1"), std::string::npos);
    EXPECT_NE(with(bytes, sizeof(Source), -1e9f).find("column 0, row 0"), std::string::npos);
}

}  // namespace
