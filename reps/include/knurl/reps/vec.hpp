#pragma once
// Plain vectors for parameters and reports. They cross process boundaries, so they are fixed-width structs
// and never Eigen types (whose alignment changes with compiler flags); inside a computation use the Eigen
// views.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace knurl {

struct Vec3 {
    double x = 0, y = 0, z = 0;
    friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// Unit quaternion, scalar first; turns vectors of the probe's frame into the world's.
struct Quat {
    double w = 1, x = 0, y = 0, z = 0;
    friend bool operator==(const Quat&, const Quat&) = default;
};

inline Eigen::Vector3d to_eigen(const Vec3& v) noexcept {
    return {v.x, v.y, v.z};
}
inline Eigen::Quaterniond to_eigen(const Quat& q) noexcept {
    return {q.w, q.x, q.y, q.z};
}
inline Vec3 to_plain(const Eigen::Vector3d& v) noexcept {
    return {v.x(), v.y(), v.z()};
}
inline Quat to_plain(const Eigen::Quaterniond& q) noexcept {
    return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace knurl
