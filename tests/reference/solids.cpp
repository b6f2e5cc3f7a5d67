// Sphere, capsule, cylinder and torus along random paths: solid and hollow, with thick probes, on the axis
// and at the centre, also with radius 0. How a solid holds a probe that is deep is tested in
// tests/reps/solids_hold.cpp.

#include "exact/solids.hpp"

#include <knurl/reps/capsule.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/torus.hpp>

#include "surface_scenes.hpp"

using namespace judge;

namespace {

struct Setting {
    double size, radius;
    Vector about, axis;
};

Setting any_setting(Rng& rng) {
    Setting s;
    s.size = rng.one_in(3) ? rng.scale(1e-6, 10) : 0.02;
    s.about = rng.of(0, 0.1, 10, 1e6) * rng.direction();
    s.axis = rng.direction();
    s.radius = rng.one_in(2) ? 0 : rng.scale(1e-3, 2) * s.size;
    return s;
}

/// A probe that begins inside is held by the nearest surface, down to half the depth of the core.
template <class R>
void check_seen_first(Case& c, const R& surface, const Limits& limits, const Vector& p, double radius,
                      Real reach) {
    const exact::Solid solid = exact::solid_of(surface);
    exact::SolidTouch touch;
    const exact::Foot foot = touch.step(solid, real(p), radius)[0];
    const bool cylinder = solid.kind == exact::Solid::Kind::cylinder;
    const Real half = (std::min(solid.radius, solid.half_length) + radius) / 2;
    if (solid.hollow || touch.doubt < 1e-12L * reach || (cylinder ? foot.height < -half : touch.deep)) return;
    Alone<R>(surface, limits).check(c, at(p), radius, 1e-3, foot, reach, foot.clear > 1e-12L * reach);
}

template <class R>
void follow(Case& c, R surface, const Setting& s) {
    Rng& rng = c.rng;
    const Limits limits = any_limits(rng);
    const Real k = any_material(rng, surface, limits);
    surface.damping = 0;
    surface.side = rng.one_in(2) ? knurl::Side::inside : knurl::Side::outside;
    const exact::Solid solid = exact::solid_of(surface);
    Scene scene({2, 1}, limits);
    c.require(bool(scene.place_probe(0, {.offset = {}, .radius = s.radius})), "placed");
    c.require(bool(scene.add({0, 1}, surface)), "added");
    scene.settle();
    Alone<R> alone(surface, limits);
    exact::SolidTouch touch;
    Vector p = s.about + rng.uniform(0, 2) * s.size * rng.direction();
    c.say("  solid %d hollow %d size %g radius %g probe %g half %Lg tube %Lg\n", int(solid.kind),
          int(solid.hollow), s.size, double(solid.radius), s.radius, solid.half_length, solid.tube);
    for (int i = 0; i < 8; ++i) {
        const double dt = rng.of(1e-6, 1e-3, 1e-3, 0.05);
        const std::vector<exact::Foot> feet = touch.step(solid, real(p), s.radius);
        const Real reach = std::max({Real(p.norm()), Real(s.about.norm()), Real(s.size), Real(s.radius)});
        check_seen_first(c, surface, limits, p, s.radius, reach);
        if (touch.doubt < 1e-12L * reach || (touch.deep && !solid.hollow))
            return;  // rounding or the path decides
        const Wrench got = scene.evaluate(at(p), dt);
        // The solver starts from its last solution. Where only rounding decides whether a plane is met, a
        // second evaluation may differ by that rounding.
        c.require(rng.one_in(2) || exact::length(real(scene.evaluate(at(p), 0).force) - real(got.force)) <=
                                       1e-14L * k * reach,
                  "the same without time");
        c.say(" %d: dt %g at %g %g %g\n", i, dt, p.x(), p.y(), p.z());
        const bool known = feet[0].clear > 1e-12L * reach;
        const bool wall = feet.size() == 1 || feet[0].height < feet[1].height - 1e-12L * reach;
        const exact::Foot nearest = wall || feet[0].height < feet[1].height ? feet[0] : feet[1];
        alone.check(c, at(p), s.radius, dt, nearest, reach, known && wall);
        if (feet.size() == 1) {
            check_one(c, got.force, feet[0], k, 0, at(p), limits, reach, known);
        } else {
            std::vector<exact::Touch> touches;
            Real clear = INFINITY;
            for (const exact::Foot& f : feet) {
                touches.push_back({f.normal, f.height, k, 0, {}});
                clear = std::min(clear, f.clear);
            }
            const exact::Push push = exact::push(touches, {});
            c.say("  heights %Lg %Lg\n", feet[0].height, feet[1].height);
            const exact::V want = exact::capped(push.force, limits.max_force);
            c.compare_within(
                known ? got.force : Vector(got.force.norm(), 0, 0),
                known ? want : exact::V{exact::length(want), 0, 0},
                known ? std::min(Real(2), 4e-15L * reach / clear) * exact::length(push.force) : 0, k * reach,
                push.sharpness);
        }
        if (!(c.worst() <= bound)) return;
        if (!known && !solid.hollow) return;  // from here on the solid keeps a direction that is arbitrary
        switch (rng.between(0, 9)) {
            case 0:
                p = s.about + rng.uniform(0, 2) * s.size * rng.direction();
                break;
            case 1:  // on the axis
                p = s.about + rng.uniform(-1, 1) * s.size * s.axis;
                break;
            case 2:  // about the centre
                p = s.about + (rng.one_in(2) ? 0 : rng.scale(1e-12, 1e-3)) * s.size * rng.direction();
                break;
            default:
                p += rng.scale(1e-4, 1) * s.size * rng.direction();
        }
    }
}

double any_radius(Rng& rng, double size) {
    return rng.one_in(10) ? 0 : rng.scale(0.05, 1) * size;
}

}  // namespace

