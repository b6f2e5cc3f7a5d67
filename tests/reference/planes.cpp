// Planes: joint, of unequal stiffness, damped, contradictory, by sum, with a velocity, while they fade, after
// the paper.

#include "plane_scenes.hpp"

using namespace judge;
using knurl::Plane;

namespace {

void add_all(Case& c, Scene& scene, const std::vector<Plane>& planes, std::uint32_t probe = 0) {
    for (std::uint32_t i = 0; i < planes.size(); ++i) {
        c.require(bool(scene.add({i, 1}, planes[i], {.probe = probe})), "a legal plane is taken");
    }
}

exact::V capped(const exact::V& force, Real most) {
    const Real size = exact::length(force);
    return size > most ? (most / size) * force : force;
}

/// The scene's answer at one probe against the reference's.
void check(Case& c, const Wrench& got, const std::vector<Plane>& planes, const exact::V& probe,
           const exact::V& velocity, Real radius, Real moved, const Limits& limits) {
    const auto touches = touches_of(planes, probe, radius, moved, limits.max_stiffness);
    const Real rounding = 4e-15L * std::max(reach_of(planes, probe, {}), radius);
    const exact::Push want = exact::push(touches, velocity, rounding);
    Real reach = std::max({reach_of(planes, probe, want), radius}), damping = 0,
         speed = exact::length(velocity);
    for (const Plane& p : planes) {
        damping = std::max(damping, Real(p.damping));
        speed = std::max(speed, exact::length(velocity - real(p.velocity)));
        reach = std::max(reach, moved * exact::length(real(p.velocity)));
    }
    const Real scale = std::max(want.stiffness, Real(1e-300L)) * reach + damping * speed;
    c.require(finite(got), "finite");
    // Planes that contradict each other give way by what leaves a point, and 1e-11 m for rounding.
    const Real room =
        want.give > -1e-9L * reach && want.give != 0 ? want.stiffness * 1e-10L / want.sharpness : 0;
    // Damping acts along F and by the planes' weights, both as uncertain as rounding is large beside them;
    // weights in a contradiction depend on how far exactly the planes have given way.
    const Real turn = 4 * want.stiffness * rounding / (want.sharpness * want.sharpness) / want.undamped;
    bool touched = false;
    for (const exact::Touch& t : touches) touched = touched || t.height < rounding;
    const Real damped =
        touched ? damping * speed * (room > 0 || want.undamped <= 0 ? 1 : std::min(Real(1), turn)) : 0;
    c.compare_within(got.force, capped(want.force, limits.max_force),
                     (want.most - want.least) / 2 + room + damped, scale, want.sharpness);
    const Real felt = exact::length(real(got.force));
    c.require(felt <= limits.max_force * (1 + 1e-12L), "at most the device's force");
    if (c.replayed()) {
        for (const exact::Touch& t : touches) {
            c.say("  n %.6Lg %.6Lg %.6Lg height %.9Lg k %Lg b %Lg\n", t.normal.x, t.normal.y, t.normal.z,
                  t.height, t.stiffness, t.damping);
        }
        c.say("  give %Lg sharpness %Lg least %Lg most %Lg reach %Lg\n", want.give, want.sharpness,
              want.least, want.most, reach);
    }
    if (damping == 0 && room == 0)
        c.require(felt <= want.stiffness * exact::length(want.dx) * (1 + 1e-12L) + room +
                              1e-12L * scale / want.sharpness,
                  "no stiffer than the stiffest");
    c.require(got.torque.norm() == 0, "no torque from the tip");
}

}  // namespace

TEST(Planes, SolvedTogether) {
    run("planes, joint", 60'000, [](Case& c) {
        const PlaneScene s = any_planes(c.rng);
        Scene scene({16, 1}, {});
        add_all(c, scene, s.planes);
        scene.settle();
        Vector probe = s.probe;
        for (int i = 0; i < 3; ++i) {  // cold, then from the last cycle's answer
            check(c, scene.evaluate(at(probe), any_step(c.rng)), s.planes, real(probe), {}, 0, 0, {});
            probe += c.rng.scale(1e-6, 1) * s.size * c.rng.direction();
        }
    });
}

