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

/// Turns reports into the world, in place. Most frames move points alone, and those of observers nothing: what
/// would be added to 0 or multiplied by 1 is left as it is.
class ToWorld {
  public:
    explicit ToWorld(const protocol::Frame& frame) noexcept
        : frame_(frame),
          force_(1 / frame.force_scale),
          torque_(frame.scale / frame.force_scale),
          scales_(frame.scale != 1 || frame.force_scale != 1),
          moves_(scales_ || !(frame.device_centre == frame.world_centre)) {}

    void operator()(Report& report) const noexcept {
        if (!moves_) return;
        move(report.position);
        move(report.contact_point);
        if (!scales_) return;
        scale(report.velocity, frame_.scale);
        scale(report.slow_velocity, frame_.scale);
        scale(report.scene_force, force_);
        scale(report.scene_torque, torque_);
        scale(report.sent_force, force_);
        scale(report.sent_torque, torque_);
    }

  private:
    static void scale(Vec3& v, double by) noexcept {
        v.x *= by;
        v.y *= by;
        v.z *= by;
    }
    void move(Vec3& p) const noexcept {
        p = {frame_.scale * (p.x - frame_.device_centre.x) + frame_.world_centre.x,
             frame_.scale * (p.y - frame_.device_centre.y) + frame_.world_centre.y,
             frame_.scale * (p.z - frame_.device_centre.z) + frame_.world_centre.z};
    }

    protocol::Frame frame_;
    double force_, torque_;
    bool scales_, moves_;
};

inline Report to_world(const protocol::Frame& frame, Report report) noexcept {
    ToWorld{frame}(report);
    return report;
}

}  // namespace knurl::detail
