// Culling changes nothing: compares a scene of bounded surfaces with the same scene in which every surface is
// evaluated in every cycle.

#include <algorithm>
#include <array>

#include <knurl/reps/box.hpp>
#include <knurl/reps/capsule.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/polygon.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/torus.hpp>

#include "../reps/scene_pair.hpp"
#include "judge.hpp"

using namespace judge;
using knurl::Feedback;

namespace culling_tests {
namespace {

template <class R>
void any_material(Rng& rng, R& r) {
    r.stiffness = rng.of(400, 800, 800, 1500);
    r.damping = rng.one_in(3) ? 2 : 0;
    r.recovery = rng.of(-1, 0, 0.002, 0.02);
}

knurl::Box any_box(Rng& rng, const Vector& p, double size) {
    const Eigen::Quaterniond q = rng.orientation();
    knurl::Box box{
        .center = knurl::to_plain(p),
        .orientation = {q.w(), q.x(), q.y(), q.z()},
        .half_size = {rng.uniform(0.1, 1) * size, rng.uniform(0.1, 1) * size, rng.uniform(0.1, 1) * size}};
    any_material(rng, box);
    return box;
}

knurl::Polygon any_polygon(Rng& rng, const Vector& p, double size) {
    knurl::Polygon polygon;
    const Vector n = rng.direction(), u = rng.across(n), v = n.cross(u);
    polygon.vertices.count = static_cast<std::uint32_t>(rng.between(3, 8));
    for (std::uint32_t i = 0; i < 8; ++i) {
        const double angle = 2 * M_PI * i / polygon.vertices.count;
        const Vector x = p + size * (std::cos(angle) * u + std::sin(angle) * v);
        polygon.vertices.at[i] = i < polygon.vertices.count ? knurl::to_plain(x) : knurl::Vec3{};
    }
    polygon.sides = rng.one_in(2) ? knurl::Sides::both : knurl::Sides::front;
    any_material(rng, polygon);
    return polygon;
}

template <class R>
R placed(Rng& rng, R r, const Vector& p) {
    r.center = knurl::to_plain(p);
    any_material(rng, r);
    return r;
}

struct Slot {
    int kind = -1;  // none
    std::uint32_t generation = 0;
};

struct World {
    static constexpr double cube = 0.1;  // m, half of it
    Rng& rng;
    knurl::test::ScenePair pair;
    std::vector<Slot> slots;
    std::uint32_t probes;

    World(Rng& r, std::uint32_t surfaces)
        : rng(r),
          pair({surfaces, 3}, {.max_stiffness = 2000, .max_force = 20}, {}),
          slots(surfaces),
          probes(static_cast<std::uint32_t>(r.between(1, 3))) {}

    Vector anywhere() {
        return {rng.uniform(-cube, cube), rng.uniform(-cube, cube), rng.uniform(-cube, cube)};
    }
    double any_size() { return rng.one_in(10) ? rng.uniform(0.01, 0.05) : rng.uniform(0.001, 0.01); }

    template <class Act>
    bool act_with(int kind, const Vector& p, Act&& act) {
        switch (kind) {
            case 0:
                return act(any_box(rng, p, any_size()));
            case 1:
                return act(any_polygon(rng, p, any_size()));
            case 2:
                return act(placed(rng,
                                  knurl::Capsule{.axis = knurl::to_plain(rng.direction()),
                                                 .half_length = any_size(),
                                                 .radius = any_size()},
                                  p));
            case 3:
                return act(placed(rng,
                                  knurl::Cylinder{.axis = knurl::to_plain(rng.direction()),
                                                  .radius = any_size(),
                                                  .half_length = any_size()},
                                  p));
            case 4: {
                const double ring = any_size();
                return act(placed(rng,
                                  knurl::Torus{.axis = knurl::to_plain(rng.direction()),
                                               .radius = ring,
                                               .tube = rng.uniform(0.1, 0.9) * ring},
                                  p));
            }
            default:
                return act(placed(rng, knurl::Sphere{.radius = any_size()}, p));
        }
    }
    static constexpr int kinds = 8;  // more spheres than others

