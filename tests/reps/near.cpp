// What is out of reach is not asked, and nothing else is left out.

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "../../reps/src/reach.hpp"
#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

TEST(Reach, CollectsExactlyThoseThatComeNearer) {
    const std::uint64_t seed = 77;
    Rng rng(seed);
    for (int round = 0; round < 40; ++round) {
        const auto capacity = static_cast<std::uint32_t>(between(rng, 1, 400));
        detail::Reach reach(capacity);
        struct Ball {
            Vector center;
            double radius;
            bool present = false;
        };
        std::vector<Ball> balls(capacity);
        std::vector<std::uint32_t> found(capacity);
        const double offset = round % 4 == 0 ? 1e6 : 0;
        for (int i = 0; i < 300; ++i) {
            const auto slot = static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(capacity) - 1));
            if (between(rng, 0, 3) > 0) {
                balls[slot] = {0.1 * direction(rng) * uniform(rng, 0, 1) + Vector(offset, 0, 0),
                               scale(rng, 1e-4, 0.02), true};
                reach.put(slot, balls[slot].center, balls[slot].radius);
            } else {
                balls[slot].present = false;
                reach.drop(slot);
            }
            if (between(rng, 0, 40) == 0) reach.index();
            const Vector p = 0.1 * direction(rng) + Vector(offset, 0, 0);
            const double within = scale(rng, 1e-6, 0.05);
            const std::uint32_t n = reach.collect(p, within, found);
            const std::set<std::uint32_t> answer(found.begin(), found.begin() + n);
            ASSERT_EQ(answer.size(), n) << "one twice; seed " << seed;
            std::uint32_t present = 0;
            for (std::uint32_t s = 0; s < capacity; ++s) {
                present += balls[s].present;
                const bool near = balls[s].present && (balls[s].center - p).norm() - balls[s].radius < within;
                if (near) {
                    ASSERT_TRUE(answer.count(s)) << "seed " << seed << " round " << round;
                }
                // It may collect one that is a rounding error further.
                if (!near && answer.count(s)) {
                    ASSERT_TRUE(balls[s].present);
                    ASSERT_LT((balls[s].center - p).norm() - balls[s].radius, within + 1e-8);
                }
            }
            ASSERT_EQ(reach.size(), present);
        }
    }
}
