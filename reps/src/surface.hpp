#pragma once
// What the curved surfaces' sources share: preparing what every surface has, moving on between updates,
// answering.

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/motion.hpp>

#include "clamped.hpp"

namespace knurl {

inline Vec3 unit(const Vec3& v) noexcept {
    return to_plain(to_eigen(v) / to_eigen(v).norm());
}

/// The part of `prepared` that all surfaces have in common.
template <class R>
void prepare_surface(R& params, const Limits& limits) noexcept {
    params.stiffness = clamped_stiffness(params.stiffness, limits);
    params.damping = clamped_damping(params.damping, limits);
    params.friction.viscous = clamped_damping(params.friction.viscous, limits);
    params.texture.reserved = 0;
}

/// A surface that is placed anew has not moved on yet.
inline void place(Motion& motion) noexcept {
    motion = {.time = 0, .placed = 1};
}

inline void move_on(Motion& motion, double dt) noexcept {
    if (!(dt > 0)) return;
    if (motion.placed == 0) motion.time += dt;
    motion.placed = 0;
}

/// The probe from a surface's point, which has moved on: subtracted before anything is multiplied.
inline Eigen::Vector3d from_surface(const Vec3& point, const Vec3& velocity, const Motion& motion,
                                    const Probe& probe) noexcept {
    return (probe.position - to_eigen(point)) - motion.time * to_eigen(velocity);
}

/// The part of v across a unit vector. Taken again where v is almost along it: what the first time leaves
/// there is rounding.
[[gnu::always_inline]] inline Eigen::Vector3d across(const Eigen::Vector3d& v,
                                                     const Eigen::Vector3d& axis) noexcept {
    Eigen::Vector3d part = v - axis.dot(v) * axis;
    if (part.squaredNorm() < 0.01 * v.squaredNorm()) part -= axis.dot(part) * axis;
    return part;
}

template <class R>
Contact contact_of(const R& params, const Eigen::Vector3d& normal, double height) noexcept {
    return {.normal = normal,
            .height = height,
            .stiffness = params.stiffness,
            .damping = params.damping,
            .velocity = to_eigen(params.velocity)};
}

}  // namespace knurl