    bool put(std::uint32_t i, const Vector& p) {
        Slot& s = slots[i];
        if (s.kind < 0) {
            s.kind = rng.between(0, kinds - 1);
            ++s.generation;
            const std::uint32_t probe =
                static_cast<std::uint32_t>(rng.between(0, static_cast<int>(probes) - 1));
            return act_with(s.kind, p, [&](const auto& surface) {
                return pair.add({i, s.generation}, surface, {.probe = probe});
            });
        }
        return act_with(s.kind, p, [&](const auto& surface) {
            return pair.update({i, s.generation}, surface);
        });
    }
    bool take(std::uint32_t i) {
        Slot& s = slots[i];
        if (s.kind < 0) return true;
        s.kind = -1;
        return pair.remove({i, s.generation});
    }
};

bool has_flag(const Scene& scene, std::uint32_t flag) {
    std::array<Feedback, 2048> feedback;
    const std::size_t n = scene.feedback(feedback);
    return std::any_of(feedback.begin(), feedback.begin() + n,
                       [&](const Feedback& f) { return (f.flags & flag) != 0; });
}

struct Figures {
    std::uint64_t cycles = 0, felt = 0, skipped = 0, evaluated = 0, contradicting = 0;
};

/// For a case that is run again: prints which surfaces differ.
void tell(const World& w, int cycle, double dt, const Probe& hand) {
    std::printf("cycle %d dt %g at %g %g %g\n", cycle, dt, hand.position.x(), hand.position.y(),
                hand.position.z());
    std::vector<Feedback> one(w.slots.size()), other(w.slots.size());
    const std::size_t n = w.pair.skipping.feedback(one);
    w.pair.exhaustive.feedback(other);
    for (std::size_t j = 0; j < n; ++j) {
        const Vector f = one[j].wrench.force, g = other[j].wrench.force;
        if (f.isZero(0) && g.isZero(0)) continue;
        std::printf("  slot %u kind %d: %g %g %g flags %u against %g %g %g flags %u\n", one[j].id.slot,
                    w.slots[one[j].id.slot].kind, f.x(), f.y(), f.z(), one[j].flags, g.x(), g.y(), g.z(),
                    other[j].flags);
    }
}

void judge_culling(Case& c, std::uint32_t surfaces, int cycles, Figures& figures) {
    Rng& rng = c.rng;
    World w(rng, surfaces);
    for (std::uint32_t i = 0; i < w.probes; ++i) {
        const knurl::ProbePlacement placement{
            .offset = knurl::to_plain(i == 0 ? Vector(0, 0, 0) : Vector(0.03 * rng.direction())),
            .radius = rng.one_in(2) ? 0 : rng.uniform(0, 0.008)};
        c.require(w.pair.place_probe(i, placement), "placed");
    }
    for (std::uint32_t i = 0; i < surfaces; ++i) {
        if (!rng.one_in(5)) c.require(w.put(i, w.anywhere()), "added");
    }
    w.pair.settle();
    if (rng.one_in(2)) w.pair.skipping.index();

    Probe hand = at(w.anywhere());
    Vector velocity = rng.scale(0.01, 1) * rng.direction();
    for (int i = 0; i < cycles; ++i) {
        const double dt = rng.one_in(20) ? rng.of(1e-6, 0.01) : 1e-3;
        if (rng.one_in(50)) velocity = rng.scale(0.001, 2) * rng.direction();
        if (rng.one_in(300)) {
            hand.position = w.anywhere();  // a teleport
        } else {
            hand.position += 1e-3 * velocity;
        }
        for (int j = 0; j < 3; ++j) {
            if (std::abs(hand.position[j]) > World::cube)
                velocity[j] = -std::copysign(velocity[j], hand.position[j]);
        }
        hand.velocity = hand.smooth_velocity = velocity;
        if (rng.one_in(3))
            hand.orientation = (hand.orientation * Eigen::Quaterniond(1, 0.001, 0, 0)).normalized();
        if (rng.one_in(4)) {
            // Every second change is near the hand, where surfaces that move matter most.
            const Vector p = rng.one_in(2) ? w.anywhere() : Vector(hand.position + 0.01 * rng.direction());
            const std::uint32_t which =
                static_cast<std::uint32_t>(rng.between(0, static_cast<int>(surfaces) - 1));
            c.require(rng.one_in(4) ? w.take(which) : w.put(which, p), "changed");
        }
        if (rng.one_in(2000)) w.pair.skipping.index();
        const Wrench want = w.pair.exhaustive.evaluate(hand, dt), got = w.pair.skipping.evaluate(hand, dt);
        ++figures.cycles;
        figures.felt += want.force.norm() > 0;
        figures.skipped += w.pair.skipping.evaluated();
        figures.evaluated += w.pair.exhaustive.evaluated();
        c.require(finite(got), "finite");
        figures.contradicting += has_flag(w.pair.exhaustive, Feedback::infeasible);
        constexpr Real force = 2000 * 0.3L, size = 0.3L;  // N: largest stiffness times the world's size; m
        if (c.replayed() && (got.force - want.force).norm() > 1e-9) tell(w, i, dt, hand);
        c.require(!(want.force.norm() > 1e-3) || got.force.norm() > 0, "no contact is missed");
        c.compare(got.force, real(want.force), force);
        c.compare(got.torque, real(want.torque), size * force);
        if (rng.one_in(20)) c.compare(w.pair.skipping.evaluate(hand, 0).force, real(got.force), force);
        if (!(c.worst() <= bound)) return;
    }
}

}  // namespace

TEST(Culling, AnswersAsIfEverySurfaceWereEvaluated) {
    Figures figures;
    // A million cycles in the long form.
    run(
        "culling, 40 surfaces", 25, [&](Case& c) { judge_culling(c, 40, 500, figures); }, bound, 1100);
    run(
        "culling, 300 surfaces", 12, [&](Case& c) { judge_culling(c, 300, 1000, figures); }, bound, 400);
    run(
        "culling, 2000 surfaces", 3, [&](Case& c) { judge_culling(c, 2000, 500, figures); }, bound, 100);
    std::printf(
        "%llu cycles, felt in %llu, contradicting in %llu; evaluated %.1f a cycle instead of %.1f\n",
        static_cast<unsigned long long>(figures.cycles), static_cast<unsigned long long>(figures.felt),
        static_cast<unsigned long long>(figures.contradicting),
        double(figures.skipped) / double(figures.cycles), double(figures.evaluated) / double(figures.cycles));
    if (figures.cycles > 10'000) {
        EXPECT_GT(figures.felt * 10, figures.cycles) << "a test that hardly touches anything";
        EXPECT_LT(figures.skipped * 5, figures.evaluated) << "a test in which hardly anything is skipped";
    }
}

}  // namespace culling_tests
