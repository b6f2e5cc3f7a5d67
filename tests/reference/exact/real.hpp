#pragma once
// The reference's numbers and vectors, in long double (64 bits of mantissa on x86). Nothing here comes from
// reps/ or from a library, so they share no mistake.

#include <algorithm>
#include <cmath>

namespace exact {

using Real = long double;

inline constexpr Real pi = 3.14159265358979323846264338327950288L;

struct V {
    Real x = 0, y = 0, z = 0;
};

inline V operator+(const V& a, const V& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline V operator-(const V& a, const V& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline V operator-(const V& a) {
    return {-a.x, -a.y, -a.z};
}
inline V operator*(Real s, const V& a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline V& operator+=(V& a, const V& b) {
    return a = a + b;
}
inline Real dot(const V& a, const V& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline V cross(const V& a, const V& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real length(const V& a) {
    return std::sqrt(dot(a, a));
}
inline V unit(const V& a) {
    return (1 / length(a)) * a;
}
/// The part of v perpendicular to the unit vector n. The second step removes the rounding of the first.
inline V flattened(const V& v, const V& n) {
    const V once = v - dot(v, n) * n;
    return once - dot(once, n) * n;
}
/// Any unit vector perpendicular to n.
inline V across(const V& n) {
    const Real x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
    const V axis = x <= y && x <= z ? V{1, 0, 0} : (y <= z ? V{0, 1, 0} : V{0, 0, 1});
    return unit(cross(n, axis));
}
inline bool finite(const V& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
/// No longer than `most`, in the same direction.
inline V capped(const V& a, Real most) {
    const Real size = length(a);
    return size > most ? most / size * a : a;
}

/// A rotation as a quaternion of any length.
struct Turn {
    Real w = 1, x = 0, y = 0, z = 0;
};
inline V turned(const Turn& q, const V& v) {
    const V u{q.x, q.y, q.z};
    const Real norm = q.w * q.w + dot(u, u);
    return (1 / norm) * (2 * dot(u, v) * u + (q.w * q.w - dot(u, u)) * v + 2 * q.w * cross(u, v));
}
inline V turned_back(const Turn& q, const V& v) {
    return turned({q.w, -q.x, -q.y, -q.z}, v);
}

}  // namespace exact
