#include <cmath>
#include <limits>

#include <knurl/servo/servo.hpp>

namespace knurl::servo {

double max_stiffness(const drivers::LinkConfig& link, double rate) noexcept {
    if (link.measured_max_stiffness > 0) return link.measured_max_stiffness;
    const double damping = link.damping + link.grip_damping;
    if (!(damping > 0)) return 1000;  // N/m: the default without data
    return damping / (0.5 / rate + link.lag);
}

protocol::Frame frame_for(const drivers::LinkConfig& link, const protocol::ClaimRequest& request) noexcept {
    protocol::Frame frame;
    frame.device_centre = {link.workspace_centre[0], link.workspace_centre[1], link.workspace_centre[2]};
    frame.world_centre = request.workspace_centre;
    const double scale = request.workspace_radius / link.workspace_radius;
    if (std::isfinite(scale) && scale > 0) frame.scale = scale;
    return frame;
}

Limits limits_for(const drivers::LinkConfig& link, double rate, const protocol::Frame& frame) noexcept {
    // x_world = s x_device and F_device = f F_world, so k_device = f s k_world, and b likewise; torque is
    // force times a lever arm, which scales with s.
    const auto stated = [](double limit) {
        return limit > 0 ? limit : std::numeric_limits<double>::infinity();
    };
    const double fs = frame.force_scale * frame.scale;
    // The same bound as for stiffness, for rotation.
    const double torsion = link.rotational_damping / (0.5 / rate + link.lag);
    return {.max_stiffness = max_stiffness(link, rate) / fs,
            .max_force = stated(link.peak_force) / frame.force_scale,
            .max_torque = stated(link.peak_torque) * frame.scale / frame.force_scale,
            .max_torsion = stated(torsion) * frame.scale / frame.force_scale,
            .damping = link.damping / fs,
            .mass = link.apparent_mass / fs,
            .lag = link.lag,
            .period = 1 / rate,
            .resolution = Limits{}.resolution * frame.scale,
            .metre = frame.scale,
            .newton = 1 / frame.force_scale};
}

}  // namespace knurl::servo
