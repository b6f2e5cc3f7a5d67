#pragma once
// Published ways to solve several planes at once, from their formulas: dx of the nearest point with n_i . dx
// >= s_i, or its substitute. All planes are relative to the probe.

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace knurl::error {

template <class Real>
using Vector = Eigen::Matrix<Real, 3, 1>;

template <class Real>
struct Shifted {
    const Real *nx, *ny, *nz, *s;
    std::uint32_t count;

    Vector<Real> normal(std::uint32_t i) const { return {nx[i], ny[i], nz[i]}; }
    Real along(std::uint32_t i, const Vector<Real>& v) const {
        return nx[i] * v.x() + ny[i] * v.y() + nz[i] * v.z();
    }
    /// Index of the plane that dx violates most.
    std::uint32_t worst(const Vector<Real>& dx) const {
        std::uint32_t q = 0;
        Real most = -std::numeric_limits<Real>::infinity();
        for (std::uint32_t i = 0; i < count; ++i) {
            const Real v = s[i] - along(i, dx);
            if (v > most) most = v, q = i;
        }
        return q;
    }
};

/// Armlib, VRPN: each plane pushes by its own depth. Not shifted: `planes.s` are the offsets, p the probe.
template <class Real>
Vector<Real> naive_sum(const Shifted<Real>& planes, const Vector<Real>& p) {
    Real x = 0, y = 0, z = 0;
    for (std::uint32_t i = 0; i < planes.count; ++i) {
        const Real height = planes.s[i] - planes.along(i, p), depth = height > 0 ? height : Real(0);
        x += depth * planes.nx[i], y += depth * planes.ny[i], z += depth * planes.nz[i];
    }
    return {x, y, z};
}

/// Successive projections onto the planes, which end at a feasible point, not the nearest.
template <class Real>
Vector<Real> sequential_projections(const Shifted<Real>& planes, int sweeps) {
    Vector<Real> dx = Vector<Real>::Zero();
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (std::uint32_t i = 0; i < planes.count; ++i) {
            const Real v = planes.s[i] - planes.along(i, dx);
            if (v > 0) dx += v * planes.normal(i);
        }
    }
    return dx;
}

/// Hildreth 1957 (Dykstra's projections for half-spaces): coordinate ascent on the multipliers.
template <class Real>
Vector<Real> hildreth(const Shifted<Real>& planes, int sweeps, std::vector<Real>& multiplier) {
    multiplier.assign(planes.count, 0);
    Vector<Real> dx = Vector<Real>::Zero();
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (std::uint32_t i = 0; i < planes.count; ++i) {
            const Real step = std::max(-multiplier[i], planes.s[i] - planes.along(i, dx));
            multiplier[i] += step;
            dx += step * planes.normal(i);
        }
    }
    return dx;
}

/// The part of v that does not move along the normals of a and b (b may be null).
template <class Real>
Vector<Real> within(const Vector<Real>& v, const Vector<Real>* a, const Vector<Real>* b) {
    if (!a) return v;
    if (!b) return v - a->dot(v) * *a;
    const Vector<Real> line = a->cross(*b);
    const Real square = line.squaredNorm();
    return square > 0 ? Vector<Real>((line.dot(v) / square) * line) : Vector<Real>(Vector<Real>::Zero());
}

/// The proxy in three steps (Zilles & Salisbury 1994, as usually built): from a free point straight to the
/// probe until the first plane, along it until the second, along both until the third.
template <class Real>
Vector<Real> three_step_proxy(const Shifted<Real>& planes, const Vector<Real>& free) {
    Vector<Real> at = free;
    std::array<Vector<Real>, 2> hit;
    std::array<std::uint32_t, 3> index{};
    for (std::uint32_t steps = 0; steps < 3; ++steps) {
        const Vector<Real> way =
            within<Real>(-at, steps > 0 ? &hit[0] : nullptr, steps > 1 ? &hit[1] : nullptr);
        Real share = 1;
        bool blocked = false;
        for (std::uint32_t i = 0; i < planes.count; ++i) {
            if ((steps > 0 && i == index[0]) || (steps > 1 && i == index[1])) continue;
            const Real speed = planes.along(i, way);
            const Real height = planes.along(i, at) - planes.s[i];
            if (speed < 0 && height + share * speed < 0) {
                share = std::max(Real(0), -height / speed);
                index[steps] = i;
                blocked = true;
            }
        }
        at += share * way;
        if (!blocked) break;
        if (steps < 2) hit[steps] = planes.normal(index[steps]);
    }
    return at;
}

/// A dual active set (Goldfarb & Idnani 1983), without shortcuts, to test other precisions.
template <class Real>
class ActiveSetMethod {
  public:
    std::uint32_t count = 0;  // the guess, and the planes that hold dx
    std::array<std::uint32_t, 3> plane{};

