// Springs: with and without rest length, damped, attached off the hand's centre, with moving ends, and many
// at once.

#include <knurl/reps/spring.hpp>

#include "exact/effects.hpp"
#include "judge.hpp"

using namespace judge;
using knurl::Spring;

namespace springs_tests {
namespace {

Probe any_hand(Rng& rng, double reach) {
    Probe hand = at(reach * rng.direction(), rng.uniform(0, 1) * rng.direction());
    if (rng.one_in(2)) hand.orientation = rng.orientation();
    hand.angular_velocity = rng.uniform(0, 3) * rng.direction();
    return hand;
}

double any_reach(Rng& rng) {
    return rng.one_in(10) ? 1e6 : (rng.one_in(4) ? rng.scale(1e-6, 10) : 0.1);
}

Spring any_spring(Rng& rng, const Probe& hand) {
    Spring s;
    if (rng.one_in(2)) s.attach = knurl::to_plain(rng.scale(1e-4, 0.1) * rng.direction());
    const Vector end = hand.position + hand.orientation * knurl::to_eigen(s.attach);
    const double length =
        rng.one_in(20) ? 0 : (rng.one_in(10) ? rng.scale(1e-12, 1e-6) : rng.scale(1e-6, 0.5));
    s.anchor = knurl::to_plain(end + length * rng.direction());
    if (rng.one_in(2)) s.rest_length = rng.one_in(4) ? length : rng.scale(1e-6, 0.3);
    s.stiffness = rng.one_in(10) ? rng.scale(1e-6, 1e6) : rng.uniform(1, 3000);
    if (rng.one_in(2)) s.damping = rng.scale(0.01, 20);
    return s;
}

/// The reference's answer for a spring within the device's limits.
struct Want {
    exact::V force, torque;
    Real scale = 0, reach = 0, slack = 0;
};
Want want_of(const Spring& s, const exact::V& anchor, Real rest_length, const Probe& hand,
             const Limits& limits) {
    Real k = s.stiffness;
    if (std::isinf(k)) k = std::isinf(limits.max_stiffness) ? 1000 : limits.max_stiffness;
    k = std::min(k, Real(limits.max_stiffness));
    const exact::Tip tip = tip_of(hand);
    exact::Twist f =
        exact::spring({anchor, real(s.attach), rest_length, k, s.damping}, tip, device_of(limits));
    f.force = exact::capped(f.force, limits.max_force);  // the torque has a limit of its own
    f.torque = exact::capped(f.torque, limits.max_torque);
    const exact::V arm = exact::turned(tip.orientation, real(s.attach));
    Want w{f.force, f.torque};
    w.reach = std::max({exact::length(anchor), exact::length(tip.position), exact::length(arm), rest_length});
    const Real speed = exact::length(tip.velocity) + exact::length(tip.turning) * exact::length(arm);
    const Real length = exact::length(anchor - tip.position - arm);
    // With a rest length the force changes by up to k L0 / sqrt(l^2 + e^2) per metre across the spring.
    const Real e = std::max(std::min(Real(1e-3L), rest_length / 20), rest_length * k / limits.max_stiffness);
    const Real steep = rest_length > 0 ? rest_length / std::sqrt(length * length + e * e) : 0;
    w.scale = k * w.reach * std::max(Real(1), steep) + s.damping * speed;
    // Damping acts along the spring, which has no direction at length 0.
    w.slack =
        length > 0 ? s.damping * speed * std::min(Real(1), 2e-15L * w.reach / length) : s.damping * speed;
    return w;
}

}  // namespace

TEST(Springs, AgreeWithTheirFormula) {
    run("springs", 150'000, [](Case& c) {
        Rng& rng = c.rng;
        Limits limits;
        if (rng.one_in(2)) limits.max_stiffness = rng.uniform(500, 3000);
        if (rng.one_in(4)) limits.max_force = rng.scale(0.01, 10);
        if (rng.one_in(4)) limits.max_torsion = rng.scale(1e-3, 10);
        if (rng.one_in(4)) limits.max_torque = rng.scale(1e-3, 10);
        if (rng.one_in(2)) limits.mass = rng.uniform(0.05, 0.3), limits.lag = rng.uniform(0, 2e-3);
        const double reach = any_reach(rng);
        const Probe hand = any_hand(rng, reach);
        Spring s = any_spring(rng, hand);
        if (rng.one_in(20)) s.stiffness = infinity;
        Scene scene({2, 1}, limits);
        c.require(bool(scene.add({0, 1}, s, {.feedback = static_cast<std::uint32_t>(rng.between(0, 1))})),
                  "added");
        scene.settle();
        const Wrench got = scene.evaluate(hand, any_step(rng));
        const Want want = want_of(s, real(s.anchor), s.rest_length, hand, limits);
        c.require(finite(got), "finite");
        c.compare_within(got.force, want.force, want.slack, want.scale);
        c.compare_within(got.torque, want.torque, want.slack * want.reach, want.scale * want.reach);
        c.require(exact::length(real(got.force)) <= limits.max_force * (1 + 1e-12L),
                  "at most the device's force");
    });
}

