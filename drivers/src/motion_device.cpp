#include <algorithm>
#include <cmath>

#include <knurl/drivers/motion_device.hpp>

namespace knurl::drivers {

MotionDevice::MotionDevice(Motion motion) : motion_(std::move(motion)) {
    link_.name = "motion";
    link_.description = "a probe exactly on a motion; has no motors";
    link_.sensed_joints = 7;
    link_.actuated_joints = 6;
    link_.senses_orientation = true;
    link_.renders_torque = true;
    link_.radians_per_count.assign(7, 0);
    link_.effort_limit.assign(6, 0);
}

ReadStatus MotionDevice::read(Nanoseconds now, JointSample& sample) noexcept {
    double t;
    if (time_) {
        t = *time_;
    } else {
        t = static_cast<double>(now) * 1e-9;
        const auto& rows = motion_.rows();
        const auto row = std::lower_bound(rows.begin(), rows.end(), t - 1e-9,
                                          [](const MotionRow& a, double time) { return a.t < time; });
        if (row != rows.end() && std::abs(row->t - t) < 1e-9) {
            t = row->t;
        }
    }
    const MotionSample here = motion_.sample(t, hint_);
    const Eigen::Quaterniond& q = here.orientation;
    sample = {};
    sample.position = {here.position.x(), here.position.y(), here.position.z(), q.w(), q.x(), q.y(), q.z()};
    sample.velocity = {here.velocity.x(),         here.velocity.y(),         here.velocity.z(),
                       here.angular_velocity.x(), here.angular_velocity.y(), here.angular_velocity.z()};
    sample.has_velocity = true;
    return ReadStatus::ok;
}

}  // namespace knurl::drivers
