#pragma once
// Three doubles that stay in registers. Eigen's vectors go through memory here: stored in halves and loaded
// whole, they make the processor wait (half of the walk's time).

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace knurl::detail {

struct Vec {
    double x, y, z;

    double operator[](int axis) const noexcept { return axis == 0 ? x : axis == 1 ? y : z; }
    double dot(const Vec& b) const noexcept { return x * b.x + y * b.y + z * b.z; }
    Vec cross(const Vec& b) const noexcept {
        return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
    }
    double squaredNorm() const noexcept { return dot(*this); }
    double norm() const noexcept { return std::sqrt(dot(*this)); }
    /// NaN if a component is NaN, which `largest` may overlook.
    double sum_of_sizes() const noexcept { return std::abs(x) + std::abs(y) + std::abs(z); }
    double largest() const noexcept { return std::max(std::max(std::abs(x), std::abs(y)), std::abs(z)); }
};

inline Vec operator+(const Vec& a, const Vec& b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec operator-(const Vec& a, const Vec& b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec operator*(const Vec& a, double s) noexcept {
    return {a.x * s, a.y * s, a.z * s};
}
inline Vec& operator+=(Vec& a, const Vec& b) noexcept {
    return a = a + b;
}
/// The low corner of a box around a and b, `more` larger on every side.
inline Vec low_of(const Vec& a, const Vec& b, double more) noexcept {
    return {std::min(a.x, b.x) - more, std::min(a.y, b.y) - more, std::min(a.z, b.z) - more};
}
inline Vec high_of(const Vec& a, const Vec& b, double more) noexcept {
    return {std::max(a.x, b.x) + more, std::max(a.y, b.y) + more, std::max(a.z, b.z) + more};
}
inline Vec unit_or_zero(const Vec& v) noexcept {
    const double length = v.norm();
    return length > 0 ? v * (1 / length) : Vec{0, 0, 0};
}
inline Vec to_vec(const Eigen::Vector3d& v) noexcept {
    return {v.x(), v.y(), v.z()};
}
inline Eigen::Vector3d to_eigen(const Vec& v) noexcept {
    return {v.x, v.y, v.z};
}

}  // namespace knurl::detail
