// Curved surfaces that hold the hand together: at the nearest point that satisfies the surfaces themselves.

#include "curved_reference.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

std::uint32_t surfaces_of(Rng& rng) {
    return static_cast<std::uint32_t>(between(rng, 2, 4));
}

}  // namespace

TEST(CurvedTogether, HoldTheHandAtTheNearestPointThatSatisfiesThem) {
    const std::uint64_t seed = getenv("SEED") ? std::strtoull(getenv("SEED"), nullptr, 10) : 2601;
    Rng rng(seed);
    long cycles = 0, none = 0, off = 0, several = 0, rounds[6] = {}, coldrounds[6] = {};
    double worst = 0;
    for (int round = 0; round < (getenv("N") ? atoi(getenv("N")) : 60); ++round) {
        Scene scene = make_scene();
        std::vector<Distances> all;
        const std::uint32_t count = surfaces_of(rng);
        for (std::uint32_t i = 0; i < count; ++i)
            all.push_back(add_near_origin(rng, scene, i, 0.001, 1000, 0.01, 0.05));
        const SmallLoop loop(rng, Vector(0, 0, -0.001), 0.0015);
        scene.settle();
        constexpr int steps = 200;
        Vector lastx;
        for (int i = 0; i < steps; ++i) {
            const Vector p = loop.at(2 * M_PI * i / steps);
            const Vector x = p + scene.evaluate(at(p), dt).force / 1000;
            const auto want = nearest_of(all, p.cast<Real>(), 0.05L);
            ++cycles;
            const std::uint32_t took = std::min(5u, scene.curved_rounds());
            if (i)
                ++rounds[took];
            else
                ++coldrounds[took];
            if (!want) {
                ++none;
                continue;
            }
            several += want->active > 1;
            const double error = static_cast<double>((x.cast<Real>() - want->x).norm());
            if (error > 1e-9) {
                ++off;
                Real least = 1;
                for (auto& s : all) least = std::min(least, s.height(x.cast<Real>()));
                if (off < 40)
                    std::printf(
                        "round %d cycle %d: error %.3g, ours %.9g mm away, ref %.9g (active %d), violated by "
                        "%.3g, rounds %u\n",
                        round, i, error, (x - p).norm() * 1e3,
                        (double)(want->x - p.cast<Real>()).norm() * 1e3, want->active, (double)-least,
                        scene.curved_rounds());
            } else
                worst = std::max(worst, error);
            lastx = x;
        }
    }
    std::printf("%ld cycles, %ld of several, %ld without reference, %ld off, worst else %.3g; rounds", cycles,
                several, none, off, worst);
    for (long r : rounds) std::printf(" %ld", r);
    std::printf(", first");
    for (long r : coldrounds) std::printf(" %ld", r);
    std::printf("\n");
    EXPECT_EQ(off, 0) << "seed " << seed;
    EXPECT_EQ(none, 0) << "seed " << seed;
}
