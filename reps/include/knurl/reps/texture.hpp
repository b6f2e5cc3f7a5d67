#pragma once

/// @file
/// A relief on a surface. The surface's height becomes h - A f, and the contact is pushed down its slope by
/// -N A grad f: for one plane both together are the gradient of k (depth + A f)^2 / 2, so conservative. f is
/// taken at the probe's foot on the surface. Taken at the probe it would change with the depth wherever
/// `direction` leans out of the plane, and the force lacks that part of the gradient.

#include <knurl/reps/limits.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl {

/// A texture's relief at a point.
struct Relief {
    /// Height A f (m).
    double height = 0;
    /// Slope A grad f along the surface (1).
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
};

/// The relief at the point p (m, world) of a surface with that unit normal, which has been carried `shift`
/// (m) from where it was when the texture was given.
Relief relief(const Texture& texture, const Eigen::Vector3d& p, const Eigen::Vector3d& normal,
              const Eigen::Vector3d& shift) noexcept;

/// Share of the relief (0 to 1) that is rendered at a sliding speed (m/s). A relief that passes faster than a
/// quarter of the servo's rate is no texture but noise, so it fades between v / wavelength = 1 / (8 T) and 1
/// / (4 T).
double texture_gain(const Texture& texture, double speed, const Limits& limits) noexcept;

/// The lateral push (N) of the normal force N on that slope. Its stiffness k depth A (2 pi / wavelength)^2
/// may exceed the device's, so the slope is scaled down to A <= wavelength^2 / (4 pi^2 N) k_max.
Eigen::Vector3d texture_force(const Texture& texture, const Relief& relief, double normal_force,
                              const Limits& limits) noexcept;

}  // namespace knurl
