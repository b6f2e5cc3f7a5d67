#pragma once
// Random and hostile sets of planes, each with a known free point, so that "infeasible" would be wrong.

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <knurl/reps/contact_solver.hpp>

namespace knurl::test {

using Rng = std::mt19937_64;
using Real = long double;
using RealVector = Eigen::Matrix<Real, 3, 1>;

/// The long form of a property test: KNURL_LONG=1 in the environment.
inline bool long_form() {
    return std::getenv("KNURL_LONG") != nullptr;
}

inline double uniform(Rng& rng, double low, double high) {
    return std::uniform_real_distribution<>(low, high)(rng);
}
/// Evenly in the logarithm.
inline double scale(Rng& rng, double low, double high) {
    return std::exp(uniform(rng, std::log(low), std::log(high)));
}
inline int between(Rng& rng, int low, int high) {
    return std::uniform_int_distribution<>(low, high)(rng);
}

inline Eigen::Vector3d direction(Rng& rng) {
    std::normal_distribution<> normal;
    Eigen::Vector3d v;
    do {
        v = {normal(rng), normal(rng), normal(rng)};
    } while (v.norm() < 1e-3);
    return v.normalized();
}

struct PlaneSet {
    std::string family;
    explicit PlaneSet(std::string name = "") : family(std::move(name)) {}

    std::vector<double> nx, ny, nz, c;
    Eigen::Vector3d probe = Eigen::Vector3d::Zero();

    void add(const Eigen::Vector3d& n, double offset) {
        nx.push_back(n.x()), ny.push_back(n.y()), nz.push_back(n.z()), c.push_back(offset);
    }
    std::uint32_t size() const { return static_cast<std::uint32_t>(c.size()); }
    Eigen::Vector3d normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }

    struct Shifted {
        std::vector<double> s;
        double worst = 0;
        ContactPlanes planes;
    };
    Shifted shifted() const {
        Shifted out;
        out.s.resize(c.size());
        out.worst = shift_to_probe(nx.data(), ny.data(), nz.data(), c.data(), size(), probe, out.s.data());
        out.planes = {nx.data(), ny.data(), nz.data(), out.s.data(), size()};
        return out;
    }
};

/// Normals within 80 degrees of an axis about a common point, the probe inside: what a hand in a corner
/// meets.
inline PlaneSet corner(Rng& rng, int count, double size) {
    PlaneSet set("corner");
    const Eigen::Vector3d axis = direction(rng);
    for (int i = 0; i < count; ++i) {
        Eigen::Vector3d n;
        do {
            n = direction(rng);
        } while (n.dot(axis) < std::cos(80 * M_PI / 180));
        set.add(n, uniform(rng, -size, size) * 0.3);
    }
    set.probe = -axis * uniform(rng, 0, size) + size * 0.5 * direction(rng);
    return set;
}

/// Two planes with an opening angle from 0.01 to 179.99 degrees, and a third at random.
inline PlaneSet wedge(Rng& rng, double size) {
    PlaneSet set("wedge");
    const double opening = scale(rng, 0.01, 179.99) * M_PI / 180;
    const Eigen::Vector3d axis = direction(rng), up = axis.cross(direction(rng)).normalized(),
                          side = axis.cross(up);
    const double half = opening / 2;
    set.add(std::sin(half) * up + std::cos(half) * side, 0);
    set.add(std::sin(half) * up - std::cos(half) * side, 0);
    if (between(rng, 0, 1)) set.add((axis + 0.3 * up).normalized(), 0);
    set.probe = size * (uniform(rng, -1, 0.2) * up + uniform(rng, -1, 1) * side + uniform(rng, -1, 1) * axis);
    return set;
}

/// Copies of one plane, tilted and moved by 1e-3 to 1e-17.
inline PlaneSet copies(Rng& rng, double size) {
    PlaneSet set("copies");
    const Eigen::Vector3d n = direction(rng);
    const int count = between(rng, 2, 9);
    for (int i = 0; i < count; ++i) {
        const double off = scale(rng, 1e-17, 1e-3);
        set.add((n + off * direction(rng)).normalized(), between(rng, 0, 1) ? 0 : off * size);
    }
    set.probe = -size * uniform(rng, 0, 1) * n + 0.3 * size * direction(rng);
    return set;
}

/// A flat fan: normals that all but lie in one plane, up to 179 degrees apart.
inline PlaneSet fan(Rng& rng, double size) {
    PlaneSet set("fan");
    const Eigen::Vector3d axis = direction(rng), up = axis.cross(direction(rng)).normalized(),
                          side = axis.cross(up);
    const int count = between(rng, 3, 9);
    const double out = scale(rng, 1e-9, 1e-1);
    for (int i = 0; i < count; ++i) {
        const double angle = uniform(rng, -1, 1) * 89.5 * M_PI / 180;
        set.add(
            (std::cos(angle) * up + std::sin(angle) * side + out * uniform(rng, -1, 1) * axis).normalized(),
            0);
    }
    set.probe = size * (uniform(rng, -1, 0.1) * up + uniform(rng, -1, 1) * side + uniform(rng, -1, 1) * axis);
    return set;
}

/// Two planes that face each other across a gap of 1 nm to 1 mm, and a wall across them.
inline PlaneSet slab(Rng& rng, double size) {
    PlaneSet set("slab");
    const Eigen::Vector3d n = direction(rng);
    const double gap = scale(rng, 1e-9, 1e-3);
    set.add(n, 0);
    set.add(-n, -gap);
    if (between(rng, 0, 1)) set.add(n.cross(direction(rng)).normalized(), 0);
    set.probe = size * uniform(rng, -1, 1) * n + 0.3 * size * direction(rng);
    return set;
}

/// The inside of a polyhedron about the origin: planes all around, the probe outside.
inline PlaneSet cavity(Rng& rng, int count, double size) {
    PlaneSet set("cavity");
    for (int i = 0; i < count; ++i) set.add(direction(rng), -size * uniform(rng, 0.3, 1));
    set.probe = size * uniform(rng, 0.5, 3) * direction(rng);
    return set;
}

inline PlaneSet any_set(Rng& rng) {
    const int kind = between(rng, 0, 9);
    const double size = between(rng, 0, 3) == 0 ? scale(rng, 1e-6, 10) : 0.01;
    PlaneSet set;
    switch (kind) {
        case 0:
            set = wedge(rng, size);
            break;
        case 1:
            set = copies(rng, size);
            break;
        case 2:
            set = fan(rng, size);
            break;
        case 3:
            set = slab(rng, size);
            break;
        case 4:
            set = cavity(rng, between(rng, 4, 24), size);
            break;
        default:
            set = corner(rng, between(rng, 1, 9), size);
            break;
    }
    if (between(rng, 0, 19) == 0) {  // exactly on the first plane
        set.probe -= (set.normal(0).dot(set.probe) - set.c[0]) * set.normal(0);
    }
    if (between(rng, 0, 9) == 0) {  // a thousand kilometres away
        const Eigen::Vector3d far = 1e6 * direction(rng);
        set.probe += far;
        for (std::size_t i = 0; i < set.c.size(); ++i) set.c[i] += set.normal(i).dot(far);
        set.family += ", far";
    }
    return set;
}

}  // namespace knurl::test
