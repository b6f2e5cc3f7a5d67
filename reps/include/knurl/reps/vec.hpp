#pragma once

/// @file
/// Plain vectors for parameters and reports. They cross process boundaries, so they are fixed-width structs
/// and never Eigen types (whose alignment changes with compiler flags); inside a computation use the Eigen
/// views.

#include <array>
#include <bit>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace knurl {

/// A vector.
struct Vec3 {
    /// x.
    double x = 0;
    /// y.
    double y = 0;
    /// z.
    double z = 0;
    friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// Unit quaternion, scalar first; turns vectors of the probe's frame into the world's.
struct Quat {
    /// Scalar part.
    double w = 1;
    /// x of the vector part.
    double x = 0;
    /// y of the vector part.
    double y = 0;
    /// z of the vector part.
    double z = 0;
    friend bool operator==(const Quat&, const Quat&) = default;
};

/// 3 x 3, row by row.
struct Mat3 {
    /// The elements.
    double at[9] = {};
    friend bool operator==(const Mat3&, const Mat3&) = default;
};

/// 6 x 6, row by row: a force and a torque (rows) by a displacement and a rotation vector (columns).
struct Mat6 {
    /// The elements.
    double at[36] = {};
    friend bool operator==(const Mat6&, const Mat6&) = default;
};

/// As an Eigen vector. Copied whole: built from its three numbers one by one it would be stored in pieces and
/// read back in one, which every processor takes a dozen cycles for.
inline Eigen::Vector3d to_eigen(const Vec3& v) noexcept {
    return Eigen::Vector3d(std::bit_cast<std::array<double, 3>>(v).data());
}
/// As an Eigen quaternion.
inline Eigen::Quaterniond to_eigen(const Quat& q) noexcept {
    return {q.w, q.x, q.y, q.z};
}
/// As an Eigen matrix.
inline Eigen::Matrix3d to_eigen(const Mat3& m) noexcept {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.at);
}
/// As an Eigen matrix.
inline Eigen::Matrix<double, 6, 6> to_eigen(const Mat6& m) noexcept {
    return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(m.at);
}
/// As a plain vector.
inline Vec3 to_plain(const Eigen::Vector3d& v) noexcept {
    return {v.x(), v.y(), v.z()};
}
/// As a plain matrix.
inline Mat3 to_mat3(const Eigen::Matrix3d& m) noexcept {
    Mat3 out;
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(out.at) = m;
    return out;
}
/// As a plain matrix.
inline Mat6 to_mat6(const Eigen::Matrix<double, 6, 6>& m) noexcept {
    Mat6 out;
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(out.at) = m;
    return out;
}
/// As a plain quaternion.
inline Quat to_plain(const Eigen::Quaterniond& q) noexcept {
    return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace knurl
