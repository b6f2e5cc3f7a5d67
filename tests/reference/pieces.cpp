// Flat pieces and boxes along random paths: the side of entry, slipping off an edge, coming back, thick
// probes.

#include "exact/pieces.hpp"

#include <knurl/reps/box.hpp>
#include <knurl/reps/half_plane.hpp>
#include <knurl/reps/polygon.hpp>
#include <knurl/reps/shape.hpp>

#include "surface_scenes.hpp"

using namespace judge;

namespace {

/// One step of a path around something of that size: mostly small, sometimes right across it.
void wander(Rng& rng, Vector& p, const Vector& about, double size) {
    if (rng.one_in(6)) {
        p = about + rng.uniform(0, 2) * size * rng.direction();
    } else {
        p += rng.scale(0.001, 1) * size * rng.direction();
    }
}

/// The distance from the world's origin, m. Far away, rounding would merge the corners of a small piece.
double any_distance(Rng& rng, double size) {
    return rng.of(0, 0.1, 10, size < 0.01 ? 1 : 1e6);
}

template <class R, class Touch, class Shape>
void follow(Case& c, R& surface, Touch& touch, const Shape& shape, const Vector& about, double size,
            double radius) {
    Rng& rng = c.rng;
    const Limits limits = any_limits(rng);
    const Real k = any_material(rng, surface, limits);
    // A moving surface is evaluated in every cycle; culling.cpp tests that skipping changes nothing.
    surface.velocity = {1e-300, 0, 0};
    if (rng.one_in(3)) surface.velocity = knurl::to_plain(rng.scale(1e-3, 1) * size * rng.direction());
    Scene scene({2, 1}, limits);
    c.require(bool(scene.place_probe(0, {.offset = {}, .radius = radius})), "placed");
    c.require(bool(scene.add({0, 1}, surface)), "added");
    scene.settle();
    Alone<R> alone(surface, limits);
    Vector p = about + rng.uniform(0.5, 2) * size * rng.direction();
    Real moved = 0;
    for (int i = 0; i < 12; ++i) {
        const double dt = rng.of(1e-6, 1e-3, 1e-3, 0.05);
        if (i > 0) moved += dt;
        Probe hand = at(p, rng.one_in(2) ? Vector(0, 0, 0) : Vector(rng.uniform(0, 0.3) * rng.direction()));
        const exact::V carried = real(surface.velocity);
        const std::optional<exact::Foot> foot = touch.step(shape, real(p) - moved * carried, radius);
        const Real reach = std::max(
            {Real(p.norm()), Real(about.norm()), Real(size), Real(radius), moved * exact::length(carried)});
        if (touch.doubt < 1e-12L * reach) return;                                      // rounding decides
        if (rng.one_in(2)) scene.evaluate(at(about + 2 * size * rng.direction()), 0);  // must change nothing
        const Wrench got = scene.evaluate(hand, dt);
        const Wrench again = scene.evaluate(hand, 0);
        c.require(got.force == again.force, "the same without time");
        alone.check(c, hand, radius, dt, foot, reach, true, size);
        hand.velocity -= knurl::to_eigen(surface.velocity);  // damping acts on the relative velocity
        c.say(" %d: at %g %g %g doubt %Lg\n", i, p.x(), p.y(), p.z(), touch.doubt);
        if (foot) {
            check_one(c, got.force, *foot, k, bounded(surface.damping, limits), hand, limits,
                      reach * std::max(Real(1), std::fabs(foot->height) / size));
        } else {
            c.say("  nothing is felt\n");
            c.compare(got.force, {}, k * reach);
        }
        if (!(c.worst() <= bound)) return;
        wander(rng, p, about, size);
    }
}

}  // namespace

TEST(Pieces, APolygonKnowsTheSideFromWhichTheHandCame) {
    run("polygon", 30'000, [](Case& c) {
        Rng& rng = c.rng;
        const double size = rng.one_in(3) ? rng.scale(1e-4, 1) : 0.05;
        const Vector about = any_distance(rng, size) * rng.direction(), n = rng.direction(),
                     u = rng.across(n), v = n.cross(u);
        const int count = rng.between(3, 8);
        knurl::Polygon polygon;
        polygon.sides = rng.one_in(2) ? knurl::Sides::both : knurl::Sides::front;
        polygon.vertices.count = static_cast<std::uint32_t>(count);
        const double squeeze = rng.uniform(0.2, 1);
        for (int i = 0; i < 8; ++i) {
            const double angle = 2 * M_PI * (i + 0.7 * (rng.uniform(0, 1) - 0.5)) / count;
            const Vector x = about + size * (std::cos(angle) * u + squeeze * std::sin(angle) * v);
            polygon.vertices.at[i] = i < count ? knurl::to_plain(x) : knurl::Vec3{};
        }
        exact::PieceTouch touch;
        const double radius = rng.one_in(2) ? rng.scale(1e-3, 0.5) * size : 0;
        follow(c, polygon, touch, exact::piece_of(polygon), about, size, radius);
    });
}

