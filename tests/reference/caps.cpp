// The cap with one curvature and with two: within the rim, beyond it, near its centre, with thick probes.

#include <knurl/reps/cap.hpp>

#include "surface_scenes.hpp"

using namespace judge;
using knurl::Cap;

namespace {

struct CapScene {
    Cap cap;
    Probe hand;
    Real reach = 0;
};

CapScene any_cap(Rng& rng, bool two) {
    CapScene s;
    const double far = rng.one_in(10) ? 1e6 : (rng.one_in(4) ? rng.scale(1e-6, 10) : 0.1);
    const double size = rng.one_in(4) ? rng.scale(1e-6, 1) : 0.01;  // m, what the hand explores
    const Vector n = rng.direction(), axis = rng.across(n), beside = n.cross(axis);
    Cap& c = s.cap;
    c.foot = knurl::to_plain(far * rng.direction());
    c.normal = knurl::to_plain(rng.one_in(4) ? Vector(rng.scale(1e-3, 1e3) * n) : n);
    const auto curvature = [&] {
        const double k = rng.one_in(10) ? rng.scale(1e-15, 1e-3) : rng.scale(0.01, 5) / size;
        return rng.one_in(10) ? 0 : (rng.one_in(2) ? k : -k);
    };
    c.curvature = curvature();
    if (two) {
        c.curvature2 = rng.one_in(10) ? c.curvature : curvature();
        c.axis = knurl::to_plain(rng.scale(1e-3, 1e3) * (axis + rng.uniform(-1, 1) * n));
    }
    c.rim = rng.one_in(4) ? rng.of(0, 0.5) : rng.one_in(2) ? 0.15 : rng.uniform(0, 0.5);
    Vector p = size * rng.uniform(-1, 0.3) * n;
    if (!rng.one_in(10)) p += size * (rng.uniform(-1, 1) * axis + rng.uniform(-1, 1) * beside);
    if (rng.one_in(20)) {  // at or near a centre of curvature
        const double k = rng.one_in(2) && two ? c.curvature2 : c.curvature;
        if (std::abs(k) > 1e-3)
            p = n / k + (rng.one_in(2) ? 0 : rng.scale(1e-15, 1e-3) * size) * rng.direction();
    }
    s.hand = at(knurl::to_eigen(c.foot) + p, rng.uniform(0, 0.5) * rng.direction());
    s.hand.radius = rng.one_in(2) ? 0 : rng.scale(1e-3, 2) * size;
    s.reach =
        std::max({Real(far), exact::length(real(s.hand.position)), Real(p.norm()), Real(s.hand.radius)});
    return s;
}

void judge_cap(Case& c, bool two) {
    Rng& rng = c.rng;
    CapScene s = any_cap(rng, two);
    if (two && std::abs(s.cap.curvature) == std::abs(s.cap.curvature2) &&
        s.cap.curvature != s.cap.curvature2) {
        return c.skip();  // it is not defined which of two opposite curvatures is the ring's
    }
    const Limits limits = any_limits(rng);
    const Real k = any_material(rng, s.cap, limits);
    Scene scene({2, 1}, limits);
    c.require(bool(scene.place_probe(0, {.offset = {}, .radius = s.hand.radius})), "placed");
    c.require(bool(scene.add({0, 1}, s.cap)), "added");
    scene.settle();
    const exact::Cap cap{real(s.cap.foot), real(s.cap.normal), s.cap.curvature,
                         s.cap.curvature2, real(s.cap.axis),   s.cap.rim};
    const Vector q = s.hand.position - knurl::to_eigen(s.cap.foot),
                 n = knurl::to_eigen(s.cap.normal).normalized();
    c.say("  curvature %g %g rim %g radius %g up %g across %g\n", s.cap.curvature, s.cap.curvature2,
          s.cap.rim, s.hand.radius, q.dot(n), (q - q.dot(n) * n).norm());
    Alone<Cap> alone(s.cap, limits);
    for (int i = 0; i < 2; ++i) {
        const exact::Foot want = exact::cap(cap, real(s.hand.position), s.hand.radius);
        const bool known = want.clear > 1e-12L * s.reach;
        alone.check(c, s.hand, s.hand.radius, 1e-3, want, s.reach, known);
        check_one(c, scene.evaluate(s.hand, any_step(rng)).force, want, k, bounded(s.cap.damping, limits),
                  s.hand, limits, s.reach, known);
        s.hand.position += rng.scale(1e-9, 1e-4) * rng.direction();
    }
}

}  // namespace

TEST(Caps, WithOneCurvature) {
    run("cap, one curvature", 80'000, [](Case& c) { judge_cap(c, false); });
}
TEST(Caps, WithTwoCurvatures) {
    run("cap, two curvatures", 80'000, [](Case& c) { judge_cap(c, true); });
}
