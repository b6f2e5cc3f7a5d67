#pragma once

/// @file
/// How well an arm can move its tip every way, as a number.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <knurl/drivers/mechanism.hpp>

namespace knurl::drivers {

/// Smallest over largest singular value of the position's Jacobian, columns 0 to `joints` - 1: 1 where the
/// tip moves alike in all directions, 0 in a singular posture, where it cannot move in one of them at all.
/// Exact to about 1e-8, since it comes from J J^T: three eigenvalues in closed form (O. K. Smith, CACM 4(4),
/// 1961). No loop, nothing allocated: fit for a cycle.
inline double conditioning(const Jacobian& jacobian, int joints) noexcept {
    const auto j = jacobian.topRows<3>().leftCols(joints);
    const Eigen::Matrix3d m = j * j.transpose();
    const double mean = m.trace() / 3;
    if (!(mean > 0)) return 0;
    const Eigen::Matrix3d deviation = m - mean * Eigen::Matrix3d::Identity();
    const double size = std::sqrt(deviation.squaredNorm() / 6);
    if (!(size > 1e-15 * mean)) return 1;
    const Eigen::Matrix3d b = deviation / size;
    const double half = 0.5 * b.row(0).dot(b.row(1).cross(b.row(2)));
    const double angle = std::acos(std::clamp(half, -1.0, 1.0)) / 3;
    const double greatest = mean + 2 * size * std::cos(angle);
    const double least = mean + 2 * size * std::cos(angle + 2 * std::numbers::pi / 3);
    return std::sqrt(std::max(0.0, least) / greatest);
}

}  // namespace knurl::drivers