TEST(Planes, OfUnequalStiffnessDampedFeltByAThickProbeWithinLimits) {
    run("planes, layered and damped", 60'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s = any_planes(rng);
        Limits limits;
        if (rng.one_in(2)) limits.max_stiffness = rng.uniform(500, 3000);
        if (rng.one_in(4)) limits.max_force = rng.uniform(0.1, 10);
        const double ks[] = {rng.uniform(1, 3000), rng.uniform(1, 3000), rng.scale(1e-3, 1e5),
                             rng.one_in(2) ? infinity : 0};
        for (Plane& p : s.planes) {
            p.stiffness = ks[rng.between(0, 3)];
            p.damping = rng.one_in(2) ? 0 : rng.uniform(0, 20);
        }
        Probe hand = at(s.probe, rng.uniform(0, 0.5) * rng.direction());
        const double radius = rng.one_in(2) ? 0 : rng.scale(1e-5, 1e-2);
        Scene scene({16, 1}, limits);
        c.require(bool(scene.place_probe(0, {.offset = {}, .radius = radius})), "placed");
        add_all(c, scene, s.planes);
        scene.settle();
        for (int i = 0; i < 2; ++i) {
            check(c, scene.evaluate(hand, any_step(rng)), s.planes, real(hand.position), real(hand.velocity),
                  radius, 0, limits);
            hand.position += rng.scale(1e-6, 1) * s.size * rng.direction();
        }
    });
}

TEST(Planes, ThatContradictEachOtherGiveWayByTheLeastThatLeavesAPoint) {
    run("planes, contradictory", 20'000, [](Case& c) {
        const PlaneScene s = any_planes(c.rng, false);
        Scene scene({16, 1}, {});
        add_all(c, scene, s.planes);
        scene.settle();
        Vector probe = s.probe;
        for (int i = 0; i < 3; ++i) {
            check(c, scene.evaluate(at(probe), any_step(c.rng)), s.planes, real(probe), {}, 0, 0, {});
            const exact::Push want = exact::push(touches_of(s.planes, real(probe)), {});
            knurl::Feedback feedback;
            scene.feedback({&feedback, 1});
            c.require(want.give < 1e-9L || (feedback.flags & knurl::Feedback::infeasible), "flagged");
            probe += c.rng.scale(1e-6, 1) * s.size * c.rng.direction();
        }
    });
}

TEST(Planes, BySumAddTheirForces) {
    run("planes, by sum", 40'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s = any_planes(rng);
        std::vector<Plane> joint, summed;
        for (Plane& p : s.planes) {
            p.stiffness = rng.uniform(1, 3000);
            p.damping = rng.one_in(2) ? 0 : rng.uniform(0, 20);
            if (rng.one_in(4)) {
                p.damping = 0, p.stiffness = 500;
                joint.push_back(p);
            } else {
                p.combine = knurl::PlaneCombine::sum;
                summed.push_back(p);
            }
        }
        Scene scene({16, 1}, {});
        std::vector<Plane> all = joint;
        all.insert(all.end(), summed.begin(), summed.end());
        add_all(c, scene, all);
        scene.settle();
        for (int i = 0; i < 2; ++i) {
            const Probe hand = at(s.probe, rng.uniform(0, 0.5) * rng.direction());
            const Wrench got = scene.evaluate(hand, any_step(rng));
            const exact::V p = real(hand.position), v = real(hand.velocity);
            const exact::Push together = exact::push(touches_of(joint, p), v);
            const auto touches = touches_of(summed, p);
            Real stiffness = together.stiffness, damping = 0, parts = exact::length(together.force),
                 rounding = 0;
            const Real reach = reach_of(s.planes, p, together);
            for (const exact::Touch& t : touches) {
                stiffness += t.stiffness, damping += t.damping;
                parts += std::max(Real(0), -t.height * t.stiffness) + t.damping * exact::length(v);
                // Damping begins at depth 0 with a step: where rounding decides on which side the probe is.
                if (std::fabs(t.height) < 1e-15L * reach) rounding += t.damping * exact::length(v);
            }
            c.compare_within(got.force, together.force + exact::summed(touches, v), rounding,
                             stiffness * reach + damping * exact::length(v), together.sharpness);
            c.require(exact::length(real(got.force)) <=
                          parts * (1 + 1e-12L) + 1e-12L * stiffness * reach / together.sharpness,
                      "no more than its parts");
            s.probe += rng.scale(1e-6, 1) * s.size * rng.direction();
        }
    });
}

