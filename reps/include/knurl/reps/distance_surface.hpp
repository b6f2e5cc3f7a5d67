#pragma once

/// @file
/// A surface that says no more than how far away it is. What it takes besides to be a Surface (concepts.hpp)
/// is the same for all of them, and made here: clamped parameters, moving on between updates, the tangent
/// plane at the foot.
///
/// ~~~{.unparsed}
///   struct Cone { Vec3 apex; ...; Vec3 velocity; double stiffness; ...; Texture texture;  using State = MovingState; };
///   SurfaceDistance distance(const Cone& cone, const Eigen::Vector3d& p, double radius) noexcept;
/// ~~~
///
/// It may have its own `prepared`, and whatever else concepts.hpp lists: with bound() it is not evaluated
/// where it is out of reach.

#include <cstring>
#include <type_traits>

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/motion.hpp>

namespace knurl {

/// How far the probe's surface is from a surface. The height is a signed distance: its gradient is the
/// normal.
struct SurfaceDistance {
    /// Signed distance of the probe's surface (m); negative: that deep in it.
    double height = 0;
    /// Unit normal, towards free space.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// What the servo remembers of a surface that has no path.
struct MovingState {
    /// How far the surface has moved on since it was placed.
    Motion motion;
};

/// R has a function `distance`. `p`: the probe's centre (m), as if the surface had not moved on since it was
/// placed; `radius`: the probe's (m).
// clang-format 14 breaks requirements apart.
// clang-format off
template <class R>
concept DistanceSurface = requires(const R& params, const Eigen::Vector3d& p, double radius) {
    { distance(params, p, radius) } noexcept -> std::same_as<SurfaceDistance>;
};
// clang-format on

/// Returns the parameters as the servo uses them: the material is clamped to `limits`.
template <DistanceSurface R>
R prepared(R params, const Limits& limits) noexcept {
    clamp_material(params.stiffness, params.damping, params.friction, limits);
    params.texture.reserved = 0;
    return params;
}

/// True: places, directions and velocity of their geometry are the same.
template <DistanceSurface R>
bool lies_alike(const R& a, const R& b) noexcept {
    const auto bytes_of = [](const R& params) { return reinterpret_cast<const std::byte*>(&params); };
    for (const Field& row : Describe<R>::fields) {
        const bool number = row.type == Field::Type::real || row.type == Field::Type::integer ||
                            row.type == Field::Type::choice;
        if (!number && row.offset < geometry_bytes<R>() &&
            std::memcmp(bytes_of(a) + row.offset, bytes_of(b) + row.offset, row.bytes()) != 0)
            return false;
    }
    return true;
}

/// Given a new place or velocity the surface starts from there; else, of another size, it moves on.
template <DistanceSurface R>
void adopt(const R& params, const std::type_identity_t<R>* previous, typename R::State& state,
           const Probe&) noexcept {
    if (!previous || !lies_alike(params, *previous)) place(state.motion);
}

/// The tangent plane at the probe's foot, from the distance.
template <DistanceSurface R>
Contact contact(const R& params, typename R::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Eigen::Vector3d velocity = to_eigen(params.velocity);
    const SurfaceDistance away =
        distance(params, probe.position - state.motion.time * velocity, probe.radius);
    return {.normal = away.normal,
            .height = away.height,
            .stiffness = params.stiffness,
            .damping = params.damping,
            .velocity = velocity};
}

}  // namespace knurl
