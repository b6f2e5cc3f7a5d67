#pragma once
// World = scale (device - device_centre) + world_centre; device force = force_scale x world force.
// Orientation is the same in both, so lengths scale and angles do not. Torques follow from power: f.v is
// smaller in the world than in the device frame by scale / force_scale, and the same must hold for torque x
// angular velocity.

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/report.hpp>

namespace knurl::detail {

inline Vec3 scaled(const Vec3& v, double by) noexcept {
    return {v.x * by, v.y * by, v.z * by};
}

inline Vec3 point_to_world(const protocol::Frame& frame, const Vec3& p) noexcept {
    return {frame.scale * (p.x - frame.device_centre.x) + frame.world_centre.x,
            frame.scale * (p.y - frame.device_centre.y) + frame.world_centre.y,
            frame.scale * (p.z - frame.device_centre.z) + frame.world_centre.z};
}

inline Report to_world(const protocol::Frame& frame, Report report) noexcept {
    const double force = 1 / frame.force_scale;
    const double torque = frame.scale / frame.force_scale;
    report.position = point_to_world(frame, report.position);
    report.contact_point = point_to_world(frame, report.contact_point);
    report.velocity = scaled(report.velocity, frame.scale);
    report.slow_velocity = scaled(report.slow_velocity, frame.scale);
    report.scene_force = scaled(report.scene_force, force);
    report.sent_force = scaled(report.sent_force, force);
    report.scene_torque = scaled(report.scene_torque, torque);
    report.sent_torque = scaled(report.sent_torque, torque);
    return report;
}

}  // namespace knurl::detail
