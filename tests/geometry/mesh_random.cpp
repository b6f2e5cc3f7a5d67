// Random meshes: for any input, the result has the properties on which the walk relies, or it is refused.

#include <bit>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "mesh_data.hpp"
#include "raw_mesh.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

/// Empty, or what is wrong. A refusal is correct if it has a text.
std::string judged(const RawMesh& raw, const MeshBuild& how, bool& built) {
    try {
        const Mesh mesh(raw.given(), how);
        built = true;
        return wrong(mesh, raw, how);
    } catch (const MeshError& e) {
        built = false;
        return std::strlen(e.what()) > 20 ? "" : "refused without a reason";
    }
}

TEST(MeshRandom, BytesAreBuiltOrRefused) {
    int built_ones = 0;
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        std::mt19937_64 random(seed);
        RawMesh raw;
        raw.vertices.resize(random() % 40);
        raw.triangles.resize(random() % 60);
        for (Point3& p : raw.vertices)
            for (double& x : p) {
                switch (random() % 4) {
                    case 0:
                        x = std::bit_cast<double>(random());
                        break;
                    case 1:
                        x = std::ldexp(1.0, static_cast<int>(random() % 60) - 30);
                        break;
                    default:
                        x = static_cast<double>(random() % 4);
                }
            }
        const auto range = raw.vertices.size() + (seed % 10 == 0 ? 1 : 0);
        for (Triangle& t : raw.triangles)
            for (auto& v : t) v = range == 0 ? 0 : static_cast<std::uint32_t>(random() % range);
        MeshBuild how;
        how.exact = seed % 2 == 0;
        how.weld = seed % 3 == 0 ? 0 : seed % 3 == 1 ? 1e-6 : 0.05;
        bool built = false;
        ASSERT_EQ(judged(raw, how, built), "") << "seed " << seed;
        built_ones += built;
    }
    EXPECT_GT(built_ones, 100);
    EXPECT_LT(built_ones, 2900);
}

TEST(MeshRandom, SoupsOfFewVerticesHaveEveryKindOfEdge) {
    std::uint64_t non_manifold = 0, split = 0, open = 0, built_ones = 0;
    for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
        std::mt19937_64 random(seed);
        RawMesh raw;
        for (std::size_t i = 0; i < 5 + seed % 20; ++i)
            raw.vertices.push_back({between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)});
        for (std::size_t i = 0; i < 4 + random() % 60; ++i) {
            Triangle t;
            for (auto& v : t) v = static_cast<std::uint32_t>(random() % raw.vertices.size());
            raw.triangles.push_back(t);
            if (random() % 2 == 0) raw.triangles.push_back({t[0], t[2], t[1]});
        }
        bool built = false;
        ASSERT_EQ(judged(raw, {}, built), "") << "seed " << seed;
        if (!built) continue;
        ++built_ones;
        const Mesh mesh(raw.given());
        non_manifold += mesh.notes().edges_non_manifold;
        split += mesh.notes().vertices_split;
        open += mesh.notes().edges_open;
    }
    EXPECT_GT(built_ones, 100);
    EXPECT_GT(non_manifold, 1000);
    EXPECT_GT(split, 100);
    EXPECT_GT(open, 1000);
}

TEST(MeshRandom, ManyFacesAtOnePlaceTakeNoLongerThanElsewhere) {
    // Counted in queries, one per slice of the work.
    const auto questions = [](const RawMesh& raw, const MeshBuild& settings = {}) {
        std::size_t asked = 0;
        MeshBuild how = settings;
        how.go_on = [&] { return ++asked, true; };
        how.budget = std::size_t{1} << 30;
        const Mesh mesh(raw.given(), how);
        return asked;
    };
    const std::uint64_t seed = 0x5eed8;
    std::mt19937_64 random(seed);
    const int n = 20000;
    RawMesh around, edge, long_ones, needles;
    for (int i = 0; i < n; ++i) {  // all at one vertex
        const auto v = static_cast<std::uint32_t>(around.vertices.size());
        if (i == 0) around.vertices.push_back({0, 0, 0});
        for (int k = 0; k < 2; ++k)
            around.vertices.push_back(
                {between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)});
        around.triangles.push_back({0, std::max(v, 1U), std::max(v, 1U) + 1});
    }
    edge.vertices = {{0, 0, 0}, {0, 0, 1}};
    for (std::uint32_t i = 0; i < n; ++i) {  // all at one edge
        edge.vertices.push_back({between(random, -1, 1), between(random, -1, 1), 0.5});
        edge.triangles.push_back(i % 2 == 0 ? Triangle{0, 1, i + 2} : Triangle{1, 0, i + 2});
    }
    for (std::uint32_t i = 0; i < n; ++i) {  // side by side along a diagonal: all boxes overlap, none cross
        const double off = i * 1e-5;
        long_ones.vertices.insert(long_ones.vertices.end(),
                                  {{off, -off, 0}, {1 + off, 1 - off, 1}, {off, -off, 1e-3}});
        long_ones.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    for (int i = 0; i < n; ++i) needles.add(raw_soup(random, 1, 1.0));  // all cross
    const std::size_t usual = questions(raw_soup(random, n, 1e-3));
    for (const RawMesh* raw : {&around, &edge, &long_ones, &needles})
        EXPECT_LE(questions(*raw), 60 * usual) << (raw - &around) << " seed " << seed << " usual " << usual;
}

TEST(MeshRandom, VerticesOfOneCellTakeNoLongerThanElsewhere) {
    const std::uint64_t seed = 0x5eed9;
    std::mt19937_64 random(seed);
    RawMesh raw = raw_soup(random, 20000, 1.0);
    for (std::size_t v = 0; v < raw.vertices.size(); ++v) {
        if (v % 5 < 3) continue;  // the others keep the mesh's size, and so the tolerance
        for (double& x : raw.vertices[v]) x = 0.5 + (x - 0.5) * 2.7e-5;
    }
    for (const double weld : {0.0, 1e-6, 1e-4}) {
        std::size_t asked = 0;
        MeshBuild how;
        how.weld = weld;
        how.go_on = [&] { return ++asked, true; };
        try {
            const Mesh mesh(raw.given(), how);
        } catch (const MeshError&) {
        }
        EXPECT_LE(asked, 500) << weld << " seed " << seed;
    }
}

}  // namespace
