#pragma once
// Random spheres, capsules, cylinders and tori, and the nearest point of their surface.

#include <optional>

#include <knurl/reps/capsule.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/torus.hpp>

#include "shape_tools.hpp"

namespace knurl::test {

// ---- The reference: the nearest point of the surface, in long double ----

struct Nearest {
    long double height;  // of p, minus the probe's radius
    Long normal;
    bool deep = false;  // more than half way through a hole that the probe plugs
};

Long axis_of(const auto& s) {
    return exact(s.axis).normalized();
}
inline Nearest from_point(const Long& p, const Long& core, long double reach, bool inside) {
    const Long out = p - core;
    const long double sign = inside ? -1 : 1;
    return {sign * (out.norm() - reach), sign * out.normalized()};
}

inline Nearest reference(const Sphere& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    return from_point(p, exact(s.center), s.radius + (inside ? -1.0L : 1.0L) * probe, inside);
}
inline Nearest reference(const Capsule& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    const Long from = exact(s.center) - s.half_length * axis_of(s),
               to = exact(s.center) + s.half_length * axis_of(s);
    const long double share = s.half_length > 0 ? (p - from).dot(to - from) / (to - from).squaredNorm() : 0;
    return from_point(p, from + std::clamp(share, 0.0L, 1.0L) * (to - from),
                      s.radius + (inside ? -1.0L : 1.0L) * probe, inside);
}
inline Nearest reference(const Torus& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    const Long q = p - exact(s.center), flat = q - axis_of(s).dot(q) * axis_of(s);
    const Long circle = s.radius * flat.normalized();
    const long double size = s.tube + (inside ? -1.0L : 1.0L) * probe;
    const Long foot = circle + size * (q - circle).normalized();
    if (inside || (foot + circle).norm() >= size)
        return from_point(p, exact(s.center) + circle, size, inside);
    // The foot is in the tube on the other side: the axis is free beyond the point where both circles meet.
    const long double along = axis_of(s).dot(q), seat = std::sqrt(size * size - circle.squaredNorm());
    const Long out = std::copysign(seat, along) * axis_of(s) - q;
    return {-out.norm(), out.normalized(), std::abs(along) < seat / 2};
}
inline Nearest reference(const Cylinder& s, const Long& p, double probe) {
    const bool inside = s.side == Side::inside;
    const Long a = axis_of(s), q = p - exact(s.center), flat = q - a.dot(q) * a;
    const long double along = a.dot(q), grow = inside ? -1.0L : 0.0L;
    const long double radius = s.radius + grow * probe, half = s.half_length + grow * probe;
    const Long on_wall = along * a + radius * flat.normalized();
    const Long on_end = std::copysign(half, along) * a + flat;
    const bool in_wall = flat.norm() <= radius, in_end = std::abs(along) <= half;
    if (inside) {  // the most violated face, or the nearest
        const bool wall = radius - flat.norm() <= half - std::abs(along);
        const long double h = wall ? radius - flat.norm() : half - std::abs(along);
        return {h, wall ? Long(-flat.normalized()) : Long(-std::copysign(1.0L, along) * a)};
    }
    if (in_wall && in_end) {
        const bool wall = (q - on_wall).norm() <= (q - on_end).norm();
        const Long out = wall ? Long(on_wall - q) : Long(on_end - q);
        return {-out.norm() - probe, wall ? flat.normalized() : Long(std::copysign(1.0L, along) * a)};
    }
    const Long nearest = in_wall  ? on_end
                         : in_end ? on_wall
                                  : Long(std::copysign(half, along) * a + radius * flat.normalized());
    return {(q - nearest).norm() - probe, (q - nearest).normalized()};
}

// ---- Any of them ----

inline double least_radius(const Sphere& s) {
    return s.radius;
}
inline double least_radius(const Capsule& s) {
    return s.radius;
}
inline double least_radius(const Torus& s) {
    return s.tube;
}
inline double least_radius(const Cylinder& s) {
    return std::min(s.radius, s.half_length);
}

inline double largest(const Sphere& s) {
    return s.radius;
}
inline double largest(const Capsule& s) {
    return s.radius + s.half_length;
}
inline double largest(const Torus& s) {
    return s.radius + s.tube;
}
inline double largest(const Cylinder& s) {
    return std::isinf(s.half_length) ? s.radius : s.radius + s.half_length;
}

template <class R>
R random_solid(Rng& rng, double size) {
    R s{.center = to_plain(Vector(size * direction(rng))), .stiffness = 1000};
    if constexpr (requires { s.axis; }) s.axis = to_plain(Vector(scale(rng, 0.01, 100) * direction(rng)));
    s.radius = size * scale(rng, 0.2, 1);
    if constexpr (requires { s.half_length; }) s.half_length = size * scale(rng, 0.2, 1);
    if constexpr (requires { s.tube; }) s.tube = s.radius * scale(rng, 0.1, 0.9);
    return s;
}

// A point near its surface: along the axis, around and inside.
template <class R>
Vector some_point(Rng& rng, const R& s, double probe = 0) {
    return to_eigen(s.center) + 1.5 * (largest(s) + probe) * std::cbrt(uniform(rng, 0, 1)) * direction(rng);
}

// Does another face of the solid come nearer on the straight way in?
template <class R>
bool straight_in(const R& s, const Vector& surface, const Vector& n, double depth, double probe) {
    return std::abs(reference(s, (surface - depth * n).cast<long double>(), probe).height + depth) < 1e-12L;
}

template <class R>
struct Solids : testing::Test {
    static constexpr std::uint64_t seed = 8101;
    Rng random{seed};
};
using All = testing::Types<Sphere, Capsule, Cylinder, Torus>;
TYPED_TEST_SUITE(Solids, All);

}  // namespace knurl::test
