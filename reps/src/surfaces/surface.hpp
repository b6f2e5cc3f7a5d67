#pragma once
// Shared by the curved surfaces' sources: common preparation, motion between updates, answers.

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/motion.hpp>

#include "scene/clamped.hpp"

namespace knurl {

inline Vec3 unit(const Vec3& v) noexcept {
    return to_plain(to_eigen(v) / to_eigen(v).norm());
}

/// The part of `prepared` that all surfaces share.
template <class R>
void prepare_surface(R& params, const Limits& limits) noexcept {
    clamp_material(params.stiffness, params.damping, params.friction, limits);
    params.texture.reserved = 0;
}

/// The probe relative to a moving point of the surface: subtracted before any multiplication.
inline Eigen::Vector3d from_surface(const Vec3& point, const Vec3& velocity, const Motion& motion,
                                    const Probe& probe) noexcept {
    return (probe.position - to_eigen(point)) - motion.time * to_eigen(velocity);
}

/// The part of v across a unit vector. Done twice where v is almost along it, since the first pass leaves
/// rounding there.
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