TEST(Planes, WithAVelocityMoveOnBetweenUpdates) {
    run("planes, moving", 20'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s = any_planes(rng);
        const Vector together = rng.scale(1e-4, 1) * rng.direction();
        const bool one = rng.one_in(2);
        for (Plane& p : s.planes)
            p.velocity = knurl::to_plain(one ? together : Vector(rng.scale(1e-4, 1) * rng.direction()));
        const bool damped = one && rng.one_in(2);
        for (Plane& p : s.planes) p.damping = damped ? 10 : 0;
        Scene scene({16, 1}, {});
        add_all(c, scene, s.planes);
        scene.settle();
        Real moved = 0;
        bool started = false;
        for (int i = 0; i < 5; ++i) {
            const double dt = any_step(rng);
            if (i > 0 && started)
                moved += dt;  // in the first cycle that takes time it stands where it was placed
            started = started || dt > 0;
            const Probe hand = at(s.probe, rng.uniform(0, 0.5) * rng.direction());
            c.say("dt %g moved %Lg\n", dt, moved);
            check(c, scene.evaluate(hand, dt), s.planes, real(s.probe), real(hand.velocity), 0, moved, {});
            s.probe += rng.scale(1e-6, 1) * s.size * rng.direction();
        }
    });
}

namespace {

/// One change of a set: some planes updated, some removed, one added.
struct Change {
    std::vector<Plane> before, after;
    Real time = 0;  // s, the longest recovery of what changed

    Change(Rng& rng, Scene& scene, Case& c, const PlaneScene& s, Real automatic, bool at_once) {
        before = s.planes;
        const auto recovery = [&] {
            const double T = at_once ? 0 : rng.of(-1, 0, 0.002, 0.01, 0.3);
            time = std::max(time, T < 0 ? automatic : Real(T));
            return T;
        };
        for (std::uint32_t i = 0; i < before.size(); ++i) {
            switch (rng.between(0, 3)) {
                case 0: {  // it changes a little, or altogether
                    Plane next = before[i];
                    next.normal = knurl::to_plain(knurl::to_eigen(next.normal) +
                                                  rng.scale(1e-6, 0.5) * rng.direction());
                    next.offset += s.size * rng.scale(1e-6, 1) * rng.uniform(-1, 1);
                    next.recovery = recovery();
                    c.require(bool(scene.update({i, 1}, next)), "updated");
                    after.push_back(next);
                    break;
                }
                case 1: {  // it goes, in the time that it was given with its own parameters
                    time =
                        std::max(time, Real(before[i].recovery < 0 ? automatic : Real(before[i].recovery)));
                    c.require(bool(scene.remove({i, 1})), "removed");
                    break;
                }
                default:
                    after.push_back(before[i]);
            }
        }
        if (rng.one_in(2)) {
            Plane more{.normal = knurl::to_plain(rng.direction()), .stiffness = before[0].stiffness};
            more.offset = knurl::to_eigen(more.normal).dot(s.probe) + s.size * rng.uniform(-1, 0.5);
            more.recovery = recovery();
            c.require(bool(scene.add({15, 1}, more)), "added");
            after.push_back(more);
        }
    }
};

struct Felt {
    exact::V force;
    Real depth, scale, sharpness, give;
};
Felt felt(const std::vector<Plane>& planes, const Vector& probe, const Limits& limits) {
    const exact::V p = real(probe);
    const exact::Push push = exact::push(touches_of(planes, p, 0, 0, limits.max_stiffness), {});
    return {capped(push.force, limits.max_force), exact::length(push.dx),
            push.stiffness * std::max(reach_of(planes, p, push), exact::length(p)), push.sharpness,
            push.give};
}

}  // namespace

