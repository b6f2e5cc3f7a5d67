// The channel's three slots are updated rather than written anew. Whenever the application reads, it finds
// all present feedback and none of the past.

#include <random>

#include <knurl/reps/all.hpp>

#include "core_claim_fixture.hpp"

namespace knurl::servo {
namespace {

using namespace testing;

TEST(KeptFeedback, WhoeverLooksSeldomOrOftenFindsWhatIsFeltInThatCycle) {
    constexpr std::uint32_t most = 100;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 rng(seed);
        const auto draw = [&](int below) { return static_cast<int>(rng() % static_cast<unsigned>(below)); };
        ClaimFixture fixture;
        Scene same({.representations = 128, .probes = 16}, {.period = 1e-3});
        std::array<std::uint32_t, most> generation{};
        std::array<bool, most> there{};
        std::size_t looked = 0;
        for (int cycle = 0; cycle < 400; ++cycle) {
            for (int change = draw(4) == 0 ? draw(20) : 0; change > 0; --change) {
                const auto slot = static_cast<std::uint32_t>(draw(most));
                const Plane plane{.offset = 1e-4 * draw(20) - 2e-3,
                                  .stiffness = 100.0 * (1 + draw(3)),
                                  .recovery = 0,
                                  .combine = PlaneCombine::sum};
                if (there[slot]) {
                    fixture.claim.remove({slot, generation[slot]});
                    ASSERT_TRUE(same.remove({slot, generation[slot]}));
                } else {
                    const RepresentationId id{slot, ++generation[slot]};
                    fixture.claim.add(id, kind_of<Plane>, &plane, sizeof plane, {});
                    ASSERT_TRUE(same.add(id, plane));
                }
                there[slot] = !there[slot];
            }
            if (draw(3) == 0) fixture.device.tip.z() = 1e-4 * draw(60) - 3e-3;
            fixture.servo.step();
            fixture.claim.replies();
            Probe hand;
            hand.position = fixture.device.tip;
            same.evaluate(hand, 1e-3);
            if (draw(4) != 0) continue;
            const auto& felt = fixture.claim.feedback().entries;
            std::array<Feedback, most> expected;
            ASSERT_EQ(felt.size(), same.feedback(expected)) << "cycle " << cycle;
            for (std::size_t i = 0; i < felt.size(); ++i) {
                ASSERT_EQ(felt[i].id, expected[i].id);
                ASSERT_EQ(felt[i].flags, expected[i].flags) << "cycle " << cycle << " entry " << i;
                ASSERT_EQ(vec(felt[i].force), expected[i].wrench.force)
                    << "cycle " << cycle << " entry " << i;
                ASSERT_EQ(felt[i].stiffness, expected[i].stiffness);
                looked += (felt[i].flags & Feedback::touching) != 0;
            }
        }
        EXPECT_GT(looked, 0u);
    }
}

}  // namespace
}  // namespace knurl::servo
