// A scene out of the hand's reach may skip evaluations: afterwards it gives the same bits as its twin without
// skipping.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace sleeping_scene_tests {
namespace {

constexpr std::uint32_t slots = 8;

/// Feedback kept, as in the servo.
struct Kept {
    std::array<Feedback, slots> entries;
    std::size_t size = 0;
    bool written = false;  // some of it was written, by the last take()

    void take(Scene& scene) {
        std::array<std::uint64_t, 1> wholly{}, flags{};
        size = scene.feedback(entries, {.wholly = wholly, .flags = flags});
        written = (wholly[0] | flags[0]) != 0;
    }
};

/// Skips evaluations like the servo.
class Left {
  public:
    explicit Left(Scene& scene) : scene_(scene) {}
    Kept kept;
    Wrench evaluate(const Probe& hand, double dt, bool silent) {
        ++cycle_;
        const bool left = on_ && dt > 0 && !scene_.changed() && (hand.position - at_).norm() < within_;
        if (!left && on_) scene_.pass(cycle_ - 1 - since_, time_, hand_);
        hand_ = hand;
        time_.all += dt;
        time_.held += silent ? 0 : dt;
        made = !left;
        if (left) return ++many, Wrench{};
        const Wrench w = scene_.evaluate(hand, dt);
        kept.take(scene_);
        within_ = dt > 0 ? scene_.sleep_radius() : 0;
        on_ = within_ > 0;
        at_ = hand.position;
        since_ = cycle_;
        time_ = scene_.time();
        return w;
    }
    int many = 0;
    bool made = true;  // the last evaluation

  private:
    Scene& scene_;
    bool on_ = false;
    std::uint64_t cycle_ = 0, since_ = 0;
    double within_ = 0;
    Eigen::Vector3d at_;
    SceneTime time_;
    Probe hand_;
};

struct Twins {
    Scene evaluated{{.representations = slots, .probes = 2}, {.mass = 0.1, .period = 1e-3}};
    Scene left_out{{.representations = slots, .probes = 2}, {.mass = 0.1, .period = 1e-3}};
    std::array<std::uint32_t, slots> generation{};
    std::array<int, slots> kind{};  // 0: free

    template <class R>
    void put(std::uint32_t slot, const R& params, const AddOptions& options, int of) {
        const bool there = kind[slot] != 0;
        if (there && kind[slot] != of) return;
        if (!there) ++generation[slot];
        for (Scene* scene : {&evaluated, &left_out}) {
            const RepresentationId id{slot, generation[slot]};
            ASSERT_TRUE(there ? scene->update(id, params) : scene->add(id, params, options));
        }
        kind[slot] = of;
    }
    void change(Rng& rng) {
        const std::uint32_t slot = static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(slots) - 1));
        const AddOptions options{.on_silence = static_cast<OnSilence>(between(rng, 0, 2)),
                                 .silence_time = 0.02};
        if (kind[slot] != 0 && between(rng, 0, 2) == 0) {
            for (Scene* scene : {&evaluated, &left_out}) ASSERT_TRUE(scene->remove({slot, generation[slot]}));
            kind[slot] = 0;
            return;
        }
        const int of = kind[slot] != 0 ? kind[slot] : between(rng, 1, 18);
        if (of <= 7) {
            Plane p{.normal = to_plain(direction(rng)),
                    .offset = uniform(rng, -0.03, -0.002),
                    .stiffness = 100.0 * between(rng, 0, 4)};
            if (of <= 2) p.friction.dynamic = 0.4;
            if (of == 3) p.combine = PlaneCombine::sum;
            if (of == 4) p.braking = 0.5;
            put(slot, p, options, of);
        } else if (of <= 9) {  // thin: the hand's side depends on the previous cycle
            Box b{.center = to_plain(uniform(rng, 0, 0.02) * direction(rng)),
                  .half_size = {0.01, 0.01, 0},
                  .stiffness = 300};
            put(slot, b, options, of);
        } else if (of <= 11) {
            Sphere s{.center = to_plain(uniform(rng, 0.005, 0.03) * direction(rng)),
                     .radius = 0.005,
                     .stiffness = 300};
            if (of >= 10)  // towards the hand
                s.velocity = {-2 * s.center.x, -2 * s.center.y, -2 * s.center.z};
            put(slot, s, options, of);
        } else if (of == 12) {
            put(slot, Spring{.anchor = {0.01, 0, 0}, .stiffness = 20.0 * between(rng, 0, 2)}, options, of);
        } else if (of <= 14) {
            put(slot,
                Magnet{.position = to_plain(uniform(rng, 0.005, 0.05) * direction(rng)),
                       .stiffness = 100.0 * between(rng, 0, 2),
                       .max_force = 0.2,
                       .max_distance = 0.006},
                options, of);
        } else if (of == 15) {
            put(slot,
                Taylor{.origin = to_plain(uniform(rng, 0.005, 0.05) * direction(rng)),
                       .force = {0.5, 0, 0},
                       .radius = 0.008},
                options, of);
        } else if (of == 16) {
            put(slot, Vibration{.amplitude = 0.5 * between(rng, 0, 1), .frequency = 30}, options, of);
        } else if (of == 17) {
            put(slot,
                Cap{.foot = to_plain(uniform(rng, 0.005, 0.03) * Vector(0.3, 0, -1)),
                    .curvature = uniform(rng, -20, 20),
                    .stiffness = 200.0 * between(rng, 0, 2)},
                options, of);
        } else {
            put(slot,
                HalfPlane{.normal = {0, 0, 1},
                          .offset = uniform(rng, -0.02, 0.02),
                          .edge_offset = uniform(rng, -0.02, 0.02),
                          .stiffness = 200},
                options, of);
        }
    }
};

