#include <knurl/reps/viscosity.hpp>

#include "scene/clamped.hpp"

namespace knurl {

Viscosity prepared(Viscosity params, const Limits& limits) noexcept {
    params.damping = clamped_damping(params.damping, limits);
    // A device's stable stiffness and damping grow with its own damping, for rotation as for translation.
    const double ratio = limits.max_torsion / limits.max_stiffness;
    if (std::isfinite(limits.max_torsion) && std::isfinite(ratio))
        params.angular_damping = std::min(params.angular_damping, largest_damping(limits) * ratio);
    return params;
}

void adopt(const Viscosity&, const Viscosity*, Viscosity::State&, const Probe&) noexcept {}

Wrench evaluate(const Viscosity& params, Viscosity::State&, const Probe& probe, double) noexcept {
    return {.force = -params.damping * probe.velocity,
            .torque = -params.angular_damping * probe.angular_velocity};
}

HandLoad load(const Viscosity& params, const Viscosity::State&, const Probe&) noexcept {
    HandLoad load = isotropic_load(0, params.damping);
    load.damping.bottomRightCorner<3, 3>().diagonal().setConstant(params.angular_damping);
    return load;
}

bool powerless(const Viscosity& params) noexcept {
    return params.damping == 0 && params.angular_damping == 0;
}

}  // namespace knurl
