#include <algorithm>
#include <cmath>
#include <numbers>

#include <knurl/drivers/cartesian_tool.hpp>

namespace knurl::drivers {

Eigen::Matrix3d CartesianTool::left_jacobian(const Eigen::Vector3d& rotation) noexcept {
    // J = I + (1 - cos a)/a^2 [r] + (a - sin a)/a^3 [r]^2; for small a by the series of both factors.
    const double squared = rotation.squaredNorm(), angle = std::sqrt(squared);
    constexpr double small = 1e-3;
    const double first = angle < small ? 0.5 - squared / 24 : (1 - std::cos(angle)) / squared;
    const double second =
        angle < small ? 1.0 / 6 - squared / 120 : (angle - std::sin(angle)) / (squared * angle);
    Eigen::Matrix3d cross;
    cross << 0, -rotation.z(), rotation.y(), rotation.z(), 0, -rotation.x(), -rotation.y(), rotation.x(), 0;
    return Eigen::Matrix3d::Identity() + first * cross + second * cross * cross;
}

Eigen::Vector3d CartesianTool::rotation_near(const Eigen::Quaterniond& orientation,
                                             const Eigen::Vector3d& last) noexcept {
    const double length = orientation.vec().norm();
    if (!(length > 1e-12)) {
        // No turn, or a whole one about the same axis as before.
        const double whole = 2 * std::numbers::pi, size = last.norm();
        return size > std::numbers::pi ? Eigen::Vector3d(last * (whole / size)) : Eigen::Vector3d::Zero();
    }
    const double angle = 2 * std::atan2(length, orientation.w());  // 0 to 2 pi
    const Eigen::Vector3d axis = orientation.vec() / length;
    const Eigen::Vector3d one = axis * angle, other = axis * (angle - 2 * std::numbers::pi);
    return (one - last).squaredNorm() <= (other - last).squaredNorm() ? one : other;
}

bool CartesianTool::forward(std::span<const double> joints, TipPose& pose,
                            Jacobian& jacobian) const noexcept {
    const auto count = static_cast<std::size_t>(this->joints());
    if (joints.size() < count) return false;
    if (!std::ranges::all_of(joints.first(count), [](double joint) { return std::isfinite(joint); }))
        return false;
    pose.position = {joints[0], joints[1], joints[2]};
    pose.orientation.setIdentity();
    jacobian.setZero();
    jacobian.topLeftCorner<3, 3>().setIdentity();
    if (!wrist_) return true;
    const auto at = static_cast<std::size_t>(rotation());
    const Eigen::Vector3d turn(joints[at], joints[at + 1], joints[at + 2]);
    const double angle = turn.norm();
    if (angle >= 2 * std::numbers::pi) return false;
    if (angle > 0) pose.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
    jacobian.block<3, 3>(3, rotation()) = left_jacobian(turn);
    return true;
}

}  // namespace knurl::drivers
