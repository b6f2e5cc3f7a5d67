#include "probe_device.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace knurl::capi {

ProbeDevice::ProbeDevice(double period) : period_(period) {
    link_.name = "probe";
    link_.description = "a probe that is where a program puts it; has no motors";
    link_.sensed_joints = 7;
    link_.actuated_joints = 6;
    link_.senses_orientation = true;
    link_.renders_torque = true;
    link_.radians_per_count.assign(7, 0);
    link_.effort_limit.assign(6, 0);
    sample_.position = {0, 0, 0, 1, 0, 0, 0};
    sample_.has_velocity = true;
}

bool ProbeDevice::put(const knurl_pose& pose) noexcept {
    const Eigen::Vector3d position(pose.position.x, pose.position.y, pose.position.z);
    Eigen::Quaterniond turned(pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z);
    Eigen::Vector3d velocity(pose.velocity.x, pose.velocity.y, pose.velocity.z);
    Eigen::Vector3d spin(pose.angular_velocity.x, pose.angular_velocity.y, pose.angular_velocity.z);
    const double length = turned.norm();
    if (!position.allFinite() || !velocity.allFinite() || !spin.allFinite() ||
        !(length > 1e-6 && std::isfinite(length)))
        return false;
    turned.coeffs() /= length;
    const auto& was = sample_.position;
    if (pose.has_velocity == 0) {
        // The way since the cycle before; the first cycle rests.
        const Eigen::Quaterniond before(was[3], was[4], was[5], was[6]);
        const Eigen::AngleAxisd way(turned * before.conjugate());
        velocity = was_put_ ? Eigen::Vector3d((position - Eigen::Vector3d(was.data())) / period_)
                            : Eigen::Vector3d::Zero();
        const double angle = way.angle() > M_PI ? way.angle() - 2 * M_PI : way.angle();
        spin = was_put_ ? Eigen::Vector3d(way.axis() * angle / period_) : Eigen::Vector3d::Zero();
    }
    sample_.position = {position.x(), position.y(), position.z(), turned.w(),
                        turned.x(),   turned.y(),   turned.z()};
    sample_.velocity = {velocity.x(), velocity.y(), velocity.z(), spin.x(), spin.y(), spin.z()};
    sample_.buttons = pose.buttons;
    was_put_ = true;
    return true;
}

}  // namespace knurl::capi