TEST(Solids, Sphere) {
    run("sphere", 30'000, [](Case& c) {
        const Setting s = any_setting(c.rng);
        knurl::Sphere sphere{.center = knurl::to_plain(s.about), .radius = any_radius(c.rng, s.size)};
        follow(c, sphere, s);
    });
}
TEST(Solids, Capsule) {
    run("capsule", 30'000, [](Case& c) {
        const Setting s = any_setting(c.rng);
        const knurl::Vec3 axis = knurl::to_plain(c.rng.of(1, 1e-3, 1e3) * s.axis);
        knurl::Capsule capsule{.center = knurl::to_plain(s.about),
                               .axis = axis,
                               .half_length = any_radius(c.rng, s.size),
                               .radius = any_radius(c.rng, s.size)};
        follow(c, capsule, s);
    });
}
TEST(Solids, Cylinder) {
    run("cylinder", 30'000, [](Case& c) {
        const Setting s = any_setting(c.rng);
        const knurl::Vec3 axis = knurl::to_plain(c.rng.of(1, 1e-3, 1e3) * s.axis);
        knurl::Cylinder cylinder{.center = knurl::to_plain(s.about),
                                 .axis = axis,
                                 .radius = any_radius(c.rng, s.size),
                                 .half_length = c.rng.one_in(5) ? infinity : any_radius(c.rng, s.size)};
        follow(c, cylinder, s);
    });
}
TEST(Solids, Torus) {
    run("torus", 30'000, [](Case& c) {
        const Setting s = any_setting(c.rng);
        const knurl::Vec3 axis = knurl::to_plain(c.rng.of(1, 1e-3, 1e3) * s.axis);
        knurl::Torus torus{
            .center = knurl::to_plain(s.about), .axis = axis, .radius = c.rng.uniform(0.3, 1) * s.size};
        torus.tube = any_radius(c.rng, 0.9 * torus.radius);
        follow(c, torus, s);
    });
}
