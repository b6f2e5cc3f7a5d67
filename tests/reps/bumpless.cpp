// No update makes a jump above |F_new - F_old| dt / T, for any change, at any rate, at any moment.

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

struct Entry {
    bool present = false;
    std::uint32_t generation = 0;
    Plane plane;
};

Plane random_plane(Rng& rng, double recovery) {
    return {.normal = to_plain(direction(rng)),
            .offset = uniform(rng, -0.003, 0.003),
            .stiffness = 500.0 * between(rng, 0, 4),
            .recovery = recovery};
}

/// Changes some of the planes at random; returns whether anything changed.
bool disturb(Rng& rng, Scene& scene, std::vector<Entry>& entries, double recovery) {
    bool changed = false;
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
        Entry& e = entries[i];
        switch (between(rng, 0, 4)) {
            case 0:
                if (!e.present) {
                    e.plane = random_plane(rng, recovery);
                    EXPECT_TRUE(scene.add({i, ++e.generation}, e.plane));
                    e.present = changed = true;
                }
                break;
            case 1:
                if (e.present) {
                    EXPECT_TRUE(scene.remove({i, e.generation}));
                    e.present = false;
                    changed = true;
                }
                break;
            case 2:
                if (e.present) {
                    e.plane = random_plane(rng, recovery);
                    EXPECT_TRUE(scene.update({i, e.generation}, e.plane));
                    changed = true;
                }
                break;
            default:
                break;
        }
    }
    return changed;
}

Vector alone(const std::vector<Entry>& entries, const Probe& probe, const Limits& limits) {
    Scene scene = make_scene(limits);
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
        if (entries[i].present) {
            EXPECT_TRUE(scene.add({i, 1}, entries[i].plane));
        }
    }
    return settled(scene, probe).force;
}

}  // namespace

TEST(Bumpless, PlanesThatChangeInEveryCycleAtAnyAngle) {
    const std::uint64_t seed = 404;
    constexpr double recovery = 0.02;
    for (int round = 0; round < (long_form() ? 500 : 40); ++round) {
        Rng rng(seed + static_cast<std::uint64_t>(round));
        const Limits limits{.max_force = 8.5};
        Scene scene = make_scene(limits);
        std::vector<Entry> entries(static_cast<std::size_t>(between(rng, 1, 6)));
        const int every = between(rng, 1, 7);
        Vector last = Vector::Zero();
        Vector p = 0.003 * direction(rng);
        double k = 0;  // N/m, the stiffest that is in the scene, or was until recently
        for (int i = 0; i < 300; ++i) {
            const Vector before = p;
            if (between(rng, 0, 1)) p += 1e-4 * direction(rng);
            if (p.norm() > 0.006) p *= 0.5;
            if (i % every == 0) disturb(rng, scene, entries, recovery);
            for (const Entry& e : entries) k = std::max(k, e.plane.stiffness);
            const Vector force = scene.evaluate(at(p), dt).force;
            const double motion = k * (p - before).norm();
            const Vector goal = alone(entries, at(p), limits);
            const double allowed = motion + ((goal - last).norm() + motion) * dt / recovery;
            // A fade under way moves by its initial difference, which is no larger than |goal| plus the
            // clamp.
            const double under_way = motion + (goal.norm() + limits.max_force) * dt / recovery;
            ASSERT_LE((force - last).norm(),
                      (i % every == 0 ? std::max(allowed, under_way) : under_way) + 1e-12)
                << "seed " << seed + static_cast<std::uint64_t>(round) << " cycle " << i;
            last = force;
        }
    }
}

TEST(Bumpless, TheFirstCycleOfAChangeIsBoundedByItsOwnDifference) {
    // The strict bound, for changes that interrupt a fade and others, at a hand that is held still.
    const std::uint64_t seed = 505;
    constexpr double recovery = 0.02;
    Rng rng(seed);
    for (int round = 0; round < (long_form() ? 20'000 : 2'000); ++round) {
        Scene scene = make_scene();
        std::vector<Entry> entries(4);
        const Probe probe = at(0.002 * direction(rng));
        Vector last = Vector::Zero();
        for (int change = 0; change < 4; ++change) {
            const bool changed = disturb(rng, scene, entries, recovery);
            const Vector goal = alone(entries, probe, {});
            Vector force = scene.evaluate(probe, dt).force;
            if (changed) {
                ASSERT_LE((force - last).norm(), (goal - last).norm() * dt / recovery * (1 + 1e-9) + 1e-12)
                    << "seed " << seed << " round " << round << " change " << change;
            }
            for (int i = 0; i < between(rng, 0, 25); ++i) force = scene.evaluate(probe, dt).force;
            last = force;
        }
    }
}