    Vector<Real> solve(const Shifted<Real>& planes) {
        const Real worst = planes.s[planes.worst(Vector<Real>::Zero())];
        if (!(worst > 0)) {
            count = 0;
            return Vector<Real>::Zero();
        }
        const Real tolerance = 8 * std::numeric_limits<Real>::epsilon() * worst;
        bool good = count > 0 && meet(planes);
        for (std::uint32_t j = 0; good && j < count; ++j) good = u_[j] >= 0;
        if (!good) count = 0, dx_.setZero();
        for (int step = 0; step < 40; ++step) {
            const std::uint32_t q = planes.worst(dx_);
            if (planes.s[q] - planes.along(q, dx_) <= tolerance * (1 + dx_.norm() / worst) || holds(q)) break;
            take_in(planes, q);
            meet(planes);
        }
        return dx_;
    }

  private:
    Vector<Real> dx_ = Vector<Real>::Zero();
    std::array<Real, 3> u_{};

    bool holds(std::uint32_t q) const {
        for (std::uint32_t j = 0; j < count; ++j) {
            if (plane[j] == q) return true;
        }
        return false;
    }

    /// All held planes touch.
    bool meet(const Shifted<Real>& planes) {
        const auto n = [&](std::uint32_t j) { return planes.normal(plane[j]); };
        const auto s = [&](std::uint32_t j) { return planes.s[plane[j]]; };
        if (count == 1) {
            u_[0] = s(0);
            dx_ = s(0) * n(0);
        } else if (count == 2) {
            const Vector<Real> a = n(0), b = n(1), m = a.cross(b);
            const Real square = m.squaredNorm(), g = a.dot(b);
            if (!(square > 0)) return false;
            u_[0] = (s(0) - g * s(1)) / square;
            u_[1] = (s(1) - g * s(0)) / square;
            dx_ = (s(0) * b.cross(m) + s(1) * m.cross(a)) / square;
        } else if (count == 3) {
            const Vector<Real> bc = n(1).cross(n(2)), ca = n(2).cross(n(0)), ab = n(0).cross(n(1));
            const Real d = n(0).dot(bc);
            if (d == 0) return false;
            dx_ = (s(0) * bc + s(1) * ca + s(2) * ab) / d;
            u_ = {dx_.dot(bc) / d, dx_.dot(ca) / d, dx_.dot(ab) / d};
        }
        return true;
    }

    /// n = sum r_j n_j + z.
    Vector<Real> split(const Shifted<Real>& planes, const Vector<Real>& n, std::array<Real, 3>& r) const {
        if (count == 0) return n;
        const Vector<Real> a = planes.normal(plane[0]);
        if (count == 1) {
            r[0] = a.dot(n);
            return n - r[0] * a;
        }
        const Vector<Real> b = planes.normal(plane[1]), m = a.cross(b);
        Vector<Real> rest = n, z = Vector<Real>::Zero();
        if (count == 3) {
            const Vector<Real> c = planes.normal(plane[2]);
            r[2] = n.dot(m) / c.dot(m);
            rest -= r[2] * c;
        } else {
            z = (n.dot(m) / m.squaredNorm()) * m;
            rest -= z;
        }
        const Real g = a.dot(b), square = m.squaredNorm();
        r[0] = (rest.dot(a) - g * rest.dot(b)) / square;
        r[1] = (rest.dot(b) - g * rest.dot(a)) / square;
        return z;
    }

    void take_in(const Shifted<Real>& planes, std::uint32_t q) {
        constexpr Real never = std::numeric_limits<Real>::infinity();
        const Vector<Real> n = planes.normal(q);
        Real uq = 0;
        for (int round = 0; round < 4; ++round) {
            std::array<Real, 3> r{};
            const Vector<Real> z = split(planes, n, r);
            Real most = never;
            std::uint32_t leaves = 0;
            for (std::uint32_t j = 0; j < count; ++j) {
                if (r[j] > 0 && u_[j] / r[j] < most) most = u_[j] / r[j], leaves = j;
            }
            const Real square = z.squaredNorm(), epsilon = std::numeric_limits<Real>::epsilon();
            const Real full =
                count < 3 && square > 64 * epsilon * epsilon ? (planes.s[q] - n.dot(dx_)) / square : never;
            if (most == never && full == never) return;  // contradictory: this is the best solution
            const Real t = std::min(most, full);
            if (full < never) dx_ += t * z;
            for (std::uint32_t j = 0; j < count; ++j) u_[j] -= t * r[j];
            uq += t;
            if (full <= most) {
                plane[count] = q;
                u_[count++] = uq;
                return;
            }
            for (std::uint32_t j = leaves; j < 2; ++j) plane[j] = plane[j + 1], u_[j] = u_[j + 1];
            --count;
        }
    }
};

}  // namespace knurl::error
