#pragma once
// Second derivatives of a signed distance: how the normal of a surface changes with place.

#include <Eigen/Core>

namespace knurl {

using Bend = Eigen::Matrix3d;  // 1/m

/// Bend of the distance from a point, in the direction of the unit vector n.
inline Bend bend_about_point(const Eigen::Vector3d& n, double distance) noexcept {
    if (!(distance > 1e-100)) return Bend::Zero();
    return (Bend::Identity() - n * n.transpose()) / distance;
}

/// Bend of a surface that curves in one direction only.
inline Bend bend_along(const Eigen::Vector3d& tangent, double curvature) noexcept {
    return curvature * tangent * tangent.transpose();
}

}  // namespace knurl
