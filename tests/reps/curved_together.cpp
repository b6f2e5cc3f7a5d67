// Curved surfaces that hold the hand together: at the nearest point that satisfies the surfaces themselves.

#include <iostream>

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

TEST(CurvedTogether, ExploreLoops) {
    const std::uint64_t seed = getenv("SEED") ? std::strtoull(getenv("SEED"), nullptr, 10) : 2602;
    const double least = getenv("LEAST") ? atof(getenv("LEAST")) : 0.01;
    const double size = getenv("SIZE") ? atof(getenv("SIZE")) : 0.0015;
    Rng rng(seed);
    double worst = 0, jump = 0, stiff = 0;
    long over[6] = {}, cyc = 0, rounds[8] = {};
    for (int round = 0; round < (getenv("N") ? atoi(getenv("N")) : 60); ++round) {
        Scene scene = make_scene();
        const std::uint32_t count = surfaces_of(rng);
        std::vector<Distances> all;
        for (std::uint32_t i = 0; i < count; ++i)
            all.push_back(add_near_origin(rng, scene, i, size / 1.5,
                                          getenv("MIX") ? scale(rng, 100, 2000) : 1000, least, 5 * least));
        const SmallLoop loop(rng, Vector(0, 0, -size / 1.5), size);
        scene.settle();
        double most = 0, sh = 0;
        int at_ = 0;
        constexpr int steps = 20000;
        double sum = 0;
        Vector p = loop.at(0), lastf = Vector::Zero(), lastm = p;
        for (int i = 0; i < steps; ++i) {
            const Vector next = loop.at(2 * M_PI * (i + 1) / steps), mid = (p + next) / 2;
            const Vector f = scene.evaluate(at(mid), dt).force;
            ++cyc;
            rounds[std::min(7u, scene.curved_rounds())]++;
            if (i) {
                const Vector dp = mid - lastm, df = f - lastf;
                const double r = df.norm() / dp.norm() / (getenv("MIX") ? 2000 : 1000);
                if (r > most) most = r, at_ = i;
                sh = std::max(sh, -df.dot(dp) / dp.squaredNorm() / (getenv("MIX") ? 2000 : 1000));
            }
            if (getenv("ROUND") && atoi(getenv("ROUND")) == round && i > 0 &&
                (f - lastf).norm() / (mid - lastm).norm() > 2000) {
                std::printf("  %d: p %g %g %g, f from %.5g %.5g %.5g to %.5g %.5g %.5g rounds %u; heights", i,
                            mid.x() * 1e3, mid.y() * 1e3, mid.z() * 1e3, lastf.x(), lastf.y(), lastf.z(),
                            f.x(), f.y(), f.z(), scene.curved_rounds());
                for (auto& d : all)
                    std::printf(" p %.5g last x %.3g x %.3g;", 1e3 * (double)d.height(mid.cast<Real>()),
                                1e3 * (double)d.height((lastm + lastf / 1000).cast<Real>()),
                                1e3 * (double)d.height((mid + f / 1000).cast<Real>()));
                std::printf("\n");
            }
            lastf = f;
            lastm = mid;
            sum += f.dot(next - p);
            p = next;
        }
        if (std::abs(sum) > 1e-8 || most > 1.01)
            std::printf("round %d, %u surfaces: work %.3g J, largest step %.4g k at %d, stiffness %.4g k\n",
                        round, count, sum, most, at_, sh);
        worst = std::max(worst, std::abs(sum));
        jump = std::max(jump, most);
        stiff = std::max(stiff, sh);
    }
    (void)over;
    std::printf("worst %.3g J, step %.4g k, stiffness %.6g k, %ld cycles, rounds", worst, jump, stiff, cyc);
    for (long r : rounds) std::printf(" %ld", r);
    std::printf("\n");
}
