#pragma once

/// @file
/// Materials by name. Each is chosen to feel like something under a stylus pressed with about 1 N and moved
/// at a few centimetres a second; what was chosen and why stands beside the numbers in src/presets.cpp.

#include <span>
#include <string_view>

#include <knurl/reps/material.hpp>

namespace knurl {

/// How a surface feels, without where it is.
struct Material {
    /// Stiffness (N/m); infinity: as stiff as the device allows.
    double stiffness = 0;
    /// Damping along the normal (N s/m).
    double damping = 0;
    /// Friction along the surface.
    Friction friction = {};
    /// Snags along the surface.
    Snag snag = {};
    /// Relief on the surface.
    Texture texture = {};
};

/// The names of all materials that there are, in the manual's order.
std::span<const std::string_view> preset_names() noexcept;

/// The material of that name, or null.
const Material* preset(std::string_view name) noexcept;

/// `surface` made of that material. What a material does not say stays: where the texture lies
/// (`texture.direction`, `texture.origin`) and `snag.seed`.
///
///     Plane floor = made_of(*preset("rubber"), Plane{.normal = {0, 0, 1}});
template <class R>
R made_of(const Material& material, R surface) noexcept {
    const Texture lies = surface.texture;
    const std::uint32_t seed = surface.snag.seed;
    surface.stiffness = material.stiffness;
    surface.damping = material.damping;
    surface.friction = material.friction;
    surface.snag = material.snag;
    surface.snag.seed = seed;
    surface.texture = material.texture;
    surface.texture.direction = lies.direction;
    surface.texture.origin = lies.origin;
    return surface;
}

}  // namespace knurl