TEST(Pieces, AHalfPlaneHasOneEdge) {
    run("half-plane", 30'000, [](Case& c) {
        Rng& rng = c.rng;
        const double size = rng.one_in(3) ? rng.scale(1e-4, 1) : 0.05;
        const Vector about = any_distance(rng, size) * rng.direction(), n = rng.direction(),
                     u = rng.across(n);
        const Vector edge = u + rng.uniform(-1, 1) * n;
        const double a = rng.of(1, 1, 0.01, 30), b = rng.of(1, 1, 0.01, 30);
        knurl::HalfPlane half{.normal = knurl::to_plain(a * n),
                              .offset = a * n.dot(about),
                              .edge = knurl::to_plain(b * edge),
                              .edge_offset = b * edge.dot(about)};
        half.sides = rng.one_in(2) ? knurl::Sides::both : knurl::Sides::front;
        exact::PieceTouch touch;
        const double radius = rng.one_in(2) ? rng.scale(1e-3, 0.5) * size : 0;
        follow(c, half, touch, exact::piece_of(half), about, size, radius);
    });
}

namespace {

knurl::Box any_box(Rng& rng, const Vector& about, double size) {
    knurl::Box box;
    box.center = knurl::to_plain(about);
    const Eigen::Quaterniond q = rng.orientation();
    const double length = rng.of(1, 1, 0.01, 100);
    box.orientation = {length * q.w(), length * q.x(), length * q.y(), length * q.z()};
    box.half_size = {rng.scale(0.05, 1) * size, rng.scale(0.05, 1) * size, rng.scale(0.05, 1) * size};
    if (rng.one_in(8)) box.half_size.z = 0;
    return box;
}

}  // namespace

TEST(Pieces, ASolidBoxHoldsByTheFaceThroughWhichTheHandCame) {
    run("box, solid", 30'000, [](Case& c) {
        Rng& rng = c.rng;
        const double size = rng.one_in(3) ? rng.scale(1e-4, 1) : 0.05;
        const Vector about = any_distance(rng, size) * rng.direction();
        knurl::Box box = any_box(rng, about, size);
        exact::BoxTouch touch;
        const double radius = rng.one_in(2) ? rng.scale(1e-3, 0.5) * size : 0;
        follow(c, box, touch, exact::box_of(box), about, size, radius);
    });
}

TEST(Pieces, AHollowBoxHoldsWithUpToThreeWalls) {
    run("box, hollow", 60'000, [](Case& c) {
        Rng& rng = c.rng;
        const double size = rng.one_in(3) ? rng.scale(1e-6, 10) : 0.05;
        const Vector about = rng.of(0, 0.1, 10, 1e6) * rng.direction();
        knurl::Box box = any_box(rng, about, size);
        box.side = knurl::Side::inside;
        const Limits limits = any_limits(rng);
        const Real k = any_material(rng, box, limits);
        box.damping = 0;
        const double radius = rng.one_in(2) ? rng.scale(1e-3, 2) * size : 0;
        Scene scene({2, 1}, limits);
        c.require(bool(scene.place_probe(0, {.offset = {}, .radius = radius})), "placed");
        c.require(bool(scene.add({0, 1}, box)), "added");
        scene.settle();
        const exact::Box shape = exact::box_of(box);
        Vector p = about + rng.uniform(0, 2) * size * rng.direction();
        for (int i = 0; i < 3; ++i) {
            const exact::V back = k * exact::hollow_box(shape, real(p), radius);
            c.compare(scene.evaluate(at(p), any_step(rng)).force, exact::capped(back, limits.max_force),
                      k * std::max({Real(p.norm()), Real(about.norm()), Real(size), Real(radius)}));
            wander(rng, p, about, size);
        }
    });
}