TEST(Planes, AnyChangeIsFadedFromTheOldSetToTheNew) {
    run("planes, cross-faded", 30'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s;
        do s = any_planes(rng);
        while (s.planes.size() > 8);
        const bool rises = rng.one_in(2), at_once = rng.one_in(8);
        for (Plane& p : s.planes) {
            p.stiffness = rises ? 800 : rng.of(200, 800, 1500, 2500);
            p.recovery = at_once ? 0 : rng.of(0, 0.004);
        }
        Limits limits;
        if (rng.one_in(4)) limits.max_force = rng.uniform(0.1, 10);
        const Real automatic = rng.of(0.01, 0.003);
        Scene scene({16, 1}, limits);
        scene.set_fade({.automatic = static_cast<double>(automatic), .rise_speed = rises ? 0.1 : infinity});
        add_all(c, scene, s.planes);
        scene.settle();
        scene.evaluate(at(s.probe), any_step(rng));
        const Change change(rng, scene, c, s, automatic, at_once);
        Real T = change.time, elapsed = 0;
        for (int i = 0; i < 5; ++i) {
            s.probe += (i == 0 ? 0 : rng.scale(1e-6, 0.1)) * s.size * rng.direction();
            const Felt before = felt(change.before, s.probe, limits),
                       after = felt(change.after, s.probe, limits);
            if (before.give != 0 || after.give != 0)
                return c.skip();  // contradictions have a test of their own
            if (i == 0 && rises && T > 0) T = std::max(T, (after.depth - before.depth) / 0.1L);
            const double dt = any_step(rng);
            elapsed += dt;
            const Real share = T > 0 ? std::min(Real(1), elapsed / T) : 1;
            // A rising surface's time depends on the depths, by rounding / width.
            c.compare(scene.evaluate(at(s.probe), dt).force, (1 - share) * before.force + share * after.force,
                      std::max(before.scale, after.scale), std::min(before.sharpness, after.sharpness));
        }
    });
}

TEST(Planes, AChangeInTheMiddleOfAnotherGoesOnFromThePresentForce) {
    run("planes, a fade overtaken", 15'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s;
        do s = any_planes(rng);
        while (s.planes.size() > 7);
        Scene scene({16, 1}, {});
        scene.set_fade({.automatic = 0.01, .rise_speed = infinity});
        add_all(c, scene, s.planes);
        scene.settle();
        exact::V force = felt(s.planes, s.probe, {}).force;
        Real scale = felt(s.planes, s.probe, {}).scale, sharpness = 1;
        scene.evaluate(at(s.probe), 1e-3);
        std::vector<Plane> planes = s.planes;
        for (std::uint32_t i = 0; i < 3; ++i) {  // the hand stands still: then the old set's force does, too
            const Felt before = felt(planes, s.probe, {});
            planes.push_back(
                {.normal = knurl::to_plain(rng.direction()), .stiffness = 1000, .recovery = 0.01});
            planes.back().offset =
                knurl::to_eigen(planes.back().normal).dot(s.probe) + s.size * rng.uniform(-1, 0.5);
            c.require(bool(scene.add({12 + i, 1}, planes.back())), "added");
            const Felt after = felt(planes, s.probe, {});
            if (before.give != 0 || after.give != 0) return c.skip();
            scale = std::max({scale, after.scale, before.scale});
            sharpness = std::min({sharpness, before.sharpness, after.sharpness});
            const exact::V old = force;
            Real elapsed = 0;
            for (int j = rng.between(1, 3); j > 0; --j) {
                const double dt = rng.of(0, 1e-6, 1e-3, 0.004);
                elapsed += dt;
                const Real share = std::min(Real(1), elapsed / 0.01L);
                force = (1 - share) * old + share * after.force;
                c.compare(scene.evaluate(at(s.probe), dt).force, force, scale, sharpness);
            }
        }
    });
}

TEST(Planes, RecoverAfterThePaperAndWithTheLastDepth) {
    run("planes, paper's recovery", 20'000, [](Case& c) {
        Rng& rng = c.rng;
        PlaneScene s;
        do s = any_planes(rng);
        while (s.planes.size() > 8);
        std::vector<Real> lowered(s.planes.size(), 0), elapsed(s.planes.size(), 0), start(s.planes.size(), 0);
        for (Plane& p : s.planes) {
            p.update = rng.one_in(2) ? knurl::PlaneUpdate::paper : knurl::PlaneUpdate::last_depth;
            p.recovery = rng.of(-1, 0, 0.002, 0.02);
        }
        const auto time_of = [](const Plane& p) { return p.recovery < 0 ? Real(0.05L) : Real(p.recovery); };
        Scene scene({16, 1}, {});
        add_all(c, scene, s.planes);
        scene.settle();
        scene.evaluate(at(s.probe), any_step(rng));
        for (int round = 0; round < 3; ++round) {
            std::vector<Plane> next = s.planes;
            std::vector<bool> changed(next.size());
            for (std::uint32_t i = 0; i < next.size(); ++i) {
                if (!(changed[i] = rng.one_in(2))) continue;
                next[i].offset += s.size * rng.uniform(-0.3, 1) * knurl::to_eigen(next[i].normal).norm();
                c.require(bool(scene.update({i, 1}, next[i])), "updated");
            }
            for (int j = rng.between(1, 3); j > 0; --j) {
                s.probe += rng.scale(1e-6, 0.1) * s.size * rng.direction();
                const double dt = any_step(rng);
                std::vector<exact::Touch> touches;
                for (std::size_t i = 0; i < next.size(); ++i) {
                    exact::Touch t = touch_of(next[i], real(s.probe));
                    const Real T = time_of(next[i]);
                    if (changed[i]) {
                        const Real depth = std::max(Real(0), -t.height);
                        const Real was = -(touch_of(s.planes[i], real(s.probe)).height + lowered[i]);
                        const bool last = next[i].update == knurl::PlaneUpdate::last_depth;
                        start[i] = depth > 0 && last ? depth - std::max(Real(0), was) : depth;
                        elapsed[i] = 0;
                    }
                    elapsed[i] += dt;
                    lowered[i] = T > 0 ? start[i] * std::max(Real(0), 1 - elapsed[i] / T) : 0;
                    t.height += lowered[i];
                    touches.push_back(t);
                }
                changed.assign(next.size(), false);
                s.planes = next;
                const Real reach = reach_of(next, real(s.probe), {});
                const exact::Push want = exact::push(touches, {});
                if (want.give != 0) return c.skip();
                c.compare(scene.evaluate(at(s.probe), dt).force, want.force,
                          1000 * std::max(reach, exact::length(want.dx)), want.sharpness);
            }
        }
    });
}

