#pragma once
// Where planes meet: x and the multipliers of planes that all touch, dx = sum u_i n_i with n_i . dx = s_i, in
// closed form. Computed anew from the planes each time, so that no rounding accumulates. Plain vectors stay
// in registers; an Eigen vector, stored by halves and loaded whole, waits for its own store.

#include <cmath>

#include <knurl/reps/contact_solver.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

struct Meeting {
    double x, y, z;     // m, dx
    double u0, u1, u2;  // m, of the planes that there are; else 0
    bool exists;        // false: not found, the normals are (nearly) dependent
};

namespace corner {

inline constexpr double dependent = 1e-13;  // a normal this close to the span of the others counts as in it

// From this determinant of the normals' Gram matrix on, no special care is needed: its inverse amplifies
// rounding to at most 5e-14 of the largest length. Two normals reach it from 8 degrees on.
inline constexpr double blunt = 0.02;

inline constexpr Meeting none = {0, 0, 0, 0, 0, 0, false};

inline Vec3 operator+(const Vec3& a, const Vec3& b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(double s, const Vec3& v) noexcept {
    return {s * v.x, s * v.y, s * v.z};
}
inline double dot(const Vec3& a, const Vec3& b) noexcept {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline Vec3 normal_of(const ContactPlanes& planes, std::uint32_t i) noexcept {
    return {planes.nx[i], planes.ny[i], planes.nz[i]};
}

// Two planes. w = b -+ a replaces b, so that every difference of nearly equal numbers is taken first, without
// rounding. A corner of a hundredth of a degree keeps all its digits, whichever way it opens.
struct Pair {
    Vec3 m, am, wm;           // a x b, a x m, w x m
    double sign, mm, per_mm;  // of a.b; |m|^2 and its inverse

    Pair(const Vec3& a, const Vec3& b) noexcept {
        sign = dot(a, b) < 0 ? -1 : 1;
        const Vec3 w = b - sign * a;
        m = cross(a, w);
        mm = dot(m, m);
        per_mm = 1 / mm;
        am = cross(a, m);
        wm = cross(w, m);
    }
    // Coefficients of v in a and b, for v in their span (or its part there).
    double along_a(const Vec3& v) const noexcept { return (sign * dot(v, am) + dot(v, wm)) * per_mm; }
    double along_b(const Vec3& v) const noexcept { return -dot(v, am) * per_mm; }
    Vec3 meet(double sa, double sb) const noexcept {
        return ((sign * sa - sb) * per_mm) * am + (sa * per_mm) * wm;
    }
};

// For blunt corners, in the fewest steps: N u = s with the Gram matrix N of the normals, by cofactors.
template <std::uint32_t Count>
[[gnu::always_inline]] inline Meeting meet_blunt(const ContactPlanes& planes, double give,
                                                 const ActiveSet& set) noexcept {
    const std::uint32_t i = set.plane[0];
    const double ax = planes.nx[i], ay = planes.ny[i], az = planes.nz[i], sa = planes.s[i] - give;
    if constexpr (Count == 1) return {sa * ax, sa * ay, sa * az, sa, 0, 0, true};

    const std::uint32_t j = set.plane[1];
    const double bx = planes.nx[j], by = planes.ny[j], bz = planes.nz[j], sb = planes.s[j] - give;
    const double ab = ax * bx + ay * by + az * bz, cc = 1 - ab * ab;
    if constexpr (Count == 2) {
        if (!(cc > blunt)) return none;
        const double per = 1 / cc, u0 = sa - ab * sb, u1 = sb - ab * sa;  // multiplied by cc
        return {(u0 * ax + u1 * bx) * per,
                (u0 * ay + u1 * by) * per,
                (u0 * az + u1 * bz) * per,
                u0 * per,
                u1 * per,
                0,
                true};
    }

    const std::uint32_t k = set.plane[2];
    const double cx = planes.nx[k], cy = planes.ny[k], cz = planes.nz[k], sc = planes.s[k] - give;
    const double bc = bx * cx + by * cy + bz * cz, ca = cx * ax + cy * ay + cz * az;
    const double aa = 1 - bc * bc, bb = 1 - ca * ca;
    const double mixed_ab = bc * ca - ab, mixed_bc = ca * ab - bc, mixed_ca = ab * bc - ca;
    const double det = aa + (ab * mixed_ab + ca * mixed_ca);
    if (!(det > blunt)) return none;
    const double per = 1 / det;
    const double u0 = aa * sa + mixed_ab * sb + mixed_ca * sc;  // multiplied by det
    const double u1 = mixed_ab * sa + bb * sb + mixed_bc * sc;
    const double u2 = mixed_ca * sa + mixed_bc * sb + cc * sc;
    return {(u0 * ax + u1 * bx + u2 * cx) * per,
            (u0 * ay + u1 * by + u2 * cy) * per,
            (u0 * az + u1 * bz + u2 * cz) * per,
            u0 * per,
            u1 * per,
            u2 * per,
            true};
}

// For two or three planes at any angle.
[[gnu::always_inline]] inline Meeting meet_sharp(const ContactPlanes& planes, double give,
                                                 const ActiveSet& set) noexcept {
    const auto s = [&](std::uint32_t j) { return planes.s[set.plane[j]] - give; };
    const auto n = [&](std::uint32_t j) { return normal_of(planes, set.plane[j]); };
    if (set.count == 2) {
        const Pair pair(n(0), n(1));
        const Vec3 dx = pair.meet(s(0), s(1));
        return {dx.x, dx.y, dx.z, pair.along_a(dx), pair.along_b(dx), 0, pair.mm > dependent * dependent};
    }
    // The two most nearly parallel planes first; then along their line to the third.
    const double ab = std::abs(dot(n(0), n(1))), bc = std::abs(dot(n(1), n(2))),
                 ca = std::abs(dot(n(2), n(0)));
    const std::uint32_t third = ab >= bc && ab >= ca ? 2 : bc >= ca ? 0 : 1;
    const std::uint32_t i = third == 0 ? 1 : 0, j = third == 2 ? 1 : 2;
    const Pair pair(n(i), n(j));
    const Vec3 c = n(third);
    const double d = dot(c, pair.m), dd = d * d;
    if (!(pair.mm > dependent * dependent) || !(dd > dependent * dependent * pair.mm)) return none;
    Vec3 dx = pair.meet(s(i), s(j));
    const double per_d = 1 / d;
    dx = dx + ((s(third) - dot(c, dx)) * per_d) * pair.m;
    // Three planes nearly along one line amplify the rounding of the first step, so it is removed.
    if (dd < 1e-2 * pair.mm) dx = dx + ((s(third) - dot(c, dx)) * per_d) * pair.m;
    const double uc = dot(dx, pair.m) * per_d;
    const Vec3 rest = dx - uc * c;
    const double ui = pair.along_a(rest), uj = pair.along_b(rest);
    return {
        dx.x, dx.y, dx.z, third == 0 ? uc : ui, third == 1 ? uc : third == 0 ? ui : uj, third == 2 ? uc : uj,
        true};
}

}  // namespace corner
}  // namespace knurl