TEST(Springs, TheirEndsMoveLinearlyAndArrive) {
    run("springs, moving", 40'000, [](Case& c) {
        Rng& rng = c.rng;
        const double reach = any_reach(rng);
        Probe hand = any_hand(rng, reach);
        Spring s = any_spring(rng, hand);
        s.damping = 0;
        Scene scene({2, 1}, {});
        c.require(bool(scene.add({0, 1}, s)), "added");
        scene.settle();
        scene.evaluate(hand, any_step(rng));
        exact::V anchor = real(s.anchor);
        Real rest = s.rest_length;
        for (int round = 0; round < 3; ++round) {
            const exact::V from = anchor;
            const Real rest_from = rest;
            s.anchor = knurl::to_plain(knurl::to_eigen(s.anchor) + rng.scale(1e-6, 0.2) * rng.direction());
            if (s.rest_length > 0 || rng.one_in(2)) s.rest_length = rng.scale(1e-6, 0.3);
            s.duration = rng.of(0, 0.001, 0.01, 0.2);
            c.require(bool(scene.update({0, 1}, s)), "updated");
            Real elapsed = 0;
            for (int i = rng.between(1, 4); i > 0; --i) {
                hand.position += rng.scale(1e-6, 0.01) * rng.direction();
                const double dt = any_step(rng);
                elapsed += dt;
                const Real share = s.duration > 0 ? std::min(Real(1), elapsed / s.duration) : 1;
                anchor = (1 - share) * from + share * real(s.anchor);
                rest = (1 - share) * rest_from + share * s.rest_length;
                const Wrench got = scene.evaluate(hand, dt);
                const Want want = want_of(s, anchor, rest, hand, {});
                c.compare(got.force, want.force, want.scale);
                c.compare(got.torque, want.torque, want.scale * want.reach);
            }
        }
    });
}

TEST(Springs, ManyOnSeveralProbesActAsTheirSum) {
    run("springs, many", 8'000, [](Case& c) {
        Rng& rng = c.rng;
        const double reach = any_reach(rng);
        const Probe hand = any_hand(rng, reach);
        const std::uint32_t probes = static_cast<std::uint32_t>(rng.between(1, 3));
        Scene scene({64, 3}, {});
        exact::V offset[3];
        for (std::uint32_t i = 0; i < probes; ++i) {
            const Vector where = rng.one_in(3) ? Vector(0, 0, 0) : Vector(0.1 * rng.direction());
            offset[i] = real(where);
            c.require(bool(scene.place_probe(i, {.offset = knurl::to_plain(where)})), "placed");
        }
        exact::V force, torque;
        Real scale = 0, slack = 0, most = 0;
        const int many = rng.between(2, rng.one_in(10) ? 64 : 12);
        for (int i = 0; i < many; ++i) {
            const std::uint32_t on = static_cast<std::uint32_t>(rng.between(0, static_cast<int>(probes) - 1));
            const exact::V arm = exact::turned(real(hand.orientation), offset[on]);
            Spring s = any_spring(rng, hand);
            if (rng.one_in(2)) s.rest_length = 0;  // without feedback, such springs are collapsed into one
            const knurl::AddOptions options{.probe = on, .feedback = rng.one_in(3) ? 1u : 0u};
            c.require(bool(scene.add({static_cast<std::uint32_t>(i), 1}, s, options)), "added");
            // A spring on a probe of the hand acts as one on the hand with a longer arm.
            const exact::V attach = real(s.attach) + offset[on];
            exact::Tip tip = tip_of(hand);
            const exact::Twist one =
                exact::spring({real(s.anchor), attach, s.rest_length, s.stiffness, s.damping}, tip, {});
            const Want want = want_of(s, real(s.anchor), s.rest_length, hand, {});
            force += one.force;
            torque += one.torque;
            const exact::V end = tip.position + exact::turned(tip.orientation, attach);
            const Real length = exact::length(real(s.anchor) - end);
            const Real speed = exact::length(tip.velocity) + 3 * exact::length(attach);
            const Real e = std::min(Real(1e-3L), Real(s.rest_length) / 20);
            const Real steep = s.rest_length > 0 ? s.rest_length / std::sqrt(length * length + e * e) : 0;
            most = std::max({most, want.reach, exact::length(attach), exact::length(arm)});
            scale += s.stiffness * most * std::max(Real(1), steep) + s.damping * speed;
            slack += length > 0 ? s.damping * speed * std::min(Real(1), 2e-15L * most / length)
                                : s.damping * speed;
        }
        scene.settle();
        for (int i = 0; i < 2; ++i) {
            const Wrench got = scene.evaluate(hand, any_step(rng));
            c.require(finite(got), "finite");
            c.compare_within(got.force, force, slack, scale);
            c.compare_within(got.torque, torque, slack * most, scale * most);
        }
    });
}

}  // namespace springs_tests
