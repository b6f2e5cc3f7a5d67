#pragma once
// Second derivatives of a signed distance: how the normal of a surface turns from place to place.

#include <Eigen/Core>

namespace knurl {

using Bend = Eigen::Matrix3d;  // 1/m

/// Of the distance from a point in the direction of the unit vector n.
inline Bend bend_about_point(const Eigen::Vector3d& n, double distance) noexcept {
    if (!(distance > 1e-100)) return Bend::Zero();
    return (Bend::Identity() - n * n.transpose()) / distance;
}

/// Of a surface that curves in one direction alone.
inline Bend bend_along(const Eigen::Vector3d& tangent, double curvature) noexcept {
    return curvature * tangent * tangent.transpose();
}

}  // namespace knurl
