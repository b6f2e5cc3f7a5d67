#pragma once

/// @file
/// A rigid thing whose form was sent once (a triangle mesh, a height field) and is named here: rendered
/// exactly wherever the hand is, however seldom its pose is sent. Its faces are one-sided, and the hand is
/// held by the point of it that it came to (knurl/geometry/proxy.hpp). Beside others, with flat shading, that
/// point goes by the proxy of all of them (proxy_path.hpp).

#include <cstddef>
#include <optional>

#include <knurl/geometry/proxy.hpp>
#include <knurl/reps/bounds.hpp>
#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/motion.hpp>

namespace knurl {

/// Direction of the force on facets.
enum class Shading : std::uint32_t {
    /// The force points to the proxy, as on the facets that were sent.
    flat = 0,
    /// The force is along the normal interpolated over the facet (force shading); the facets alone decide
    /// contact.
    smooth = 1,
};

/// The servo's memory of a shape.
struct ShapeState {
    /// The asset that the parameters name.
    const Asset* asset = nullptr;
    /// The asset on which the proxy lies.
    const Asset* met = nullptr;
    /// The proxy.
    Proxy proxy;
    /// How far the surface has moved on since it was placed.
    Motion motion;
    /// Normal that was answered when the hand was at proxy.last, in the asset's frame.
    Vec3 normal = {0, 0, 1};
    /// Height then (m).
    double height = 0;
    /// Offset of the plane by which it holds the hand, along that normal (m).
    double offset = 0;
    /// The proxy when the cycle began (m).
    Vec3 start = {};
    /// Material of the face.
    std::uint32_t material = 0;
    /// Face when the cycle began.
    std::uint32_t was_face = 0;
    /// Phase when the cycle began.
    Proxy::Phase was_phase = Proxy::Phase::fresh;
    /// Beside other surfaces (proxy_path.hpp), 1: the proxy lies beyond a rim, by no more than the tolerance
    /// of a seam.
    std::uint8_t handed = 0;
    /// Times that it was left in this cycle.
    std::uint8_t left = 0;
    /// 1: the proxy is about to leave it.
    std::uint8_t leaving = 0;
    /// 1: its plane is not known, since the asset has changed.
    std::uint8_t anew = 0;
    /// 1: it touches a ball whose centre is in front.
    std::uint8_t brushed = 0;
    /// 1: no time passes, and it answers as it would alone.
    std::uint8_t tries = 0;
    /// Padding; 0.
    std::uint8_t reserved = 0;
};

/// A placed asset: a rigid thing whose form (a triangle mesh, a height field) was sent once. Its faces are
/// one-sided.
struct Shape {
    /// Number of the asset; 0, or one that is not there: it gives nothing.
    std::uint32_t asset = 0;
    /// Direction of the force on facets.
    Shading shading = Shading::flat;
    /// Where the asset's origin lies (m), world frame.
    Vec3 position = {};
    /// Turns the asset's axes into the world's; any length but 0.
    Quat orientation = {};
    /// Velocity of its origin with which it moves on between two updates (m/s).
    Vec3 velocity = {};
    /// Angular velocity about its origin with which it turns on between two updates (rad/s), world axes.
    Vec3 angular_velocity = {};
    /// Stiffness (N/m), typically 200 to 2000. Infinity: the largest that the device allows. Larger values
    /// are clamped.
    double stiffness = 0;
    /// Damping along the normal (N s/m), while touched; typically 0 to 5. Clamped to what the device stands.
    double damping = 0;
    /// Time over which a change reaches the hand (s), 0 to 1000. `automatic`: automatic_fade of the measured
    /// update interval; 0: at once.
    double recovery = automatic;
    /// Share of the hand's momentum that a pulse takes away at entry (1); Salcudean and Vlaar. 0: no pulse.
    double braking = 0;
    /// Friction along the surface; by default none.
    Friction friction = {};
    /// Snags along the surface; by default none.
    Snag snag = {};
    /// Relief on the surface; by default none.
    Texture texture = {};

    /// The servo's memory of one such representation.
    using State = ShapeState;
    /// Its material moves differently from place to place (concepts.hpp).
    static constexpr bool turns = true;
    /// The proxy enters and leaves this surface (concepts.hpp).
    static constexpr bool follows = true;
};

namespace detail {
inline constexpr std::string_view shadings[] = {"flat", "smooth"};
}

template <>
struct Describe<Shape> {
    static constexpr std::string_view name = "shape";
    static constexpr auto fields = join_rows(
        std::array{Field{.name = "asset",
                         .type = Field::Type::integer,
                         .offset = offsetof(Shape, asset),
                         .meaning = "which of the shapes that were sent; 0: none",
                         .minimum = 0,
                         .maximum = max_assets},
                   choice_row("shading", offsetof(Shape, shading),
                              "the direction of the force: the facets', or interpolated", detail::shadings),
                   vector_row("position", offsetof(Shape, position), "m", "where its origin lies"),
                   Field{.name = "orientation",
                         .type = Field::Type::quaternion,
                         .offset = offsetof(Shape, orientation),
                         .unit = "1",
                         .meaning = "turns its axes into the world's; of any length",
                         .minimum = -1e9,
                         .maximum = 1e9},
                   vector_row("angular_velocity", offsetof(Shape, angular_velocity), "rad/s",
                              "with which it turns on about its origin between updates", 1e3)},
        surface_rows<Shape>());
};

/// Returns the parameters as the servo uses them: normalised, and clamped to `limits`.
Shape prepared(Shape params, const Limits& limits) noexcept;
/// New parameters take effect. `previous`: the parameters before; null for a representation that was just
/// added.
void adopt(const Shape& params, const Shape* previous, Shape::State& state, const Probe& probe) noexcept;
/// Returns the tangent plane at the probe's foot, and advances `state` by `dt` (s).
Contact contact(const Shape& params, Shape::State& state, const Probe& probe, double dt) noexcept;
/// Returns the ball outside of which the probe is out of reach; none: it is evaluated in every cycle.
std::optional<Bound> bound(const Shape& params, const Shape::State& state) noexcept;
/// The representation was not evaluated for a while: its path is forgotten.
void out_of_reach(const Shape& params, Shape::State& state) noexcept;

}  // namespace knurl
