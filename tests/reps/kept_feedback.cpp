// Kept feedback equals feedback made anew, and names what it wrote.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

constexpr std::size_t most = 100, words = 2;

/// Feedback kept by the scene's calls, and a copy that gets only the entries named as written.
struct Kept {
    std::array<Feedback, most> entries, copy;
    std::array<std::uint64_t, words> wholly{}, flags{};

    std::size_t take(Scene& scene) {
        const std::size_t n = scene.feedback(entries, {.wholly = wholly, .flags = flags});
        for (std::size_t i = 0; i < most; ++i) {
            if (wholly[i / 64] >> (i % 64) & 1) copy[i] = entries[i];
            if (flags[i / 64] >> (i % 64) & 1) copy[i].flags = entries[i].flags;
        }
        return n;
    }
    std::size_t written() const {
        std::size_t n = 0;
        for (std::size_t w = 0; w < words; ++w)
            n += static_cast<std::size_t>(__builtin_popcountll(wholly[w] | flags[w]));
        return n;
    }
};

void expect_same(const Feedback& kept, const Feedback& anew) {
    ASSERT_EQ(kept.id, anew.id);
    ASSERT_EQ(kept.flags, anew.flags);
    ASSERT_EQ(kept.stiffness, anew.stiffness);
    ASSERT_EQ(kept.tangential_stiffness, anew.tangential_stiffness);
    ASSERT_EQ(kept.wrench.force, anew.wrench.force);
    ASSERT_EQ(kept.wrench.torque, anew.wrench.torque);
    if ((anew.flags & Feedback::touching) == 0) return;
    ASSERT_EQ(kept.contact_point, anew.contact_point);
}

/// Adds to a free slot, or removes or changes what is there.
struct Hands {
    Scene& scene;
    Rng& rng;
    std::array<std::uint32_t, most> generation{};
    std::array<int, most> kind{};  // 0: free

    Plane plane() {
        Plane p{.normal = to_plain(direction(rng)),
                .offset = uniform(rng, -0.002, 0.002),
                .stiffness = 200.0 * between(rng, 0, 6)};
        if (between(rng, 0, 9) == 0) p.combine = PlaneCombine::sum;
        if (between(rng, 0, 9) == 0) p.friction.dynamic = 0.3;
        return p;
    }
    Sphere sphere() {
        return {
            .center = to_plain(uniform(rng, 0, 0.02) * direction(rng)), .radius = 0.005, .stiffness = 400};
    }
    Spring spring() {
        return {.anchor = {0, 0, 0.01}, .stiffness = 100.0 * between(rng, 0, 1), .duration = 0.01};
    }

    template <class R>
    void put(std::uint32_t slot, const R& params) {
        if (kind[slot] != 0) {
            ASSERT_TRUE(scene.update({slot, generation[slot]}, params));
            return;
        }
        ASSERT_TRUE(scene.add({slot, ++generation[slot]}, params,
                              {.probe = static_cast<std::uint32_t>(between(rng, 0, 1)),
                               .on_silence = static_cast<OnSilence>(between(rng, 0, 1)),
                               .feedback = between(rng, 0, 5) > 0}));
    }
    void act(std::uint32_t slot) {
        if (kind[slot] != 0 && between(rng, 0, 5) == 0) {
            ASSERT_TRUE(scene.remove({slot, generation[slot]}));
            kind[slot] = 0;
            return;
        }
        const int what = kind[slot] != 0 ? kind[slot] : between(rng, 1, 3);
        if (what == 1) put(slot, plane());
        if (what == 2) put(slot, sphere());
        if (what == 3) put(slot, spring());
        kind[slot] = what;
    }
};

TEST(KeptFeedback, SaysWhatFeedbackMadeAnewSaysWhateverHappensToTheScene) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Rng rng(seed);
        Limits limits{.max_stiffness = 700};
        Scene scene({.representations = most, .probes = 2}, limits);
        scene.set_fade({.automatic = 0.004, .rise_speed = infinity});
        ASSERT_TRUE(scene.place_probe(1, {.offset = {0.01, 0, 0}, .radius = 0.001}));
        Hands hands{scene, rng};
        Kept kept;
        Vector hand = Vector::Zero();
        for (int cycle = 0; cycle < 300; ++cycle) {
            const int changes = between(rng, 0, 3) == 0 ? between(rng, 1, 30) : 0;
            for (int c = 0; c < changes; ++c)
                ASSERT_NO_FATAL_FAILURE(hands.act(static_cast<std::uint32_t>(between(rng, 0, most - 1))));
            if (between(rng, 0, 40) == 0) scene.set_limits({.max_stiffness = 100.0 * between(rng, 3, 9)});
            if (between(rng, 0, 150) == 0) {
                scene.clear();
                hands.kind.fill(0);
            }
            scene.set_silence(cycle % 97 > 80 ? 0.01 : 0);
            if (between(rng, 0, 2) == 0) hand = uniform(rng, 0, 0.004) * direction(rng);
            if (between(rng, 0, 20) == 0) hand = {0, 0, 0.2};
            scene.evaluate(at(hand, 0.01 * direction(rng)), between(rng, 0, 9) == 0 ? 0 : dt);
            if (between(rng, 0, 9) == 0) continue;  // no call in this cycle

            std::array<Feedback, most> anew;
            const std::size_t count = scene.feedback(anew);
            ASSERT_EQ(kept.take(scene), count) << "cycle " << cycle;
            for (std::size_t i = 0; i < count; ++i) {
                SCOPED_TRACE("cycle " + std::to_string(cycle) + " entry " + std::to_string(i));
                ASSERT_NO_FATAL_FAILURE(expect_same(kept.entries[i], anew[i]));
                ASSERT_NO_FATAL_FAILURE(expect_same(kept.copy[i], kept.entries[i]));
                ASSERT_EQ(kept.copy[i].contact_point, kept.entries[i].contact_point);
            }
        }
    }
}

TEST(KeptFeedback, WritesWhatIsTouchedAndWhatComesToRestOnceAndNothingElse) {
    Scene scene({.representations = most, .probes = 1}, {});
    for (std::uint32_t i = 0; i < most; ++i) {
        const double offset = i == 70 ? 0 : -0.1;
        ASSERT_TRUE(scene.add({i, 1}, Plane{.offset = offset, .stiffness = 500, .recovery = 0}));
    }
    settled(scene, at({0, 0, 0.01}));
    Kept kept;
    kept.take(scene);
    EXPECT_EQ(kept.written(), most) << "all of it is new";
    const auto written_at = [&](double z) {
        scene.evaluate(at({0, 0, z}), dt);
        kept.take(scene);
        return kept.written();
    };
    EXPECT_EQ(written_at(0.02), 0u) << "all of it rests";
    EXPECT_EQ(written_at(-0.001), 1u);
    EXPECT_EQ(written_at(-0.002), 1u);
    EXPECT_EQ(kept.entries[70].wrench.force, Vector(0, 0, 1));
    EXPECT_EQ(written_at(0.01), 1u) << "it has come to rest";
    EXPECT_EQ(kept.entries[70].wrench.force, Vector(0, 0, 0));
    EXPECT_EQ(written_at(0.02), 0u);
    scene.set_silence(1e-3);
    EXPECT_EQ(written_at(0.02), most) << "they are silent";
    for (int cycle = 0; cycle < 150; ++cycle) written_at(0.02);
    scene.set_silence(1);
    EXPECT_EQ(written_at(0.02), 0u) << "they have faded, and the silence goes on";
    scene.set_silence(0);
    EXPECT_EQ(written_at(0.02), most);
}

}  // namespace
