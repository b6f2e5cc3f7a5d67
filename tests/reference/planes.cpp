// Planes: solved together, of unequal stiffness, damped, contradictory, combined by sum, moving, on several
// probes.

#include "plane_scenes.hpp"

using namespace judge;
using knurl::Plane;

namespace {

/// Compares the scene's force at one probe with the reference's.
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
    // Where planes leave no room between them, rounding decides which of them hold. A softer layer that gives
    // way may also lie nearer than a harder one.
    const bool no_room = want.give > -1e-9L * reach && want.give != 0;
    // How far the planes give way follows from four of them, each with the rounding of a corner's two
    // together.
    const Real width = want.give > 0 ? want.sharpness / 4 : want.sharpness;
    // Damping depends on the direction of F and on the planes' weights; both are uncertain where they are
    // small relative to rounding. In a contradiction the weights depend on exactly how far the planes give
    // way.
    const Real turn = 4 * want.stiffness * rounding / (want.sharpness * want.sharpness) / want.undamped;
    bool touched = false;
    for (const exact::Touch& t : touches) touched = touched || t.height < rounding;
    const Real damped =
        touched ? damping * speed * (no_room || want.undamped <= 0 ? 1 : std::min(Real(1), turn)) : 0;
    c.compare_within(got.force, exact::capped(want.force, limits.max_force),
                     (want.most - want.least) / 2 + damped, scale, width);
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
    if (damping == 0 && !no_room)
        c.require(
            felt <= want.stiffness * exact::length(want.dx) * (1 + 1e-12L) + 1e-12L * scale / want.sharpness,
            "no stiffer than the stiffest");
    c.require(got.torque.norm() == 0, "no torque from the tip");
}

}  // namespace

TEST(Planes, SolvedTogether) {
    run("planes, joint", 30'000, [](Case& c) {
        const PlaneScene s = any_planes(c.rng);
        Scene scene({16, 1}, {});
        add_all(c, scene, s.planes);
        scene.settle();
        Vector probe = s.probe;
        for (int i = 0; i < 3; ++i) {  // a cold start, then warm starts
            check(c, scene.evaluate(at(probe), any_step(c.rng)), s.planes, real(probe), {}, 0, 0, {});
            probe += c.rng.scale(1e-6, 1) * s.size * c.rng.direction();
        }
    });
}

TEST(Planes, OfUnequalStiffnessDampedFeltByAThickProbeWithinLimits) {
    run("planes, layered and damped", 25'000, [](Case& c) {
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
        for (Plane& p : s.planes) p.damping = bounded(p.damping, limits);
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
                // Damping has a step at depth 0, and rounding decides on which side of it the probe is.
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
    run("planes, moving", 12'000, [](Case& c) {
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
                moved += dt;  // in the first cycle that takes time the planes are where they were placed
            started = started || dt > 0;
            const Probe hand = at(s.probe, rng.uniform(0, 0.5) * rng.direction());
            c.say("dt %g moved %Lg\n", dt, moved);
            check(c, scene.evaluate(hand, dt), s.planes, real(s.probe), real(hand.velocity), 0, moved, {});
            s.probe += rng.scale(1e-6, 1) * s.size * rng.direction();
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
            const exact::V one = exact::capped(push.force, limits.max_force);
            force += one;
            torque += exact::cross(arm, one);
            reach = std::max({reach, exact::length(arm), exact::length(push.dx)});
            scale += push.stiffness * reach + 5 * exact::length(v);
            sharpness = std::min(sharpness, push.sharpness);
            // A force near zero has no known direction, so neither has its damping.
            if (push.undamped < push.stiffness * 1e-12L) slack += 5 * exact::length(v);
        }
        c.compare_within(got.force, force, slack, scale, sharpness);
        c.compare_within(got.torque, torque, slack * reach, scale * reach, sharpness);
    });
}
