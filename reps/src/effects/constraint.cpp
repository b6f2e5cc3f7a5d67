#include <knurl/reps/constraint.hpp>

#include "scene/clamped.hpp"

namespace knurl {

Constraint prepared(Constraint params, const Limits& limits) noexcept {
    params.direction = to_plain(to_eigen(params.direction).normalized());
    params.stiffness = clamped_stiffness(params.stiffness, limits);
    params.damping = clamped_damping(params.damping, limits);
    params.reserved = 0;
    return params;
}

void adopt(const Constraint&, const Constraint*, Constraint::State&, const Probe&) noexcept {}

Wrench evaluate(const Constraint& params, Constraint::State&, const Probe& probe, double) noexcept {
    // P is linear, so it is applied once to the whole force.
    const Eigen::Vector3d pull =
        params.stiffness * (to_eigen(params.origin) - probe.position) - params.damping * probe.velocity;
    const Eigen::Vector3d u = to_eigen(params.direction);
    const Eigen::Vector3d along = u.dot(pull) * u;
    switch (params.shape) {
        case ConstraintShape::point:
            return {.force = pull};
        case ConstraintShape::line:
            return {.force = pull - along};
        case ConstraintShape::plane:
            return {.force = along};
    }
    return {};
}

HandLoad load(const Constraint& params, const Constraint::State&, const Probe& probe) noexcept {
    const Eigen::Vector3d u = to_eigen(params.direction);
    Eigen::Matrix3d held = Eigen::Matrix3d::Identity();
    if (params.shape == ConstraintShape::line) held -= u * u.transpose();
    if (params.shape == ConstraintShape::plane) held = u * u.transpose();
    HandLoad load;
    load.stiffness.topLeftCorner<3, 3>() = params.stiffness * held;
    load.damping.topLeftCorner<3, 3>() = params.damping * held;
    const Eigen::Vector3d d = to_eigen(params.origin) - probe.position;
    load.energy.held = 0.5 * params.stiffness * d.dot(held * d);
    return load;
}

bool powerless(const Constraint& params) noexcept {
    return params.stiffness == 0 && params.damping == 0;
}

}  // namespace knurl
