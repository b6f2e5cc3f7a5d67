// Friction along scripted paths: on one plane and in the corner of two, with a normal force that changes.

#include <cstring>

#include <knurl/reps/plane.hpp>

#include "exact/contact.hpp"
#include "exact/friction.hpp"
#include "judge.hpp"

using namespace judge;
using knurl::Plane;

namespace {

/// A friction law, and the same law as parameters of a surface.
struct Rub {
    exact::Law law;
    knurl::Friction friction;
    knurl::Snag snag;
};

Rub any_rub(Rng& rng, double stiffness, const Limits& limits, exact::Law::Kind kind) {
    Rub r;
    if (kind == exact::Law::Kind::coulomb) {
        r.friction.dynamic = rng.one_in(10) ? 0 : rng.uniform(0.05, 1);
        r.friction.static_ = rng.one_in(3) ? knurl::automatic : r.friction.dynamic + rng.uniform(0, 0.5);
    } else {
        r.snag = {.k_kinetic = rng.one_in(5) ? 0 : rng.uniform(0.02, 1),
                  .k_stick = rng.uniform(50, 3000),
                  .d_snap = rng.scale(1e-4, 3e-3),
                  .d_mean = rng.scale(1e-4, 1e-2),
                  .d_spread = rng.one_in(3) ? 0 : rng.scale(1e-4, 1e-2),
                  .seed = static_cast<std::uint32_t>(rng.between(0, 1000)),
                  .law = kind == exact::Law::Kind::paper ? knurl::SnagLaw::paper : knurl::SnagLaw::passive};
        if (kind == exact::Law::Kind::paper && rng.one_in(20)) r.snag.d_mean = 0;
    }
    if (rng.one_in(3)) r.friction.viscous = rng.scale(0.01, 100);
    r.law = exact::law_of(r.friction, r.snag, stiffness, limits);
    r.law.viscous = bounded(r.friction.viscous, limits);
    return r;
}

void judge_friction(Case& c, exact::Law::Kind kind, bool corner) {
    Rng& rng = c.rng;
    Limits limits;
    limits.resolution = rng.of(1e-7, 3e-5);  // with 0, rounding would decide where the paper's snags catch
    if (rng.one_in(3)) limits.max_stiffness = rng.uniform(800, 2000);
    const double stiffness = rng.uniform(200, 800);
    Rub rub = any_rub(rng, stiffness, limits, kind);
    const Vector at_first = rng.of(0.1, 0.1, 0.1, 10) * rng.direction();
    const Vector n = rng.direction(), line = rng.across(n), side = n.cross(line);
    const double half = rng.uniform(20, 80) * M_PI / 180;
    std::vector<Plane> planes;
    for (int i = 0; i < (corner ? 2 : 1); ++i) {
        const double turn = corner ? (i ? half : -half) : 0;
        Plane p{.normal = knurl::to_plain(std::cos(turn) * n + std::sin(turn) * side),
                .stiffness = stiffness,
                .friction = rub.friction,
                .snag = rub.snag};
        p.offset = knurl::to_eigen(p.normal).dot(at_first);
        planes.push_back(p);
    }
    // A single plane may move along itself, and then carries the anchor.
    Vector carried = Vector::Zero();
    if (!corner && rng.one_in(3)) carried = rng.uniform(-0.1, 0.1) * line;
    for (Plane& p : planes) p.velocity = knurl::to_plain(carried);
    Scene scene({4, 1}, limits);
    for (std::uint32_t i = 0; i < planes.size(); ++i) c.require(bool(scene.add({i, 1}, planes[i])), "added");
    scene.settle();

    c.say("stiffness %Lg static %Lg dynamic %Lg viscous %Lg snap %Lg mean %Lg max %Lg\n", rub.law.stiffness,
          rub.law.static_, rub.law.dynamic, rub.law.viscous, rub.law.d_snap, rub.law.d_mean,
          rub.law.max_stiffness);
    exact::Friction model;
    Vector where = at_first - rng.uniform(0.001, 0.01) * n, heading = 0.0002 * rng.across(n);
    for (int i = 0; i < 60; ++i) {
        if (rng.one_in(10)) heading = rng.scale(1e-6, 1e-3) * rng.across(n);
        if (rng.one_in(10)) heading *= -rng.uniform(0.3, 1);
        const bool pause = rng.one_in(10);
        if (!pause) where += corner ? Vector(heading.dot(line) * line) : heading;
        const double depth = n.dot(at_first - where);
        const double lift = rng.one_in(40) ? -depth - 1e-4 : rng.uniform(-0.2, 0.2) * depth;
        where -= lift * n;
        if (corner && n.dot(at_first - where) < 1e-4)
            where = at_first - 0.002 * n + line.dot(where - at_first) * line;
        if (!corner && rng.one_in(20)) where -= (n.dot(where - at_first) + 0.003) * n;
        const double dt = rng.of(1e-6, 1e-3, 1e-3, 1e-3, 0.05);
        Probe hand = at(where, rng.uniform(0, 0.3) * rng.direction());
        hand.smooth_velocity = rng.uniform(0, 0.3) * rng.direction();

        const exact::V p = real(where);
        std::vector<exact::Touch> touches;
        for (const Plane& plane : planes) {
            const exact::V normal = exact::unit(real(plane.normal));
            touches.push_back({normal,
                               exact::dot(normal, p) - plane.offset / exact::length(real(plane.normal)),
                               plane.stiffness,
                               0,
                               {}});
        }
        const exact::Push push = exact::push(touches, {});
        exact::Sliding sliding{exact::unit(touches[0].normal), {}, corner};
        if (corner) sliding.line = exact::unit(exact::cross(touches[0].normal, touches[1].normal));
        const Real N = exact::length(push.force);
        const exact::V friction =
            model.step(rub.law, sliding, p, real(hand.smooth_velocity), real(carried), N, dt);
        const Wrench got = scene.evaluate(hand, dt), again = scene.evaluate(hand, 0);
        c.require(std::memcmp(&got, &again, sizeof got) == 0, "the same without time");
        c.say("  %d: dt %g N %.6Lg friction %.9Lg of %.9g\n", i, dt, N, exact::length(friction),
              double(exact::length(real(got.force) - push.force)));
        const Real reach = exact::length(p) + exact::length(push.dx);
        const Real k =
            std::max({Real(stiffness), rub.law.stiffness * (kind == exact::Law::Kind::paper ? N : 1)});
        const exact::V felt = real(got.force) - push.force;
        c.say("    along %Lg %Lg of %Lg %Lg\n", exact::dot(friction, real(line)),
              exact::dot(friction, real(side)), exact::dot(felt, real(line)), exact::dot(felt, real(side)));
        c.compare(got.force, push.force + friction, k * reach);
        const Real most = kind == exact::Law::Kind::paper
                              ? std::max(rub.law.stiffness * rub.law.d_snap, rub.law.dynamic)
                              : std::max(rub.law.static_, rub.law.dynamic);
        c.require(
            exact::length(real(got.force) - push.force) <=
                N * most * (1 + 1e-9L) +
                    std::min(N, rub.law.viscous * exact::length(real(hand.smooth_velocity) - real(carried))) *
                        (1 + 1e-9L) +
                    1e-12L * k * reach,
            "no more than its coefficients allow");
        if (!(c.worst() <= bound)) return;  // after one error the rest of the path says nothing
    }
}

}  // namespace

TEST(Frictions, ElasticCoulomb) {
    run("friction, Coulomb", 8'000, [](Case& c) { judge_friction(c, exact::Law::Kind::coulomb, false); });
}
TEST(Frictions, ElasticCoulombInACorner) {
    run("friction, Coulomb in a corner", 4'000,
        [](Case& c) { judge_friction(c, exact::Law::Kind::coulomb, true); });
}
TEST(Frictions, PassiveSnag) {
    run("friction, passive snag", 8'000, [](Case& c) { judge_friction(c, exact::Law::Kind::snag, false); });
}
TEST(Frictions, PassiveSnagInACorner) {
    run("friction, passive snag in a corner", 4'000,
        [](Case& c) { judge_friction(c, exact::Law::Kind::snag, true); });
}
TEST(Frictions, ThePapersSnag) {
    run("friction, paper's snag", 8'000, [](Case& c) { judge_friction(c, exact::Law::Kind::paper, false); });
}