TEST(SleepingScene, IsEvaluatedSeldomAndNobodyCanTell) {
    long left_out = 0, felt = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Rng rng(seed);
        Twins twins;
        Left left(twins.left_out);
        const double swift = seed % 4 == 0 ? 12 : 1;
        double silent = 0, reach = 0.01;
        Kept kept;
        Probe hand;
        for (int cycle = 0; cycle < 6000; ++cycle) {
            if (between(rng, 0, 150) == 0) twins.change(rng);
            if (between(rng, 0, 2000) == 0) silent = silent > 0 ? 0 : 1e-3;
            if (between(rng, 0, 1000) == 0) reach = between(rng, 0, 2) == 0 ? 0 : uniform(rng, 0, 0.02);
            if (between(rng, 0, 1500) == 0) {
                const ProbePlacement placement{.offset = {}, .radius = uniform(rng, 0, 2e-3)};
                for (Scene* scene : {&twins.evaluated, &twins.left_out})
                    ASSERT_TRUE(scene->place_probe(0, placement));
            }
            if (silent > 0) silent += 1e-3;
            const double t = 1e-3 * cycle;
            const Eigen::Vector3d before = hand.position;
            const double dt = between(rng, 0, 300) == 0 ? 0 : uniform(rng, 0.9e-3, 1.1e-3);
            hand.position = reach * Eigen::Vector3d(std::sin(swift * 3 * t), std::cos(swift * 2 * t),
                                                    std::sin(swift * 5 * t));
            hand.velocity = hand.smooth_velocity = (hand.position - before) / 1e-3;
            for (Scene* scene : {&twins.evaluated, &twins.left_out}) scene->set_silence(silent);
            const Wrench expected = twins.evaluated.evaluate(hand, dt);
            const Wrench found = left.evaluate(hand, dt, silent > 0);
            ASSERT_EQ(found.force, expected.force) << "cycle " << cycle;
            ASSERT_EQ(found.torque, expected.torque) << "cycle " << cycle;
            ASSERT_EQ(twins.left_out.load().contacts, twins.evaluated.load().contacts);
            felt += expected.force != Eigen::Vector3d::Zero();
            kept.take(twins.evaluated);
            ASSERT_TRUE(left.made || !kept.written) << "cycle " << cycle << ": there was something to tell";
            ASSERT_EQ(left.kept.size, kept.size);
            for (std::size_t i = 0; i < kept.size; ++i)
                ASSERT_EQ(std::memcmp(&left.kept.entries[i], &kept.entries[i], sizeof(Feedback)), 0)
                    << "cycle " << cycle;
        }
        left_out += left.many;
    }
    EXPECT_GT(left_out, 20'000);
    EXPECT_GT(felt, 20'000);
}

TEST(SleepingScene, KnowsASilenceThatBeganMeanwhile) {
    // A surface that holds is stopped by the silence, also one that is added late in it.
    Twins twins;
    Left left(twins.left_out);
    Probe hand;
    Wrench expected, found;
    twins.put(0, Plane{.offset = -0.02, .stiffness = 100}, {.on_silence = OnSilence::hold}, 1);
    for (int cycle = 0; cycle < 2000; ++cycle) {
        if (cycle == 1000)
            twins.put(1, Plane{.offset = 0.01, .velocity = {0, 0, 0.1}, .stiffness = 100, .damping = 5},
                      {.on_silence = OnSilence::hold}, 2);
        for (Scene* scene : {&twins.evaluated, &twins.left_out})
            scene->set_silence(cycle < 500 ? 0 : 1e-3 * (cycle - 499));
        expected = twins.evaluated.evaluate(hand, 1e-3);
        found = left.evaluate(hand, 1e-3, cycle >= 500);
        ASSERT_EQ(found.force, expected.force) << "cycle " << cycle;
    }
    EXPECT_GT(expected.force.norm(), 0.1);
    EXPECT_GT(left.many, 500);
}

TEST(SleepingScene, IsNoneThatIsFeltFadesMovesOrIsEvaluatedInEachCycle) {
    const auto within = [](auto... reps) {
        Scene scene({.representations = 4, .probes = 1}, {.period = 1e-3});
        std::uint32_t slot = 0;
        (static_cast<void>(scene.add({slot++, 1}, reps)), ...);
        scene.settle();
        Probe hand;
        Kept kept;
        for (int i = 0; i < 100; ++i) {
            scene.evaluate(hand, 1e-3);
            kept.take(scene);
        }
        return scene.sleep_radius();
    };
    EXPECT_NEAR(within(Plane{.offset = -0.02, .stiffness = 100}), 0.02, 1e-6);
    EXPECT_NEAR(within(Plane{.offset = -0.02, .stiffness = 100}, Plane{.offset = -0.01, .stiffness = 50}),
                0.01, 1e-6);
    EXPECT_EQ(within(Plane{.offset = 0.001, .stiffness = 100}), 0) << "felt";
    EXPECT_EQ(within(Plane{.offset = -0.02, .stiffness = 100}, Spring{.anchor = {1, 0, 0}, .stiffness = 5}),
              0)
        << "a spring is evaluated in each cycle";
    EXPECT_EQ(within(Plane{.offset = -0.02, .velocity = {0, 0, 1e-6}, .stiffness = 100}), 0) << "it moves";
    EXPECT_GT(within(Plane{.offset = -0.02, .stiffness = 100}, Spring{.anchor = {1, 0, 0}, .stiffness = 0}),
              0.019)
        << "a spring that gives nothing is not";
    EXPECT_GT(within(Magnet{.position = {1, 0, 0}, .stiffness = 100, .max_force = 1}, ConstantForce{}), 1e-3);
    EXPECT_EQ(within(Magnet{.position = {0.01, 0, 0}, .stiffness = 100, .max_force = 1}), 0) << "felt";
    const Sphere far{.center = {0.5, 0, 0}, .radius = 0.01, .stiffness = 100};
    EXPECT_GT(within(far), 1e-3);
    Sphere coming = far;
    coming.velocity = {-0.1, 0, 0};
    EXPECT_EQ(within(coming), 0) << "it will be here, though the hand rests";
}

}  // namespace

}  // namespace sleeping_scene_tests