TEST(Planes, OnSeveralProbesOfOneHand) {
    run("planes, several probes", 10'000, [](Case& c) {
        Rng& rng = c.rng;
        const std::uint32_t probes = static_cast<std::uint32_t>(rng.between(2, 5));
        Limits limits;
        if (rng.one_in(3)) limits.max_force = rng.uniform(0.5, 5);
        Scene scene({32, probes}, limits);
        Probe hand = at(rng.scale(1e-3, 1) * rng.direction(), rng.uniform(0, 0.3) * rng.direction());
        hand.orientation = rng.orientation();
        hand.angular_velocity = rng.uniform(0, 2) * rng.direction();
        struct Finger {
            Vector offset;
            double radius;
            std::vector<Plane> planes;
        };
        std::vector<Finger> fingers;
        std::uint32_t slot = 0;
        for (std::uint32_t i = 0; i < probes; ++i) {
            Finger f{rng.scale(1e-3, 0.1) * rng.direction(), rng.one_in(2) ? 0 : rng.scale(1e-4, 1e-2), {}};
            c.require(bool(scene.place_probe(i, {.offset = knurl::to_plain(f.offset), .radius = f.radius})),
                      "placed");
            for (int j = rng.between(0, 3); j > 0; --j) {
                Plane p{
                    .normal = knurl::to_plain(rng.direction()), .stiffness = rng.of(300, 1000), .damping = 5};
                p.offset = knurl::to_eigen(p.normal).dot(hand.position + hand.orientation * f.offset) +
                           rng.uniform(-0.01, 0.02);
                c.require(bool(scene.add({slot++, 1}, p, {.probe = i})), "added");
                f.planes.push_back(p);
            }
            fingers.push_back(f);
        }
        scene.settle();
        const Wrench got = scene.evaluate(hand, any_step(rng));
        exact::V force, torque;
        Real reach = exact::length(real(hand.position)), scale = 0, sharpness = 1, slack = 0;
        for (const Finger& f : fingers) {
            const exact::V arm = exact::turned(real(hand.orientation), real(f.offset)),
                           p = real(hand.position) + arm;
            const exact::V v = real(hand.velocity) + exact::cross(real(hand.angular_velocity), arm);
            const exact::Push push = exact::push(touches_of(f.planes, p, f.radius), v, 1e-15L);
            if (push.give != 0) return c.skip();
            slack += (push.most - push.least) / 2;
            const exact::V one = capped(push.force, limits.max_force);
            force += one;
            torque += exact::cross(arm, one);
            reach = std::max({reach, exact::length(arm), exact::length(push.dx)});
            scale += push.stiffness * reach + 5 * exact::length(v);
            sharpness = std::min(sharpness, push.sharpness);
            // The direction of a force that hardly exists is not known, the damping's neither.
            if (push.undamped < push.stiffness * 1e-12L) slack += 5 * exact::length(v);
        }
        c.compare_within(got.force, force, slack, scale, sharpness);
        c.compare_within(got.torque, torque, slack * reach, scale * reach, sharpness);
    });
}
