// Random hands on random meshes: no place near the proxy is nearer to the hand, at every size and far from
// the origin, and the proxy touches whenever the exact god-object does.

#include "exact/god_object.hpp"
#include "exact/surface.hpp"
#include "paths.hpp"
#include "spoiled.hpp"
#include "walk_tools.hpp"

namespace knurl::test {
namespace {

using exact::V;

V exact_of(const Eigen::Vector3d& p) {
    return {p.x(), p.y(), p.z()};
}

/// Paths of every kind, `each` of each.
std::vector<Hand> some_hands(const MadeMesh& shape, std::uint64_t seed, int each) {
    Hands hands(shape, seed);
    std::vector<Hand> all;
    for (int i = 0; i < each; ++i) {
        all.push_back(hands.stroke());
        all.push_back(hands.graze());
        all.push_back(hands.poke());
        all.push_back(hands.around_an_edge());
        all.push_back(hands.into_a_corner());
    }
    return all;
}

struct Found {
    std::size_t cycles = 0, touching = 0, lost = 0, elsewhere = 0;
    double worst = 0, worst_gain = 0;  // as a share of the size
};

/// Compares with the exact god-object, which is moved to the proxy's place if both places were right.
Found beside_the_judge(const MadeMesh& shape, const std::vector<Hand>& hands) {
    const exact::Surface surface(shape.vertices, shape.triangles);
    const auto mesh = build(shape);
    const double size = double(surface.size());
    Found found;
    for (const Hand& hand : hands) {
        Finger finger(*mesh);
        exact::GodObject judge(surface);
        for (const auto& p : hand) {
            const V h = exact::to_exact(p);
            const bool touches = finger.to(p), held = judge.step(h);
            ++found.cycles;
            if (touches) {
                ++found.touching;
                const V at = exact_of(finger.foot.point);
                const double gain = double(surface.gain(at, h, 1e-9L * surface.size())) / size;
                found.worst_gain = std::max(found.worst_gain, gain);
                if (held) {
                    const double off = double(exact::distance(at, judge.at())) / size;
                    if (off < 1e-6) {
                        found.worst = std::max(found.worst, off);
                    } else {
                        ++found.elsewhere;
                    }
                }
            }
            // By rounding, only one of the two may touch.
            const bool shallow = (touches ? finger.foot.depth : 0) < 1e-6 * size &&
                                 (held ? double(exact::distance(judge.at(), h)) : 0) < 1e-6 * size;
            if (touches != held && !shallow) ++found.lost;
        }
    }
    return found;
}

class EveryShape : public testing::TestWithParam<int> {};

TEST(WalkAtRandom, RestsWhereNothingNearIsNearer) {
    const std::uint64_t seed = 20261123;
    for (const MadeMesh& shape : clean_shapes(seed)) {
        const Found found = beside_the_judge(shape, some_hands(shape, seed, 3));
        SCOPED_TRACE(shape.name + ", seed " + std::to_string(seed));
        EXPECT_LE(found.worst_gain, 1e-12);
        EXPECT_LE(found.worst, 5e-11);  // 1e-11 m at 0.2 m
        EXPECT_EQ(found.lost, 0u) << "of " << found.touching;
        EXPECT_LE(double(found.elsewhere), 0.001 * double(found.touching));
        std::printf("%-16s %7zu cycles, %7zu touching, %zu lost, %zu elsewhere, off %.1e, gain %.1e\n",
                    shape.name.c_str(), found.cycles, found.touching, found.lost, found.elsewhere,
                    found.worst, found.worst_gain);
    }
}

}  // namespace
}  // namespace knurl::test
