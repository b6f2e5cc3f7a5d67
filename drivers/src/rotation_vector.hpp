#pragma once
// Quaternion <-> rotation vector (axis times angle, rad).

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace knurl::drivers {

/// The shorter rotation from a to b, in the frame of both. Uses atan2, since acos loses half the digits of a
/// small angle.
inline Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    Eigen::Quaterniond step = b * a.conjugate();
    if (step.w() < 0) {
        step.coeffs() = -step.coeffs();
    }
    const double sine = step.vec().norm();
    if (sine == 0) {
        return Eigen::Vector3d::Zero();
    }
    return step.vec() * (2 * std::atan2(sine, step.w()) / sine);
}

inline Eigen::Quaterniond rotation(const Eigen::Vector3d& vector) {
    const double angle = vector.norm();
    if (angle == 0) {
        return Eigen::Quaterniond::Identity();
    }
    Eigen::Quaterniond q;
    q.w() = std::cos(angle / 2);
    q.vec() = vector * (std::sin(angle / 2) / angle);
    return q;
}

}  // namespace knurl::drivers