TEST(Bumpless, EverythingArrivesInTheEnd) {
    const std::uint64_t seed = 606;
    Rng rng(seed);
    for (int round = 0; round < 500; ++round) {
        Scene scene = make_scene();
        std::vector<Entry> entries(5);
        const Probe probe = at(0.003 * direction(rng));
        for (int i = 0; i < 50; ++i) {
            disturb(rng, scene, entries, 0.01);
            scene.evaluate(probe, dt);
        }
        for (int i = 0; i < 12; ++i) scene.evaluate(probe, dt);
        const Vector goal = alone(entries, probe, {});
        ASSERT_LE((scene.evaluate(probe, dt).force - goal).norm(), 1e-12 * (1 + goal.norm()) * 100)
            << "seed " << seed << " round " << round;
    }
}

TEST(Bumpless, SlotsThatChangeTheirKindAndProbe) {
    const std::uint64_t seed = 707;
    constexpr double time = 0.02;
    for (int round = 0; round < 60; ++round) {
        Rng rng(seed + static_cast<std::uint64_t>(round));
        const Limits limits{.max_force = 8.5, .max_torque = 1};
        Scene scene = make_scene(limits);
        ASSERT_TRUE(scene.place_probe(1, {.offset = {0.01, 0, 0}}));
        std::uint32_t generation = 0;
        const Probe probe = at(0.003 * direction(rng));
        Vector last = Vector::Zero();
        bool present = false;
        for (int i = 0; i < 400; ++i) {
            if (between(rng, 0, 2) == 0) {
                if (present) {
                    ASSERT_TRUE(scene.remove({0, generation}));
                }
                present = between(rng, 0, 3) > 0;
                const AddOptions options{.probe = static_cast<std::uint32_t>(between(rng, 0, 1))};
                if (present) {
                    ++generation;
                    const int kind = between(rng, 0, 2);
                    if (kind == 0) {
                        ASSERT_TRUE(scene.add({0, generation}, random_plane(rng, time), options));
                    }
                    if (kind == 1) {
                        ASSERT_TRUE(scene.add({0, generation},
                                              Spring{.anchor = to_plain(0.02 * direction(rng)),
                                                     .stiffness = 200,
                                                     .duration = time},
                                              options));
                    }
                    if (kind == 2) {
                        ASSERT_TRUE(scene.add(
                            {0, generation},
                            ConstantForce{.force = to_plain(3 * direction(rng)), .recovery = time}, options));
                    }
                }
            }
            const Vector force = scene.evaluate(probe, dt).force;
            ASSERT_TRUE(force.allFinite());
            // The two probes' sets and one effect's fade each move by at most the two clamps' difference.
            ASSERT_LE((force - last).norm(), 3 * 2 * limits.max_force * dt / time + 1e-12)
                << "seed " << seed + static_cast<std::uint64_t>(round) << " cycle " << i;
            last = force;
        }
        if (present) {
            ASSERT_TRUE(scene.remove({0, generation}));
        }
        for (int i = 0; i < 25; ++i) last = scene.evaluate(probe, dt).force;
        EXPECT_EQ(last.norm(), 0.0) << "nothing of it stays behind";
    }
}

TEST(Bumpless, AProbeThatIsPlacedElsewhere) {
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000}));
    const Probe probe = at({0, 0, -0.001});
    Vector last = settled(scene, probe).force;
    ASSERT_TRUE(scene.place_probe(0, {.offset = {0, 0, -0.004}}));
    for (int i = 1; i <= 12; ++i) {
        const Vector force = scene.evaluate(probe, dt).force;
        EXPECT_NEAR(force.z(), 1 + 4 * std::min(1.0, i / 10.0), 1e-9);
        last = force;
    }
}
