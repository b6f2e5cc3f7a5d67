#pragma once
// Random and hostile sets of planes with a probe, and their form in the reference.

#include <vector>

#include <knurl/reps/plane.hpp>

#include "exact/contact.hpp"
#include "judge.hpp"

namespace judge {

struct PlaneScene {
    std::vector<knurl::Plane> planes;
    Vector probe = Vector::Zero();
    double size = 0.01;  // m

    void add(const Vector& n, double offset) {
        planes.push_back({.normal = knurl::to_plain(n), .offset = offset, .stiffness = 1000});
    }
};

/// Two planes with a dihedral angle of their free side from 0.01 to 179.99 degrees, and perhaps a wall
/// across.
inline void wedge(Rng& rng, PlaneScene& s) {
    const double degrees = rng.one_in(2) ? rng.scale(0.01, 179.99) : 180 - rng.scale(0.01, 10);
    const double half = degrees * M_PI / 360;
    const Vector axis = rng.direction(), up = rng.across(axis), side = axis.cross(up);
    s.add(std::sin(half) * up + std::cos(half) * side, 0);
    s.add(std::sin(half) * up - std::cos(half) * side, 0);
    if (rng.one_in(2)) s.add((axis + 0.3 * up).normalized(), 0);
    s.probe = s.size * (rng.uniform(-1, 0.2) * up + rng.uniform(-1, 1) * side + rng.uniform(-1, 1) * axis);
}

/// Copies of one plane, tilted and moved by 1e-17 to 1e-3.
inline void copies(Rng& rng, PlaneScene& s) {
    const Vector n = rng.direction();
    for (int i = rng.between(2, 8); i > 0; --i) {
        const double off = rng.scale(1e-17, 1e-3);
        s.add((n + off * rng.direction()).normalized(), rng.one_in(2) ? 0 : off * s.size);
    }
    if (rng.one_in(2)) s.planes.push_back(s.planes[0]);
    s.probe = -s.size * rng.uniform(0, 1) * n + 0.3 * s.size * rng.direction();
}

/// Normals that lie almost in one plane.
inline void fan(Rng& rng, PlaneScene& s) {
    const Vector axis = rng.direction(), up = rng.across(axis), side = axis.cross(up);
    const double out = rng.scale(1e-9, 1e-1);
    for (int i = rng.between(3, 8); i > 0; --i) {
        const double angle = rng.uniform(-1, 1) * 89.5 * M_PI / 180;
        s.add((std::cos(angle) * up + std::sin(angle) * side + out * rng.uniform(-1, 1) * axis).normalized(),
              0);
    }
    s.probe = s.size * (rng.uniform(-1, 0.1) * up + rng.uniform(-1, 1) * side + rng.uniform(-1, 1) * axis);
}

/// Two planes that face each other across a gap of 0 to 1 mm, and perhaps a wall across.
inline void slab(Rng& rng, PlaneScene& s) {
    const Vector n = rng.direction();
    s.add(n, 0);
    s.add(-n, rng.one_in(5) ? 0 : -rng.scale(1e-9, 1e-3));
    if (rng.one_in(2)) s.add(rng.across(n), 0);
    s.probe = s.size * rng.uniform(-1, 1) * n + 0.3 * s.size * rng.direction();
}

/// The inside of a polyhedron about the origin, with the probe outside.
inline void cavity(Rng& rng, PlaneScene& s) {
    for (int i = rng.between(4, 9); i > 0; --i) s.add(rng.direction(), -s.size * rng.uniform(0.3, 1));
    s.probe = s.size * rng.uniform(0.5, 3) * rng.direction();
}

inline void corner(Rng& rng, PlaneScene& s) {
    const Vector axis = rng.direction();
    for (int i = rng.between(1, 7); i > 0; --i) {
        Vector n;
        do n = rng.direction();
        while (n.dot(axis) < std::cos(80 * M_PI / 180));
        s.add(n, rng.uniform(-0.3, 0.3) * s.size);
    }
    s.probe = -s.size * rng.uniform(0, 1) * axis + 0.5 * s.size * rng.direction();
}

/// No point satisfies all: a floor above its ceiling, a prism or a tetrahedron turned inside out.
inline void contradictory(Rng& rng, PlaneScene& s) {
    const Vector n = rng.direction();
    const int kind = rng.between(0, 2);
    if (kind == 0) {
        s.add(n, s.size * rng.uniform(0.01, 0.3));
        s.add(-n, 0);
        if (rng.one_in(2)) s.add(rng.across(n), 0);
        if (rng.one_in(2)) s.add(rng.direction(), -s.size * rng.uniform(0, 1));
    } else if (kind == 1) {
        // Three walls about the z axis: their normals lie in one plane exactly.
        const double a = rng.uniform(0, 2 * M_PI);
        for (int i = 0; i < 3; ++i) {
            const double b = a + i * 2 * M_PI / 3 + rng.uniform(-0.5, 0.5);
            s.add({std::cos(b), std::sin(b), 0}, s.size * rng.uniform(0.01, 0.3));
        }
    } else {
        const double h = std::sqrt(1.0 / 3);
        const Eigen::Quaterniond q = rng.orientation();
        for (const Vector& v : {Vector(h, h, h), Vector(h, -h, -h), Vector(-h, h, -h), Vector(-h, -h, h)}) {
            s.add((q * v + 0.3 * rng.direction()).normalized(), s.size * rng.uniform(0.01, 0.3));
        }
        if (rng.one_in(2)) s.add(rng.direction(), -s.size * rng.uniform(0, 1));
    }
    s.probe = s.size * rng.direction();
}

/// Any of the sets above, of 1 um to 10 m, with normals of any length; sometimes with the probe exactly on a
/// plane, or all of it 1000 km away.
inline PlaneScene any_planes(Rng& rng, bool feasible = true) {
    PlaneScene s;
    if (rng.one_in(3)) s.size = rng.scale(1e-6, 10);
    switch (feasible ? rng.between(0, 9) : 10) {
        case 0:
        case 1:
            wedge(rng, s);
            break;
        case 2:
            copies(rng, s);
            break;
        case 3:
            fan(rng, s);
            break;
        case 4:
            slab(rng, s);
            break;
        case 5:
            cavity(rng, s);
            break;
        case 10:
            contradictory(rng, s);
            break;
        default:
            corner(rng, s);
    }
    if (rng.one_in(20)) {
        const Vector n = knurl::to_eigen(s.planes[0].normal);
        s.probe -= (n.dot(s.probe) - s.planes[0].offset) * n;
    }
    if (rng.one_in(10)) {
        const Vector far = 1e6 * rng.direction();
        s.probe += far;
        for (knurl::Plane& p : s.planes) p.offset += knurl::to_eigen(p.normal).dot(far);
    }
    for (knurl::Plane& p : s.planes) {
        // The length of the normal is a power of two, so that opposite planes stay opposite to the bit.
        const double length = rng.one_in(4) ? std::ldexp(1, rng.between(-15, 9)) : 1;
        p.normal = {p.normal.x * length, p.normal.y * length, p.normal.z * length};
        p.offset *= length;
    }
    return s;
}

/// A plane as the reference sees it from a probe of that radius, `moved` s after it was placed.
inline exact::Touch touch_of(const knurl::Plane& p, const exact::V& probe, Real radius = 0, Real moved = 0,
                             Real max_stiffness = INFINITY) {
    const exact::V n = real(p.normal), velocity = real(p.velocity);
    const Real size = exact::length(n);
    Real k = p.stiffness;
    if (std::isinf(k)) k = std::isinf(max_stiffness) ? 1000 : max_stiffness;
    return {(1 / size) * n, exact::dot((1 / size) * n, probe - moved * velocity) - p.offset / size - radius,
            std::min(k, max_stiffness), p.damping, velocity};
}

inline std::vector<exact::Touch> touches_of(const std::vector<knurl::Plane>& planes, const exact::V& probe,
                                            Real radius = 0, Real moved = 0, Real max_stiffness = INFINITY) {
    std::vector<exact::Touch> out;
    for (const knurl::Plane& p : planes) out.push_back(touch_of(p, probe, radius, moved, max_stiffness));
    return out;
}

inline void add_all(Case& c, Scene& scene, const std::vector<knurl::Plane>& planes) {
    for (std::uint32_t i = 0; i < planes.size(); ++i) {
        c.require(bool(scene.add({i, 1}, planes[i])), "a legal plane is taken");
    }
}

/// m: the largest length that enters, coordinates included.
inline Real reach_of(const std::vector<knurl::Plane>& planes, const exact::V& probe,
                     const exact::Push& push) {
    Real reach = std::max(exact::length(probe), exact::length(push.dx));
    for (const knurl::Plane& p : planes) {
        reach = std::max(reach, std::fabs(static_cast<Real>(p.offset)) / exact::length(real(p.normal)));
    }
    return reach;
}

}  // namespace judge
