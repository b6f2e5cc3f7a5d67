#pragma once
// Random spheres, capsules, cylinders and tori, and the nearest point of their surface.

#include <algorithm>

#include <knurl/reps/capsule.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/torus.hpp>

#include "../reference/parameters.hpp"
#include "shape_tools.hpp"

namespace knurl::test {

/// The nearest point of the surface: what the reference says of a probe that comes there first.
template <class R>
exact::Foot nearest_foot(const R& s, const Vector& p, double probe) {
    const auto feet = exact::SolidTouch().step(exact::solid_of(s), exact::real(p), probe);
    return *std::min_element(feet.begin(), feet.end(),
                             [](const exact::Foot& a, const exact::Foot& b) { return a.height < b.height; });
}

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
    return std::abs(nearest_foot(s, surface - depth * n, probe).height + depth) < 1e-12L;
}

template <class R>
struct Solids : testing::Test {
    static constexpr std::uint64_t seed = 8101;
    Rng random{seed};
};
using All = testing::Types<Sphere, Capsule, Cylinder, Torus>;
TYPED_TEST_SUITE(Solids, All);

}  // namespace knurl::test
